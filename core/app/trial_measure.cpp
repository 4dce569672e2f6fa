// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/trial_measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <set>
#include <string>

#include "core/base/evenly.h"
#include "core/base/sha256.h"
#include "core/base/stage_times.h"
#include "core/pipeline/fit_engine.h"
#include "core/pipeline/summary.h"
#include "core/surface/mesh_policy.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace glint {

namespace {

constexpr int kFewHeldOut = 12;       // enough to tell errors apart by a tenth, few enough for hundreds of trials
constexpr int kFewTimed = 6;          // frames timed in a coarse trial
constexpr int kFewRepeats = 3;        // of each; the shortest counts, because other work on the machine only ever adds time
constexpr int kTimedFrames = 40;      // in a full measurement
constexpr double kLongFitUs = 300e3;  // fits that take longer are not repeated
constexpr double kSamePx = 1e-5;      // contours nearer than this are the same

double medianOf(std::vector<double> values) { return statisticOf(std::move(values)).median; }

std::string predictionsDigest(const Inspection& inspection, const std::string& model) {
  Sha256 hash;
  const auto add = [&](double v) { hash.add(std::to_string(std::llround(v / kSamePx)) + ","); };
  for (const FrameComparison& c : inspection.models.at(model).frames) {
    hash.add("f" + std::to_string(c.frame));
    for (const PredictedHighlight& h : c.prediction.highlights()) {
      // The same outline may start anywhere and have other vertices; its area and centroid tell contours apart.
      const Pixel middle = centroid(h.contour);
      add(middle.x());
      add(middle.y());
      add(std::sqrt(std::abs(signedArea(h.contour))));
    }
  }
  return hash.hex();
}

/// Settings of the stages up to the fit, and the model: where they are equal the fits are.
std::string keyOfFit(const Trial& trial) {
  std::string key = trial.model;
  for (const auto& [name, value] : trial.settings.values())
    if (const std::string& stage = paramSpec(name).stage; stage != "predict" && stage != "evaluate")
      key += "|" + name + "=" + textOf(value);
  return key;
}

/// A few whole surfaces, so that their fits are the same as with all frames.
std::vector<int> framesOfFewSurfaces(const Inspection& evidence, const std::vector<int>& frames) {
  std::vector<std::string> keys;
  std::map<std::string, std::vector<int>> bySurface;
  for (const int f : frames) {
    const std::string key = evidence.surfaces->keyOf(f);
    if (!bySurface.count(key)) keys.push_back(key);
    bySurface[key].push_back(f);
  }
  std::vector<int> numbers(keys.size()), chosen;
  std::iota(numbers.begin(), numbers.end(), 0);
  for (const int i : evenly(numbers, 3)) chosen.insert(chosen.end(), bySurface[keys[i]].begin(), bySurface[keys[i]].end());
  return chosen;
}

bool isTrained(const TrainSpec& train, int frame) { return std::binary_search(train.frames.begin(), train.frames.end(), frame); }

/// All frames to train on, and a few others with highlights.
std::vector<int> trainingAndFewOthers(const Inspection& evidence, const std::vector<int>& frames) {
  std::vector<int> chosen, heldOut;
  for (const int f : frames) {
    if (isTrained(evidence.train, f))
      chosen.push_back(f);
    else if (!evidence.evidence[f].scored().empty())
      heldOut.push_back(f);
  }
  const std::vector<int> some = evenly(heldOut, kFewHeldOut);
  chosen.insert(chosen.end(), some.begin(), some.end());
  return chosen;
}

}  // namespace

/// Some of the frames as a scene of its own, with their evidence.
struct TradeoffBench::Subset {
  std::shared_ptr<const Scene> scene;
  InspectionRequest request;
  Inspection evidence;
};

TradeoffBench::TradeoffBench(std::shared_ptr<const Scene> scene, const InspectionRequest& request, int repeats,
                             const ProgressFn& progress)
    : request_(request),
      repeats_(repeats),
      progress_(progress),
      few_(std::make_shared<Subset>()),
      all_(std::make_shared<Subset>()) {
  require(scene != nullptr && repeats >= 1, "TradeoffBench: a scene and at least one repeat");
  all_->scene = scene;
  all_->request = request;
  all_->request.models.clear();
  all_->evidence = inspect(scene, all_->request, progress).evidenceAlone();

  if (!request.whatIf.none()) {
    few_ = all_;  // the user's changes name frames by their number: all of them are tried
    return;
  }
  const TrainSpec& train = all_->evidence.train;
  std::vector<int> frames;
  for (int f = 0; f < static_cast<int>(scene->frames.size()); ++f)
    if (std::find(request.excluded.begin(), request.excluded.end(), f) == request.excluded.end()) frames.push_back(f);
  std::vector<int> chosen =
      train.perSurface ? framesOfFewSurfaces(all_->evidence, frames) : trainingAndFewOthers(all_->evidence, frames);
  std::sort(chosen.begin(), chosen.end());
  auto part = std::make_shared<Scene>(*scene);
  part->frames.clear();
  few_->request = request;
  few_->request.excluded.clear();
  few_->request.models.clear();
  std::string trainIds;
  for (const int f : chosen) {
    part->frames.push_back(scene->frames[f]);
    // Ids, because an id such as "0003" would win over the number 3.
    if (isTrained(train, f)) trainIds += (trainIds.empty() ? "" : ",") + scene->frames[f].id;
  }
  few_->scene = part;
  if (!train.perSurface) few_->request.train = trainIds;
  // All trials start from new detection and a fitted lobe. No setting of a model changes the contours that score it.
  few_->evidence = inspect(part, few_->request, progress).evidenceAlone();
}

void TradeoffBench::check() const {
  if (!report(progress_, {"", 0, 0})) throw Stopped{};
}

Inspection TradeoffBench::run(const Subset& subset, const Trial& trial, const Inspection* previous) const {
  InspectionRequest request = subset.request;
  request.models = {trial.model};
  request.settings = trial.settings;
  return inspect(subset.scene, request, progress_, previous ? previous : &subset.evidence);
}

TradeoffPoint TradeoffBench::pointOf(const Inspection& inspection, const Trial& trial) const {
  const ModelSummary s = summarise(inspection, inspection.models.at(trial.model));
  TradeoffPoint p;
  p.model = trial.model;
  p.settings = trial.settings;
  p.frames = s.frames;
  p.predicted = s.predicted;
  p.matched = s.matched;
  p.missed = s.missed;
  p.spurious = s.spurious;
  p.contourErrorPct = s.contourErrorPct.mean;
  p.iou = s.iou.mean;
  p.coverage = s.coverage.mean;
  p.rankedErrorPct = rankedErrorPct(p);
  if (s.poor) p.poor = s.reason;
  return p;
}

std::vector<std::vector<double>> TradeoffBench::timesOf(const Inspection& inspection, const Trial& trial, int frames,
                                                        int repeats) const {
  const ModelResult& result = inspection.models.at(trial.model);
  const HighlightModel& model = modelByName(trial.model);
  std::vector<int> counted;
  for (int i = 0; i < static_cast<int>(result.frames.size()); ++i) {
    const FrameComparison& c = result.frames[i];
    if (inspection.isHeldOut(c.frame) && result.fits[c.fit].fit && !inspection.evidence[c.frame].scored().empty())
      counted.push_back(i);
  }
  std::vector<std::vector<double>> times;
  for (const int i : evenly(counted, static_cast<std::size_t>(frames))) {
    const FrameComparison& c = result.frames[i];
    std::vector<double>& of = times.emplace_back();
    const Outcome<std::shared_ptr<const Surface>> surface = surfaceFor(inspection, c.frame, c.light);
    const Camera camera = inspection.cameraFor(c.frame, c.light);
    for (int r = 0; r < repeats; ++r) {
      check();
      const auto start = std::chrono::steady_clock::now();
      const Prediction p = model.predict(*result.fits[c.fit].fit, camera, surface ? surface->get() : nullptr, trial.settings);
      of.push_back(microsecondsSince(start));
    }
  }
  return times;
}

double TradeoffBench::fitUs(const Inspection& inspection, const Trial& trial) const {
  const HighlightModel& model = modelByName(trial.model);
  std::vector<double> times;
  for (int r = 0; r < repeats_; ++r) {
    double total = 0;
    for (const ModelResult::Fit& f : inspection.models.at(trial.model).fits) {
      std::vector<TrainingView> views = inspection.viewsOf(f.key(), true);
      check();
      const auto start = std::chrono::steady_clock::now();
      std::optional<LightFit> light;
      if (model.needsLight())
        light =
            fitLight(std::move(views), *inspection.scene, *inspection.surfaces, trial.settings, inspection.chosenFor(f.key()));
      check();
      const Outcome<ModelFit> fit = light ? fitModel(model, std::move(light->views), light->light, trial.settings)
                                          : fitModel(model, std::move(views), std::nullopt, trial.settings);
      total += microsecondsSince(start);
      (void)fit;  // its result is in the inspection already
    }
    times.push_back(total);
    if (total > kLongFitUs) break;
  }
  return medianOf(std::move(times));
}

int TradeoffBench::timedFrames() const {
  int n = 0;
  for (const FrameEvidence& e : all_->evidence.evidence)
    if (all_->evidence.isHeldOut(e.frame) && !e.scored().empty()) ++n;
  return std::min(n, kTimedFrames);
}

Outcome<TrialResult> TradeoffBench::coarse(const Trial& trial) {
  const std::string key = keyOfFit(trial);
  const auto known = earlier_.find(key);
  // Another model or other fit settings still share views and light where those did not change: any earlier result helps.
  const Inspection* previous = known != earlier_.end() ? &known->second : earlier_.empty() ? nullptr : &earlier_.begin()->second;
  Inspection r = run(*few_, trial, previous);
  const ModelSummary s = summarise(r, r.models.at(trial.model));
  if (!s.answered) return Failure{Reason::NotReached, s.reason};
  TrialResult result;
  result.errorPct = pointOf(r, trial).rankedErrorPct;
  if (s.poor) result.poor = s.reason;
  std::vector<double> shortest;
  for (const std::vector<double>& of : timesOf(r, trial, kFewTimed, kFewRepeats))
    shortest.push_back(*std::min_element(of.begin(), of.end()));
  result.us = medianOf(std::move(shortest));
  result.predictions = predictionsDigest(r, trial.model);
  if (known == earlier_.end()) {
    if (earlier_.size() > 40) earlier_.clear();  // bounded; fits are then repeated
    earlier_.emplace(key, std::move(r));
  }
  return result;
}

Outcome<TradeoffPoint> TradeoffBench::full(const Trial& trial) {
  earlier_.clear();
  const MeshPolicy policy = meshPolicy(trial.settings);
  if (policy_ != policy) {
    // Only this policy's surfaces count in the memory.
    all_->evidence.surfaces.reset();
    few_->evidence.surfaces = std::make_shared<SurfaceCache>(*few_->scene);
    all_->evidence.surfaces = std::make_shared<SurfaceCache>(*all_->scene);
    policy_ = policy;
  }
  memoryResets_ = restartPeakMemory() && memoryResets_;
  const Inspection r = run(*all_, trial, nullptr);
  const double peak = peakMemoryMb();
  if (const ModelSummary s = summarise(r, r.models.at(trial.model)); !s.answered) return Failure{Reason::NotReached, s.reason};
  TradeoffPoint p = pointOf(r, trial);
  p.peakMb = peak;
  std::vector<double> times;
  for (const std::vector<double>& of : timesOf(r, trial, kTimedFrames, repeats_)) times.insert(times.end(), of.begin(), of.end());
  p.predictUs = medianOf(std::move(times));
  p.fitUs = fitUs(r, trial);
  return p;
}

bool restartPeakMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  // "5" resets VmHWM to the present resident size (proc(5)).
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;
  return file.good();
}

double peakMemoryMb() {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("VmHWM:", 0) == 0) return static_cast<double>(std::stoll(line.substr(6))) / 1024;  // given in kB
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace glint

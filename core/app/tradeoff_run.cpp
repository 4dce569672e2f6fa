// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/tradeoff_run.h"

#include <algorithm>
#include <map>

#include "core/app/session.h"
#include "core/app/trial_measure.h"
#include "core/app/trial_work_file.h"
#include "core/base/number_text.h"
#include "core/base/sha256.h"
#include "core/scene/frame_name.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

std::string idOf(const Trial& trial) {
  std::string id = trial.model;
  for (const auto& [key, value] : trial.settings.values()) id += "|" + key + "=" + textOf(value);
  return id;
}

/// Equal for runs whose measurements may be mixed: inputs, request, settings and program.
std::string workKey(const Scene& scene, const InspectionRequest& request, const TradeoffOptions& options,
                    const ProgressFn& progress) {
  Sha256 hash;
  const std::string noise = formatted("%.17g", request.noisePx);
  for (const SessionFile& f : hashInputs(scene, request, progress)) hash.add(f.path.string() + "=" + f.sha256 + "\n");
  hash.add(request.train + "|" + (request.source == FrameSource::Image ? "image" : "radiance") + "|" + noise + "|" +
           std::to_string(request.seed) + "|" + request.truthFolder + "|" + std::to_string(options.repeats) + "|" +
           options.program);
  for (const int f : request.excluded) hash.add("x" + std::to_string(f));
  for (const ParamSpec& p : allParams()) hash.add(p.key + "=" + textOf(request.settings.value(p.key)) + "\n");
  return hash.hex();
}

/// Errors are measured on held-out frames. Said at once: without any, every trial would fail, one after the other.
void requireHeldOutFrames(const Scene& scene, const InspectionRequest& request) {
  const TrainSpec train = parseTrainSpec(request.train, scene);
  const int frames = static_cast<int>(scene.frames.size());
  const auto in = [](const std::vector<int>& list, int f) { return std::find(list.begin(), list.end(), f) != list.end(); };
  for (int f = 0; f < frames; ++f)
    if (!in(request.excluded, f) && (train.perSurface || !in(train.frames, f))) return;
  std::string what =
      "no frame is left to measure the error on: each of the " + std::to_string(frames) + " is a training frame or excluded";
  if (frames > 1) what += "; train with fewer, for example --train first:" + std::to_string(std::min(frames - 1, 4));
  throw InputError("", "--train " + request.train, what);
}

}  // namespace

std::vector<std::string> namedModels(const std::vector<std::string>& named) {
  std::vector<std::string> models;
  for (const std::string& m : named) modelByName(m);
  for (const auto& m : allModels())
    if (std::count(named.begin(), named.end(), m->id())) models.push_back(m->id());
  return models;
}

Tradeoff emptyTradeoff(const Scene& scene, const InspectionRequest& request, const TradeoffOptions& options) {
  requireHeldOutFrames(scene, request);
  Tradeoff t;
  t.input = options.input;
  t.trainSpec = request.train;
  t.train = parseTrainSpec(request.train, scene).frames;
  std::erase_if(t.train,
                [&](int f) { return std::find(request.excluded.begin(), request.excluded.end(), f) != request.excluded.end(); });
  t.trainIds = frameIds(scene, t.train);
  for (const Knob& k : knobsOf(request.settings)) t.knobs.push_back(k.key);
  return t;
}

std::string measurementText(const TradeoffBench& bench, int repeats) {
  return "Time of a prediction: median over " + std::to_string(bench.timedFrames()) + " frames and " + std::to_string(repeats) +
         " repeats, one thread, this machine. Fit: light, canonical contours and fit of all lights and surfaces, median of up "
         "to " +
         std::to_string(repeats) +
         " repeats. Memory: peak resident size of the whole process while it fits and predicts all frames " +
         (bench.memoryResets() ? "with this setting (the kernel's high-water mark, reset before)."
                               : "since it started (the system does not allow resetting the mark).");
}

Tradeoff measureTradeoff(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const TradeoffOptions& options,
                         const ProgressFn& progress) {
  require(scene != nullptr, "measureTradeoff: no scene");
  Tradeoff t = emptyTradeoff(*scene, request, options);
  StageEvent now{"tradeoff: highlights", 0, 0};
  // The stages of the pipeline report from several threads, one at a time, and only ask here whether to go on.
  const ProgressFn outer = [&](const StageEvent& e) {
    if (now.total == 0 && !e.stage.empty()) return report(progress, {now.stage, e.done, e.total});
    return report(progress, now);
  };
  WorkFile work(options.workFile, options.workFile.empty() ? "" : workKey(*scene, request, options, outer));

  const std::vector<std::string> models = namedModels(request.models);
  const std::vector<Knob> knobs = knobsOf(request.settings);

  TradeoffBench bench(scene, request, options.repeats, outer);
  int done = 0;
  const auto tryOne = [&](const Trial& trial) -> Outcome<TrialResult> {
    now = {"tradeoff: try settings on few frames, " + trial.model, ++done, options.search.maxTrials};
    if (!report(progress, now)) throw Stopped{};
    const std::string id = idOf(trial);
    if (auto known = work.coarse(id)) return std::move(*known);
    Outcome<TrialResult> result = bench.coarse(trial);
    work.add(id, result);
    return result;
  };
  SearchResult found = searchTrials(models, request.settings, knobs, tryOne, options.search);
  t.trials = found.trials;
  t.pruned = std::move(found.pruned);
  // Grouped by surface, so that each is built once; the order of the points is decided later.
  std::stable_sort(found.finalists.begin(), found.finalists.end(),
                   [](const Trial& a, const Trial& b) { return meshPolicy(a.settings) < meshPolicy(b.settings); });
  done = 0;
  for (const Trial& trial : found.finalists) {
    now = {"tradeoff: measure, " + trial.model, ++done, static_cast<int>(found.finalists.size())};
    if (!report(progress, now)) throw Stopped{};
    const std::string id = idOf(trial);
    std::optional<Outcome<TradeoffPoint>> point = work.full(id);
    if (!point) {
      point = bench.full(trial);
      work.add(id, *point);
    }
    if (!*point) {
      t.pruned.push_back({trial.model, trial.settings, "failed", point->failure().message(), std::nan(""), std::nan("")});
      continue;
    }
    (*point)->model = trial.model;
    (*point)->settings = trial.settings;
    t.points.push_back(std::move(**point));
  }
  choosePoint(t, options.bound);
  t.measurement = measurementText(bench, options.repeats);
  return t;
}

}  // namespace glint

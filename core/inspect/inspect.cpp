// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <chrono>
#include <utility>

#include "core/base/elapsed.h"
#include "core/base/parallel.h"
#include "core/fit/corrected_depth.h"
#include "core/fit/evidence.h"
#include "core/fit/fit_engine.h"
#include "core/fit/highlight_motion.h"
#include "core/fit/several_lights.h"
#include "core/fit/training.h"
#include "core/inspect/fit_band.h"
#include "core/inspect/fit_remarks.h"
#include "core/inspect/hand_edits.h"
#include "core/inspect/inspection.h"
#include "core/inspect/live_prediction.h"
#include "core/inspect/lobe_stage.h"
#include "core/inspect/requested_evidence.h"
#include "core/inspect/stage_inputs.h"
#include "core/inspect/texture_stage.h"
#include "core/model/pixel_evidence.h"
#include "core/score/comparison.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

std::string join(const std::vector<int>& numbers) {
  std::string text;
  for (const int n : numbers) text += std::to_string(n) + ",";
  return text;
}

/// Counts what is alive, and the most there ever were.
class Held {
 public:
  Held(std::atomic<int>& now, std::atomic<int>& most) : now_(now) {
    const int count = ++now_;
    for (int seen = most; seen < count && !most.compare_exchange_weak(seen, count);) {
    }
  }
  ~Held() { --now_; }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

 private:
  std::atomic<int>& now_;
};

/// What gets its own fit.
struct Group {
  FitKey key;
  std::vector<int> views;  ///< indices into Inspection::views
};

/// Whether two frames are one photograph given twice: the same camera, surface and highlights, to the last bit. Noise never
/// repeats itself like that, so the second one is no further observation: it would only take weight from priors, and replace
/// the first one where that is left out to judge a choice.
bool sameObservation(const Inspection& r, int frame, int other) {
  if (r.train.perSurface && r.surfaces->keyOf(frame) != r.surfaces->keyOf(other)) return false;  // they serve fits of their own
  const Frame &a = r.scene->frames[static_cast<std::size_t>(frame)], &b = r.scene->frames[static_cast<std::size_t>(other)];
  if (a.surface != b.surface || a.depth != b.depth || a.camera.pixelFromRay != b.camera.pixelFromRay ||
      a.camera.camFromWorld.matrix() != b.camera.camFromWorld.matrix())
    return false;
  const std::vector<Highlight>&h = r.evidence[static_cast<std::size_t>(frame)].highlights,
        &k = r.evidence[static_cast<std::size_t>(other)].highlights;
  return !h.empty() && std::equal(h.begin(), h.end(), k.begin(), k.end(), [](const Highlight& x, const Highlight& y) {
    return x.light == y.light && x.level == y.level && x.peak == y.peak && x.contour.points == y.contour.points;
  });
}

/// Which frame is predicted; the training ones are looked at as well, and more where that is needed.
struct Only {
  std::optional<int> frame;    ///< nothing = every frame
  bool withoutPixels = false;  ///< see firstLook()
  bool predicts(int i) const { return !frame || *frame == i; }
};

class Run {
 public:
  Run(Inspection& result, const ProgressFn& progress, const Inspection* previous, Only only)
      : r_(result),
        progress_(progress),
        previous_(previous && previous->given == result.given ? previous : nullptr),
        only_(only) {}

  void highlights();
  void lobes();
  void assignSeveralLights();
  void changeHighlights();
  void brightestPointsAndTangentPlanes();
  void lights();
  void canonicalContours();
  void modelFits();
  void predictionsAndComparisons();

 private:
  bool unchanged(Stage stage) const {
    if (pixelsCome() && stage != Stage::Evidence && stage != Stage::Lobes) {
      // Pixels that are attached later lie on the surface as given: a corrected one is made again with them.
      if (contoursTakeTheLobe() || !previous_->corrections.empty()) return false;
    }
    return previous_ && r_.inputs.same(stage, previous_->inputs);
  }
  bool contoursTakeTheLobe() const { return r_.request.settings.text("detect.background") == "lobe"; }
  /// The earlier run left the pixels to this one.
  bool pixelsCome() const { return previous_ && previous_->pixelsLeft && !only_.withoutPixels; }
  std::shared_ptr<const Surface> surfaceOf(int frame) const {
    const Outcome<std::shared_ptr<const Surface>> s = r_.surfaces->surfaceOf(frame, meshPolicy(r_.request.settings));
    return s ? *s : nullptr;
  }
  /// A step that missed the surface gets the reason why the surface is missing: the file that cannot be read.
  Failure explained(int frame, const Failure& failure) const {
    if (failure.reason != Reason::NoSurface) return failure;
    const Outcome<std::shared_ptr<const Surface>> s = r_.surfaces->surfaceOf(frame, meshPolicy(r_.request.settings));
    return s ? failure : s.failure();
  }
  std::vector<Group> groups() const;
  bool anyModel(bool (HighlightModel::*needs)() const) const {
    return std::any_of(r_.request.models.begin(), r_.request.models.end(),
                       [&](const std::string& m) { return (modelByName(m).*needs)(); });
  }
  /// The views of a group on the surfaces as given, or as the fits see them.
  std::vector<TrainingView> viewsOf(const Group& group, bool asGiven) const;
  void correct(const Group& group, const SurfaceCorrection& correction, std::vector<TrainingView> corrected);
  std::vector<std::shared_ptr<const Band>> bandsOf(const HighlightModel& model, ModelResult& result);

  void gather(const std::vector<int>& frames);
  std::vector<int> framesToGather() const;
  bool lightsAreOpen() const { return lightsAreOpenIn(*r_.scene, r_.request); }

  Inspection& r_;
  const ProgressFn& progress_;
  const Inspection* previous_;
  const Only only_;
};

void Run::highlights() {
  const InspectionRequest& q = r_.request;
  const bool together = lightsAreOpen();
  r_.inputs.set(Stage::Evidence, evidenceInputs(q, together));
  r_.inputs.set(Stage::Lobes, lobeInputs(q, r_.train, together));
  std::vector<int> judged;
  if (unchanged(Stage::Evidence)) {
    r_.evidence = previous_->evidence;
    for (const auto& [frame, before] : previous_->evidenceBefore) r_.evidence[std::size_t(frame)] = before;
    if (unchanged(Stage::Lobes)) {
      r_.detected = previous_->detected;
    } else {
      for (std::size_t i = 0; i < previous_->detected.size(); ++i)
        if (previous_->detected[i].frame >= 0) r_.evidence[i] = previous_->detected[i];
      if (!together)
        for (FrameEvidence& e : r_.evidence) {
          if (e.frame < 0) continue;
          returnTextures(e);  // surfaces and poses may be others now
          judged.push_back(e.frame);
        }
    }
  } else {
    if (!q.truthFolder.empty()) requireTruthFolder(q.truthFolder, *r_.scene);
    r_.evidence.resize(r_.scene->frames.size());
  }
  std::vector<int> missing = framesToGather();
  if (!missing.empty()) gather(missing);
  judged.insert(judged.end(), missing.begin(), missing.end());
  rejectTextures(
      r_, judged, [this](int frame) { return surfaceOf(frame); }, [this](const std::vector<int>& more) { gather(more); },
      progress_);
  if (together && !missing.empty()) assignSeveralLights();
}

/// Frames whose evidence does not exist yet and is asked for.
std::vector<int> Run::framesToGather() const {
  std::vector<int> frames;
  const bool all = !only_.frame || r_.train.perSurface || lightsAreOpen();
  for (int i = 0; i < static_cast<int>(r_.evidence.size()); ++i)
    if (r_.evidence[static_cast<std::size_t>(i)].frame < 0 &&
        (all || only_.predicts(i) || std::binary_search(r_.train.frames.begin(), r_.train.frames.end(), i)))
      frames.push_back(i);
  return frames;
}

void Run::gather(const std::vector<int>& frames) {
  const Scene& scene = *r_.scene;
  const InspectionRequest& q = r_.request;
  r_.work.framesDetected += static_cast<int>(frames.size());
  // Images live only inside one call: as many at once as there are threads, whatever the number of frames.
  std::atomic<int> held{0}, most{0};
  parallelFor(
      static_cast<int>(frames.size()),
      [&](int n) {
        const int i = frames[n];
        const Held inMemory(held, most);
        r_.evidence[i] = evidenceFor(scene, i, q);
      },
      progress_, "detect");
  r_.work.framesHeldAtOnce = std::max<int>(r_.work.framesHeldAtOnce, most);
}

void Run::lobes() {
  r_.pixelsLeft = only_.withoutPixels;
  if (r_.pixelsLeft) return;
  const SurfaceOfFrame surface = [this](int frame) { return surfaceOf(frame); };
  if (unchanged(Stage::Lobes) && !pixelsCome()) {
    r_.patches = previous_->patches;
    r_.pixelFits = previous_->pixelFits;
    r_.unexplained = previous_->unexplained;
  } else {
    fitLobes(r_, surface, lightsAreOpen(), progress_);
  }
  contourAgain(r_, surface, progress_);
}

void Run::assignSeveralLights() {
  glint::assignSeveralLights(
      *r_.scene, r_.evidence, [&](int frame) { return surfaceOf(frame); },
      [&](int frame, const SeparateLights& lights) {
        FrameEvidence again = gatherEvidence(*r_.scene, frame, r_.request.source, r_.request.settings, lights);
        dropTextures(again, r_.evidence[static_cast<std::size_t>(frame)].textures);
        return again;
      },
      progress_);
}

/// The user's changes to single highlights and lights come after detection, so that none of them detects anything again.
void Run::changeHighlights() {
  const WhatIf& w = r_.request.whatIf;
  for (FrameEvidence& e : r_.evidence) {
    if (e.frame < 0 || !changesHighlights(w, e.frame)) continue;
    r_.evidenceBefore.emplace(e.frame, e);
    applyEdits(e, *r_.scene, r_.request);
    moveHighlights(e, w);
  }
  for (FrameEvidence& e : r_.evidence) {
    if (!showsSwitchedOff(e, r_.request.whatIf)) continue;
    r_.evidenceBefore.emplace(e.frame, e);
    dropSwitchedOff(e, r_.request.whatIf);
  }
}

void Run::brightestPointsAndTangentPlanes() {
  const InspectionRequest& q = r_.request;
  r_.inputs.set(Stage::Views,
                inputsText(q.settings, {"surface"},
                           r_.inputs.of(Stage::Evidence) + "|" + r_.inputs.of(Stage::Lobes) + "|" + join(r_.train.frames) +
                               (r_.train.perSurface ? "per-surface" : "") + "|x" + join(q.excluded) + "|" + exactText(q.noisePx) +
                               "|" + std::to_string(q.seed) + "|" + posesKey(q.whatIf) + "|" + highlightsKey(q.whatIf) + "|" +
                               lightsOffKey(q.whatIf) +
                               (q.settings.text("fit.evidence") == "levels" ? "|" + q.settings.text("fit.levels") : "")));
  if (unchanged(Stage::Views)) {
    r_.views = previous_->views;
    for (std::size_t v = 0; v < r_.views.size(); ++v) r_.views[v] = previous_->viewAsGiven(static_cast<int>(v));
    return;
  }
  int done = 0;
  std::vector<int> used;
  for (const int frame : r_.train.frames) {
    if (!report(progress_, {"surface", done++, static_cast<int>(r_.train.frames.size())})) throw Stopped{};
    if (std::find(q.excluded.begin(), q.excluded.end(), frame) != q.excluded.end()) continue;
    // Noise that is added here is another one in every frame: then they are observations of their own.
    if (!(q.noisePx > 0) && std::any_of(used.begin(), used.end(), [&](int other) { return sameObservation(r_, frame, other); }))
      continue;
    used.push_back(frame);
    FrameEvidence evidence = r_.evidence[frame];
    addDetectedLevels(
        r_, [this](int f) { return surfaceOf(f); }, evidence);
    for (std::size_t h = 0; h < evidence.highlights.size(); ++h)
      evidence.highlights[h] = withNoise(evidence.highlights[h], q.noisePx, q.seed, frame, evidence.asFound(static_cast<int>(h)));
    for (int h = 0; h < static_cast<int>(evidence.highlights.size()); ++h) {
      r_.views.push_back(trainingView(evidence, h, r_.scene->frames[frame].camera, surfaceOf(frame)));
      if (TrainingView& view = r_.views.back(); !view.seen) view.seen = explained(frame, view.seen.failure());
    }
  }
  r_.work.trainingViews = static_cast<int>(r_.views.size());
  attachPixels(r_);
}

std::vector<Group> Run::groups() const {
  std::vector<Group> groups;
  const auto groupOf = [&](int frame, const std::string& light) -> Group& {
    const FitKey key = r_.keyFor(frame, light);
    for (Group& g : groups)
      if (g.key == key) return g;
    groups.push_back({key, {}});
    return groups.back();
  };
  for (int i = 0; i < static_cast<int>(r_.views.size()); ++i)
    if (!r_.views[i].highlight.light.empty()) groupOf(r_.views[i].frame, r_.views[i].highlight.light).views.push_back(i);
  // A light that only held-out frames show still gets a (failing) fit, so that its frames are answered with a reason.
  for (const FrameEvidence& e : r_.evidence)
    for (const Highlight& h : e.scored())
      if (!h.light.empty()) groupOf(e.frame, h.light);
  // So does a light that is on but has no highlight that could be told from those of other lights.
  if (!r_.train.perSurface)
    for (std::size_t i = 0; i < r_.scene->frames.size(); ++i) {
      const std::vector<std::string>& on = r_.scene->frames[i].lightsOn;
      if (on.size() > 1)
        for (const std::string& light : on)
          if (isOn(*r_.scene, r_.request.whatIf, static_cast<int>(i), light)) groupOf(static_cast<int>(i), light);
    }
  return groups;
}

void Run::lights() {
  const std::vector<Group> all = groups();
  // The key names lights and surfaces: a look at one frame may not have seen them all.
  std::string names;
  for (const Group& g : all) names += "|" + textOf(g.key);
  std::set<std::string> stages{"light"};
  if (r_.request.settings.flag("light.refine_normals"))
    stages.insert("fit");  // which model explains the contours better depends on how it is fitted
  r_.inputs.set(Stage::Lights, inputsText(r_.request.settings, stages, r_.inputs.of(Stage::Views) + names));
  if (!anyModel(&HighlightModel::needsLight)) return;
  if (unchanged(Stage::Lights) && !previous_->lights.empty()) {
    r_.lights = previous_->lights;
    r_.corrections = previous_->corrections;
    r_.viewsAsGiven = previous_->viewsAsGiven;
    r_.correctedDepthMaps = previous_->correctedDepthMaps;
    for (const auto& [v, given] : r_.viewsAsGiven) {
      r_.views[static_cast<std::size_t>(v)] = previous_->views[static_cast<std::size_t>(v)];
      r_.views[static_cast<std::size_t>(v)].canonical.reset();
    }
    return;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!report(progress_, {"light", static_cast<int>(i), static_cast<int>(all.size())})) throw Stopped{};
    const FitKey& key = all[i].key;
    if (!isSeen(r_, key.light)) {
      r_.lights.insert_or_assign(
          key, Failure{Reason::NoHighlight, key.light + " has none that can be distinguished from those of other lights"});
      continue;
    }
    LightFit fit = fitLight(viewsOf(all[i], true), *r_.scene, *r_.surfaces, r_.request.settings);
    ++r_.work.lights;
    r_.lights.insert_or_assign(key, std::move(fit.light));
    if (fit.correction) correct(all[i], fit.correction, std::move(fit.views));
  }
}

std::vector<TrainingView> Run::viewsOf(const Group& group, bool asGiven) const {
  std::vector<TrainingView> views;
  for (const int v : group.views) views.push_back(asGiven ? r_.viewAsGiven(v) : r_.views[static_cast<std::size_t>(v)]);
  return views;
}

void Run::correct(const Group& group, const SurfaceCorrection& correction, std::vector<TrainingView> corrected) {
  r_.corrections.insert_or_assign(group.key, correction);
  for (std::size_t i = 0; i < group.views.size(); ++i) {
    TrainingView& view = r_.views[static_cast<std::size_t>(group.views[i])];
    r_.viewsAsGiven.insert_or_assign(group.views[i], std::exchange(view, std::move(corrected[i])));
  }
}

void Run::canonicalContours() {
  r_.inputs.set(Stage::CanonicalContours, inputsText(r_.request.settings, {"fit"}, r_.inputs.of(Stage::Lights)));
  if (!anyModel(&HighlightModel::needsCanonicalContours)) return;
  const auto had = [&](const TrainingView& v) { return v.canonical.has_value(); };
  if (unchanged(Stage::Views) && unchanged(Stage::CanonicalContours) &&
      std::any_of(previous_->views.begin(), previous_->views.end(), had)) {
    r_.views = previous_->views;  // equal keys: the same views
    return;
  }
  for (const Group& g : groups()) {
    const LightEstimate* const light = r_.lightOf(g.key);
    if (!light) continue;
    r_.work.canonicalContours += static_cast<int>(g.views.size());
    parallelFor(
        static_cast<int>(g.views.size()),
        [&](int i) { addCanonicalContour(r_.views[g.views[i]], light->light, r_.request.settings); }, progress_, "canonical");
  }
}

void Run::modelFits() {
  if (pixelsCome()) attachPixels(r_);
  r_.inputs.set(Stage::Fits, inputsText(r_.request.settings, {"fit"}, r_.inputs.of(Stage::Lights)));
  const std::vector<Group> all = groups();
  int done = 0;
  for (const std::string& name : r_.request.models) {
    const HighlightModel& model = modelByName(name);
    ModelResult& result = r_.models[name];
    result.model = name;
    if (unchanged(Stage::Fits) && previous_->models.count(name)) {
      result.fits = previous_->models.at(name).fits;
      continue;
    }
    for (const Group& g : all) {
      const StageEvent now{"fit " + name, done++, static_cast<int>(all.size() * r_.request.models.size())};
      if (!report(progress_, now)) throw Stopped{};
      ModelResult::Fit entry;
      entry.light = g.key.light;
      entry.surface = g.key.surface;
      FitInput input = fitInputOf(r_, model, g.key);
      input.progress = [&](const StageEvent&) { return report(progress_, now); };
      const auto start = std::chrono::steady_clock::now();
      Outcome<ModelFit> fit = model.fit(input, r_.request.settings);
      ++r_.work.fits;
      if (fit) {
        fit->model = name;
        fit->light = g.key.light;
        fit->surface = g.key.surface;
        if (std::string merged = mergedRemark(r_, *fit); !merged.empty()) fit->remarks.push_back(std::move(merged));
        if (std::string repeated = repeatedRemark(r_, *fit); !repeated.empty()) fit->remarks.push_back(std::move(repeated));
        if (std::string byHand = byHandRemark(r_, *fit); !byHand.empty()) fit->remarks.push_back(std::move(byHand));
        if (std::string texture = textureRemark(r_); !texture.empty()) fit->remarks.push_back(std::move(texture));
        if (r_.surfaces)
          if (std::string fused = r_.surfaces->fusionRemark(fit->frames); !fused.empty())
            fit->remarks.push_back(std::move(fused));
        if (const auto found = r_.corrections.find(g.key);
            found != r_.corrections.end() && found->second.normals && model.needsLight())
          fit->remarks.push_back(found->second.normals->remark());
        fit->timeUs = microsecondsSince(start);
      }
      entry.fit = std::move(fit);
      result.fits.push_back(std::move(entry));
    }
  }
}

/// One band per fit with predict.band, else nulls.
std::vector<std::shared_ptr<const Band>> Run::bandsOf(const HighlightModel& model, ModelResult& result) {
  std::vector<std::shared_ptr<const Band>> bands(result.fits.size());
  for (ModelResult::Fit& fit : result.fits) fit.bandRemarks.clear();
  if (!r_.request.settings.flag("predict.band")) return bands;
  parallelFor(
      static_cast<int>(bands.size()),
      [&](int i) {
        ModelResult::Fit& fit = result.fits[static_cast<std::size_t>(i)];
        FittedBand band = bandOf(r_, model, fit);
        bands[static_cast<std::size_t>(i)] = std::move(band.band);
        fit.bandRemarks = std::move(band.remarks);
      },
      progress_, "band " + model.id());
  return bands;
}

void Run::predictionsAndComparisons() {
  r_.inputs.set(Stage::Predictions, inputsText(r_.request.settings, {"predict", "evaluate"}, r_.inputs.of(Stage::Fits)));
  for (const std::string& name : r_.request.models) {
    ModelResult& result = r_.models[name];
    if (unchanged(Stage::Predictions) && previous_->models.count(name) && !previous_->models.at(name).oneFrame) {
      result.frames = previous_->models.at(name).frames;
      continue;
    }
    const HighlightModel& model = modelByName(name);
    struct Task {
      int frame, fit;
    };
    std::vector<Task> tasks;
    result.oneFrame = only_.frame.has_value();
    for (int frame = 0; frame < static_cast<int>(r_.scene->frames.size()); ++frame) {
      if (!only_.predicts(frame)) continue;
      for (int f = 0; f < static_cast<int>(result.fits.size()); ++f) {
        const ModelResult::Fit& fit = result.fits[f];
        if (fit.surface && *fit.surface != r_.surfaces->keyOf(frame)) continue;
        if (!isOn(*r_.scene, r_.request.whatIf, frame, fit.light)) continue;
        tasks.push_back({frame, f});
      }
    }
    result.frames.resize(tasks.size());
    std::atomic<int> predictions{0}, surfacesAsked{0};
    const std::vector<std::shared_ptr<const Band>> bands = bandsOf(model, result);
    parallelFor(
        static_cast<int>(tasks.size()),
        [&](int t) {
          const auto [frame, f] = tasks[t];
          const ModelResult::Fit& fit = result.fits[f];
          const Camera& camera = r_.scene->frames[frame].camera;
          const std::shared_ptr<const Surface> surface = fit.fit ? surfaceOfModel(r_, model, frame, fit.light) : nullptr;
          Prediction prediction = predictionFor(r_, fit, model, frame, camera, surface.get());
          if (fit.fit) ++predictions;
          if (fit.fit && model.needsLight()) ++surfacesAsked;
          if (const std::shared_ptr<const Band>& band =
                  bands[static_cast<std::size_t>(f)])  // not part of the time: no model needs it
            for (PredictedHighlight& h : prediction.editable()) h.sigmaPx = band->sigmaPx(h, camera, surface.get());
          result.frames[t] = compareFrame(r_.evidence[frame], fit.light, camera, std::move(prediction));
          result.frames[t].fit = f;
        },
        progress_, "predict " + name);
    r_.work.predictions += predictions;
    r_.work.surfacesAsked += surfacesAsked;
    r_.work.comparisons += static_cast<int>(tasks.size());
  }
}

/// The earlier run's what-if made the same scene.
bool sameScene(const Inspection& previous, const InspectionRequest& request) {
  const WhatIf &a = previous.request.whatIf, &b = request.whatIf;
  const auto level = [](const InspectionRequest& q) { return q.settings.number("detect.level"); };
  return a.synthesise == b.synthesise && posesKey(a) == posesKey(b) && synthesisKey(a) == synthesisKey(b) &&
         (!b.synthesise || level(previous.request) == level(request));
}

/// The scene with what a what-if changes; contours of the frames that this run and earlier ones looked at.
std::shared_ptr<const Scene> whatIfScene(const std::shared_ptr<const Scene>& given, const InspectionRequest& request,
                                         const TrainSpec& train, int onlyFrame, const ProgressFn& progress,
                                         const Inspection* previous) {
  const WhatIf& w = request.whatIf;
  if (!w.changesScene()) return given;
  const double level = request.settings.number("detect.level");
  const bool known = previous && previous->given == given && sameScene(*previous, request);
  if (!w.synthesise) return known ? previous->scene : changedScene(*given, w, level, progress);
  std::vector<int> missing;
  for (int i = 0; i < static_cast<int>(given->frames.size()); ++i) {
    const bool wanted =
        onlyFrame < 0 || train.perSurface || i == onlyFrame || std::binary_search(train.frames.begin(), train.frames.end(), i);
    const bool there = known && i < static_cast<int>(previous->evidence.size()) && previous->evidence[i].frame >= 0;
    if (wanted && !there) missing.push_back(i);
  }
  if (!known) return changedScene(*given, w, level, progress, &missing);
  return missing.empty() ? previous->scene : withContours(*previous->scene, w, level, missing, progress);
}

Inspection run(std::shared_ptr<const Scene> scene, const InspectionRequest& request, int onlyFrame, const ProgressFn& progress,
               const Inspection* previous, bool withoutPixels = false) {
  require(scene != nullptr, "inspect: no scene");
  Inspection result;
  result.given = scene;
  result.train = parseTrainSpec(request.train, *scene);
  result.scene = whatIfScene(scene, request, result.train, onlyFrame, progress, previous);
  if (!previous || previous->given != scene)
    result.surfaces = std::make_shared<SurfaceCache>(*result.scene);
  else if (previous->scene == result.scene)
    result.surfaces = previous->surfaces;
  else
    result.surfaces = std::make_shared<SurfaceCache>(*result.scene, *previous->surfaces);
  result.request = request;
  result.correctedDepthMaps = std::make_shared<CorrectedDepthMaps>();
  // A model named twice is one model.
  std::vector<std::string>& models = result.request.models;
  for (auto m = models.begin(); m != models.end();) m = std::find(models.begin(), m, *m) != m ? models.erase(m) : m + 1;
  if (request.noisePx > 0 && request.settings.text("fit.evidence") == "pixels")
    throw InputError("", "--noise-px", "noise is added to contours, which fit.evidence=pixels does not use");
  for (const std::string& m : request.models) modelByName(m);  // unknown names are refused before any work
  const PhotographsHeld held(*result.scene, result.train.frames);
  Run run(result, progress, previous, {onlyFrame >= 0 ? std::optional(onlyFrame) : std::nullopt, withoutPixels});
  run.highlights();
  run.lobes();
  run.changeHighlights();
  run.brightestPointsAndTangentPlanes();
  run.lights();
  run.canonicalContours();
  run.modelFits();
  run.predictionsAndComparisons();
  return result;
}
}  // namespace

Inspection inspect(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const ProgressFn& progress,
                   const Inspection* previous) {
  return run(std::move(scene), request, -1, progress, previous);
}

Inspection inspectOneFrame(std::shared_ptr<const Scene> scene, const InspectionRequest& request, int frame,
                           const ProgressFn& progress, const Inspection* previous) {
  require(scene && frame >= 0 && frame < static_cast<int>(scene->frames.size()), "inspectOneFrame: no such frame");
  return run(std::move(scene), request, frame, progress, previous);
}

std::optional<Inspection> firstLook(std::shared_ptr<const Scene> scene, const InspectionRequest& request, int frame,
                                    const ProgressFn& progress, const Inspection* previous) {
  require(scene && frame >= 0 && frame < static_cast<int>(scene->frames.size()), "firstLook: no such frame");
  const std::optional<InspectionRequest> quick =
      withoutPixels(*scene, request, previous && previous->given == scene ? previous : nullptr);
  if (!quick) return std::nullopt;
  return run(std::move(scene), *quick, frame, progress, previous, true);
}

}  // namespace glint

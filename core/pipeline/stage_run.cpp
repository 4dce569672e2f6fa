// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stage_run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <set>
#include <utility>

#include "core/base/progress.h"
#include "core/base/stage_times.h"
#include "core/model/pixel_evidence.h"
#include "core/pipeline/comparison.h"
#include "core/pipeline/corrected_depth.h"
#include "core/pipeline/diffuse_texture.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/fit_engine.h"
#include "core/pipeline/fits.h"
#include "core/pipeline/hand_edits.h"
#include "core/pipeline/highlight_motion.h"
#include "core/pipeline/known_lamps.h"
#include "core/pipeline/live_prediction.h"
#include "core/pipeline/lobe_stage.h"
#include "core/pipeline/training.h"
#include "core/pipeline/width_check.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

/// Counts what is alive, and the most there ever were.
class HeldFrame {
 public:
  HeldFrame(std::atomic<int>& now, std::atomic<int>& most) : now_(now) {
    const int count = ++now_;
    for (int seen = most; seen < count && !most.compare_exchange_weak(seen, count);) {
    }
  }
  ~HeldFrame() { --now_; }
  HeldFrame(const HeldFrame&) = delete;
  HeldFrame& operator=(const HeldFrame&) = delete;

 private:
  std::atomic<int>& now_;
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

}  // namespace

const Inspection* evidenceSource(const std::vector<const Inspection*>& known, const StageInputs& asked) {
  const Inspection* best = nullptr;
  std::pair<bool, std::ptrdiff_t> most;
  for (const Inspection* k : known) {
    if (!asked.same(Stage::Evidence, k->inputs)) continue;
    const std::pair has(asked.same(Stage::Lobes, k->inputs), std::count_if(k->evidence.begin(), k->evidence.end(),
                                                                           [](const FrameEvidence& e) { return e.frame >= 0; }));
    if (!best || has > most) best = k, most = has;
  }
  return best;
}

StageRun::StageRun(Inspection& result, const ProgressFn& progress, const std::vector<const Inspection*>& known, Only only)
    : r_(result), progress_(progress), known_(known), only_(only), together_(lightsAreOpenIn(*result.scene, result.request)) {}

bool StageRun::serves(const Inspection& known, Stage stage) const {
  if (pixelsComeTo(known) && stage != Stage::Evidence && stage != Stage::Lobes) {
    // Pixels that are attached later lie on the surface as given: a corrected one is made again with them.
    if (r_.inputs.evidence->detect.background == BackgroundUse::Lobe || !known.corrections.empty()) return false;
  }
  return r_.inputs.same(stage, known.inputs);
}

std::shared_ptr<const Surface> StageRun::surfaceOf(int frame) const {
  const Outcome<std::shared_ptr<const Surface>> s = r_.surfaces->surfaceOf(frame, meshPolicy(r_.request.settings));
  return s ? *s : nullptr;
}

/// A step that missed the surface gets the reason why the surface is missing: the file that cannot be read.
Failure StageRun::explained(int frame, const Failure& failure) const {
  if (failure.reason != Reason::NoSurface) return failure;
  const Outcome<std::shared_ptr<const Surface>> s = r_.surfaces->surfaceOf(frame, meshPolicy(r_.request.settings));
  return s ? failure : s.failure();
}

bool StageRun::anyModel(bool (HighlightModel::*needs)() const) const {
  return std::any_of(r_.request.models.begin(), r_.request.models.end(),
                     [&](const std::string& m) { return (modelByName(m).*needs)(); });
}

void StageRun::highlights() {
  const InspectionRequest& q = r_.request;
  r_.inputs.evidence = evidenceInputs(q, together_);
  r_.inputs.lobes = lobeInputs(q, r_.train, together_);
  std::vector<int> judged;
  std::optional<LightFrame> evidenceFrame;
  if (const Inspection* const known = evidenceSource(known_, r_.inputs)) {
    evidenceFrame = known->lightFrame.frame;
    r_.evidence = known->evidence;
    for (const auto& [frame, before] : known->evidenceBefore) r_.evidence[std::size_t(frame)] = before;
    if (serves(*known, Stage::Lobes)) {
      r_.detected = known->detected;
    } else {
      for (std::size_t i = 0; i < known->detected.size(); ++i)
        if (known->detected[i].frame >= 0) r_.evidence[i] = known->detected[i];
      if (!together_)
        for (FrameEvidence& e : r_.evidence) {
          if (e.frame < 0) continue;
          // Surfaces and poses may be others now.
          if (e.asSeen) e = FrameEvidence(*e.asSeen);
          returnTextures(e);
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
  takeTextureOff(
      r_, judged, [this](int frame) { return surfaceOf(frame); }, progress_);
  const LightFrame before = evidenceFrame.value_or(LightFrame::World);
  standInLightFrame();
  if (!together_ || (missing.empty() && before == r_.lightFrame.frame)) return;
  assignSeveralLights();
  standInLightFrame();  // lights that were one before may stand in different coordinates
}

/// From here on the scene is that in whose coordinates the lights stand still; answers in others do not serve.
void StageRun::standInLightFrame() {
  const SurfaceCache* const around = r_.surfaces.get();
  const auto inWorld = r_.scene == r_.world ? r_.surfaces : std::make_shared<const SurfaceCache>(*r_.world, *around);
  std::vector<int> training;
  for (const int frame : r_.train.frames)
    if (r_.isTraining(frame)) training.push_back(frame);
  r_.lightFrame = chooseLightFrame(*r_.world, *inWorld, training, r_.evidence, r_.request.settings);
  std::erase_if(known_, [&, &now = r_.lightFrame](const Inspection* k) {
    return k->lightFrame.frame != now.frame || k->lightFrame.elsewhere != now.elsewhere;
  });
  const auto same = std::find_if(known_.begin(), known_.end(), [&](const Inspection* k) { return k->world == r_.world; });
  if (same != known_.end()) {
    r_.scene = (*same)->scene;
    r_.surfaces = (*same)->surfaces;
    return;
  }
  const bool worldly =
      r_.lightFrame.frame == LightFrame::World && std::all_of(r_.world->lights.begin(), r_.world->lights.end(),
                                                              [](const TrueLight& l) { return l.frame == LightFrame::World; });
  r_.scene = worldly ? r_.world : std::make_shared<const Scene>(inLightFrame(*r_.world, r_.lightFrame.frame));
  r_.surfaces = worldly ? inWorld : std::make_shared<const SurfaceCache>(*r_.scene, *around);
}

/// Frames whose evidence does not exist yet and is asked for.
std::vector<int> StageRun::framesToGather() const {
  std::vector<int> frames;
  const bool all = !only_.frame || r_.train.perSurface || together_;
  for (int i = 0; i < static_cast<int>(r_.evidence.size()); ++i)
    if (r_.evidence[static_cast<std::size_t>(i)].frame < 0 &&
        (all || only_.predicts(i) || std::binary_search(r_.train.frames.begin(), r_.train.frames.end(), i)))
      frames.push_back(i);
  return frames;
}

void StageRun::gather(const std::vector<int>& frames) {
  r_.work.framesDetected += static_cast<int>(frames.size());
  // Images live only inside one call: as many at once as there are threads, whatever the number of frames.
  std::atomic<int> held{0}, most{0};
  parallelFor(
      static_cast<int>(frames.size()),
      [&](int n) {
        const int i = frames[n];
        const HeldFrame inMemory(held, most);
        r_.evidence[i] = evidenceFor(*r_.scene, i, *r_.inputs.evidence);
      },
      progress_, "detect");
  r_.work.framesHeldAtOnce = std::max<int>(r_.work.framesHeldAtOnce, most);
}

void StageRun::lobes() {
  r_.pixelsLeft = only_.withoutPixels;
  if (r_.pixelsLeft) return;
  const SurfaceOfFrame surface = [this](int frame) { return surfaceOf(frame); };
  if (const Inspection* const known = source(Stage::Lobes, [](const Inspection& k) { return !k.pixelsLeft; })) {
    r_.patches = known->patches;
    r_.pixelFits = known->pixelFits;
    r_.unexplained = known->unexplained;
    r_.pixelDoubts = known->pixelDoubts;
  } else {
    fitLobes(r_, surface, together_, progress_);
  }
  contourAgain(r_, surface, progress_);
}

void StageRun::assignSeveralLights() {
  glint::assignSeveralLights(
      *r_.scene, r_.evidence, [&](int frame) { return surfaceOf(frame); },
      [&](int frame, const SeparateLights& lights) {
        FrameEvidence again = gatherEvidence(*r_.scene, frame, r_.request.source, r_.inputs.evidence->detect, lights,
                                             r_.evidence[static_cast<std::size_t>(frame)].diffuse);
        dropTextures(again, r_.evidence[static_cast<std::size_t>(frame)].textures);
        return again;
      },
      elsewhereFromScene(), progress_);
}

/// For each frame the way to the coordinates in which lights stand still that do not in the scene's; empty where they are not
/// looked for, or are the same.
std::vector<Eigen::Isometry3d> StageRun::elsewhereFromScene() const {
  std::vector<Eigen::Isometry3d> all;
  if (r_.request.settings.text("light.frame") != "auto") return all;
  for (const Frame& frame : r_.world->frames) {
    const Eigen::Isometry3d& camFromWorld = frame.camera.camFromWorld;
    all.push_back(r_.lightFrame.frame == LightFrame::World ? camFromWorld : camFromWorld.inverse());
  }
  const bool still = std::all_of(all.begin(), all.end(), [&](const Eigen::Isometry3d& t) { return t.isApprox(all.front()); });
  return still ? std::vector<Eigen::Isometry3d>() : all;
}

/// The user's changes to single highlights and lights come after detection, so that none of them detects anything again.
void StageRun::changeHighlights() {
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

void StageRun::brightestPointsAndTangentPlanes() {
  const InspectionRequest& q = r_.request;
  r_.inputs.views = viewInputs(q, r_.train);
  if (const Inspection* const known = source(Stage::Views)) {
    r_.views = known->views;
    for (std::size_t v = 0; v < r_.views.size(); ++v) r_.views[v] = known->viewAsGiven(static_cast<int>(v));
    viewsLackPixels_ = pixelsComeTo(*known);
    return;
  }
  int done = 0;
  std::vector<int> used;
  const std::map<FitKey, CutUse> cut = useOfCut(r_, CutUse::Arc);
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
      const CutUse use = cut.at(r_.keyFor(frame, evidence.highlights[static_cast<std::size_t>(h)].light));
      r_.views.push_back(trainingViewIn(r_, evidence, h, surfaceOf(frame), use));
      if (TrainingView& view = r_.views.back(); !view.seen) view.seen = explained(frame, view.seen.failure());
    }
  }
  r_.work.trainingViews = static_cast<int>(r_.views.size());
  attachPixels(r_);
}

std::vector<StageRun::Group> StageRun::groups() const {
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
  // A known lamp needs no photograph of its own.
  if (!r_.train.perSurface)
    for (const TrueLight& light : r_.scene->lights)
      if (light.known) groupOf(0, light.id);
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

void StageRun::lights() {
  const std::vector<Group> all = groups();
  std::vector<FitKey> keys;
  for (const Group& g : all) keys.push_back(g.key);
  std::set<std::string> stages{"light"};
  if (r_.request.settings.flag("light.refine_normals"))
    stages.insert("fit");  // which model explains the contours better depends on how it is fitted
  r_.inputs.lights = LightInputs{settingsOf(r_.request.settings, stages), std::move(keys)};
  if (!anyModel(&HighlightModel::needsLight)) return;
  if (const Inspection* const known = source(Stage::Lights, [](const Inspection& k) { return !k.lights.empty(); })) {
    r_.lights = known->lights;
    r_.corrections = known->corrections;
    r_.viewsAsGiven = known->viewsAsGiven;
    r_.correctedDepthMaps = known->correctedDepthMaps;
    for (const auto& [v, given] : r_.viewsAsGiven) {
      r_.views[static_cast<std::size_t>(v)] = known->views[static_cast<std::size_t>(v)];
      r_.views[static_cast<std::size_t>(v)].canonical.reset();
    }
    return;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!report(progress_, {"light", static_cast<int>(i), static_cast<int>(all.size())})) throw Stopped{};
    const FitKey& key = all[i].key;
    const std::optional<KnownLamp> lamp = knownLamp(*r_.scene, key.light);
    if (!lamp && !isSeen(r_, key.light)) {
      r_.lights.insert_or_assign(
          key, Failure{Reason::NoHighlight, key.light + " has none that can be distinguished from those of other lights"});
      continue;
    }
    LightFit fit = fitLight(r_.viewsOf(key, true), *r_.scene, *r_.surfaces, r_.request.settings);
    ++r_.work.lights;
    r_.lights.insert_or_assign(key, std::move(fit.light));
    if (!fit.correction) continue;
    if (lamp) {  // the views of the fit are those of other lamps, too, and were carried
      fit.views = ownViews(all[i]);
      correctViews(fit.views, *r_.scene, *r_.surfaces, fit.correction, meshPolicy(r_.request.settings));
    }
    correct(all[i], fit.correction, std::move(fit.views));
  }
}

/// Those of its light alone, where they stand in the scene.
std::vector<TrainingView> StageRun::ownViews(const Group& group) const {
  std::vector<TrainingView> views;
  for (const int v : group.views) views.push_back(r_.views[static_cast<std::size_t>(v)]);
  return views;
}

void StageRun::correct(const Group& group, const SurfaceCorrection& correction, std::vector<TrainingView> corrected) {
  r_.corrections.insert_or_assign(group.key, correction);
  for (std::size_t i = 0; i < group.views.size(); ++i) {
    TrainingView& view = r_.views[static_cast<std::size_t>(group.views[i])];
    r_.viewsAsGiven.insert_or_assign(group.views[i], std::exchange(view, std::move(corrected[i])));
  }
}

void StageRun::canonicalContours() {
  r_.inputs.fits = settingsOf(r_.request.settings, {"fit"});
  if (!anyModel(&HighlightModel::needsCanonicalContours)) return;
  const auto had = [](const Inspection& k) {
    return std::any_of(k.views.begin(), k.views.end(), [](const TrainingView& v) { return v.canonical.has_value(); });
  };
  if (const Inspection* const known = source(Stage::Fits, had)) {
    r_.views = known->views;  // equal inputs: the same views
    viewsLackPixels_ = pixelsComeTo(*known);
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

void StageRun::modelFits() {
  if (viewsLackPixels_) attachPixels(r_);
  const std::vector<Group> all = groups();
  int done = 0;
  std::map<FitKey, Doubts> doubts;  // the same for all models
  const auto doubtsOf = [&](const Group& group) -> const Doubts& {
    const auto [found, isNew] = doubts.try_emplace(group.key);
    if (!isNew) return found->second;
    const LightEstimate* const estimate = r_.lightOf(group.key);
    const std::optional<Light> light = estimate ? std::optional(estimate->light) : std::nullopt;
    const std::vector<TrainingView> views = ownViews(group);
    found->second = {widthDoubt(views, light), mergedPeaks(views, light, r_.request.settings),
                     estimate && estimate->known ? knownLampDoubt(views, *estimate) : std::string()};
    return found->second;
  };
  for (const std::string& name : r_.request.models) {
    ModelResult& result = r_.models[name];
    result.model = name;
    if (const Inspection* const known = source(Stage::Fits, [&](const Inspection& k) { return k.models.count(name) > 0; })) {
      result.fits = known->models.at(name).fits;
      continue;
    }
    for (const Group& g : all) {
      const StageEvent now{"fit " + name, done++, static_cast<int>(all.size() * r_.request.models.size())};
      if (!report(progress_, now)) throw Stopped{};
      result.fits.push_back(
          fitOf(modelByName(name), g.key, doubtsOf(g), [&](const StageEvent&) { return report(progress_, now); }));
      ++r_.work.fits;
    }
  }
}

ModelResult::Fit StageRun::fitOf(const HighlightModel& model, const FitKey& key, const Doubts& doubts,
                                 const ProgressFn& goesOn) const {
  ModelResult::Fit entry;
  entry.light = key.light;
  entry.surface = key.surface;
  FitInput input = fitInputOf(r_, model, key);
  input.progress = goesOn;
  const std::optional<KnownLamp> known = knownLamp(*r_.scene, key.light);
  const auto& [widths, merged, place] = doubts;
  const auto start = std::chrono::steady_clock::now();
  entry.fit = model.fit(input, r_.request.settings);
  if (entry.fit && known)
    entry.fit =
        fitOfKnownLamp(*std::move(entry.fit), key.light, *known, input.views, r_.request.settings.number("fit.most_residual"));
  if (entry.fit && merged && merged->certain) entry.fit = Failure{Reason::NotConverged, merged->text};
  if (!entry.fit) {
    Failure why = entry.fit.failure();
    if (why.reason == Reason::RankDeficient && r_.lightFrame.frameOf(key.light) == LightFrame::Camera)
      why.detail += "; the lamp moves with the camera, and in the lamp's coordinates all cameras are one";
    if (r_.request.settings.text("light.frame") != "auto" && !r_.lightFrame.doubt.empty())
      why.detail += "; " + r_.lightFrame.doubt;
    if (together_ && input.views.empty())
      why.detail += "; no training frame shows this light: lamps may be switched between frames";
    if (merged && why.detail != merged->text) why.detail += "; " + merged->text;
    for (const std::string& doubt : {widths, place})
      if (!doubt.empty()) why.detail += "; " + doubt;
    entry.fit = std::move(why);
    return entry;
  }
  ModelFit& fit = *entry.fit;
  fit.model = model.id();
  fit.light = key.light;
  fit.surface = key.surface;
  if (fit.poor.empty()) fit.poor = place;
  const auto add = [&](std::string remark) {
    if (!remark.empty()) fit.remarks.push_back(std::move(remark));
  };
  add(r_.lightFrame.doubt);
  add(mergedRemark(r_, fit));
  add(oneViewRemark(r_, fit));
  add(repeatedRemark(r_, fit));
  add(cutRemark(r_, fit));
  add(byHandRemark(r_, fit));
  add(textureRemark(r_));
  add(takenOffRemark(r_));
  add(switchedRemark(r_, fit, [this](int frame) { return surfaceOf(frame); }));
  add(widths);
  if (merged) add(merged->text);
  if (const auto doubt = r_.pixelDoubts.find(key); doubt != r_.pixelDoubts.end()) add(doubt->second);
  if (r_.surfaces) add(r_.surfaces->fusionRemark(fit.frames));
  if (const auto found = r_.corrections.find(key); found != r_.corrections.end() && model.needsLight()) {
    if (found->second.smoothed) fit.remarks.push_back(found->second.smoothed->remark());
    if (found->second.normals) fit.remarks.push_back(found->second.normals->remark());
  }
  fit.timeUs = microsecondsSince(start);
  return entry;
}

/// One band per fit with predict.band, else nulls.
std::vector<std::shared_ptr<const Band>> StageRun::bandsOf(const HighlightModel& model, ModelResult& result) {
  std::vector<std::shared_ptr<const Band>> bands(result.fits.size());
  for (ModelResult::Fit& fit : result.fits) fit.bandRemarks.clear();
  if (!r_.request.settings.flag("predict.band")) return bands;
  std::vector<FittedBand> found = glint::bandsOf(r_, model, result.fits, progress_);
  for (std::size_t i = 0; i < found.size(); ++i) {
    bands[i] = std::move(found[i].band);
    result.fits[i].bandRemarks = std::move(found[i].remarks);
  }
  return bands;
}

void StageRun::predictionsAndComparisons() {
  r_.inputs.predictions = settingsOf(r_.request.settings, {"predict", "evaluate"});
  for (const std::string& name : r_.request.models) {
    const auto ofAll = [&](const Inspection& k) {
      const auto model = k.models.find(name);
      return model != k.models.end() && !model->second.oneFrame;
    };
    if (const Inspection* const known = source(Stage::Predictions, ofAll))
      r_.models[name] = known->models.at(name);
    else
      predict(modelByName(name), r_.models[name]);
  }
}

void StageRun::predict(const HighlightModel& model, ModelResult& result) {
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
      if (!isPredicted(*r_.scene, r_.request, frame, fit.light)) continue;
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
        const Camera camera = r_.cameraFor(frame, fit.light);
        const std::shared_ptr<const Surface> surface = fit.fit ? surfaceOfModel(r_, model, frame, fit.light) : nullptr;
        const std::optional<ModelResult::Fit> there =
            fitAtObservedLevel(fit, model, r_.evidence[frame], camera, surface.get(), r_.request.settings);
        Prediction prediction = predictionFor(r_, there ? *there : fit, model, frame, camera, surface.get());
        if (fit.fit) ++predictions;
        if (fit.fit && model.needsLight()) ++surfacesAsked;
        if (const std::shared_ptr<const Band>& band =
                bands[static_cast<std::size_t>(f)])  // not part of the time: no model needs it
          for (PredictedHighlight& h : prediction.editable()) h.sigmaPx = band->sigmaPx(h, camera, surface.get());
        result.frames[t] = compareFrame(r_.evidence[frame], fit.light, camera, std::move(prediction));
        result.frames[t].fit = f;
      },
      progress_, "predict " + model.id());
  r_.work.predictions += predictions;
  r_.work.surfacesAsked += surfacesAsked;
  r_.work.comparisons += static_cast<int>(tasks.size());
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/minimal_repro.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "core/app/session.h"
#include "core/base/atomic_file.h"
#include "core/base/minimal_subset.h"
#include "core/base/number_text.h"
#include "core/base/safe_text.h"
#include "core/pipeline/comparison.h"
#include "core/pipeline/fit_engine.h"
#include "core/pipeline/frame_score.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

Fault faultOf(const FrameComparison& c, const std::string& model) {
  Fault fault{c.frame, model, c.light, scoreOf(c).errorPct, {}};
  if (fault.errorPct) return fault;
  const auto failed =
      std::find_if(c.rows.begin(), c.rows.end(), [](const FrameComparison::Row& row) { return row.failure.has_value(); });
  fault.reason = c.prediction.failure()   ? c.prediction.failure()->reason
                 : failed != c.rows.end() ? failed->failure->reason
                                          : Reason::NoHighlight;  // nothing observed
  return fault;
}

/// The views of one fit, on their surfaces as given: of its light, and of its surface where models are per surface.
std::vector<TrainingView> viewsOf(const Inspection& inspection, const Fault& fault) {
  std::vector<TrainingView> views = inspection.viewsOf(inspection.keyFor(fault.frame, fault.light), true);
  // The small scene has one lamp.
  std::erase_if(views, [&](const TrainingView& v) { return v.highlight.light != fault.light; });
  return views;
}

/// The answer of the model fitted to some of the views.
Fault answer(const Inspection& inspection, const Fault& fault, const std::vector<TrainingView>& all,
             const std::vector<int>& frames, const ProgressFn& progress) {
  const HighlightModel& model = modelByName(fault.model);
  const Settings& settings = inspection.request.settings;
  std::vector<TrainingView> views;
  std::copy_if(all.begin(), all.end(), std::back_inserter(views),
               [&](const TrainingView& v) { return std::find(frames.begin(), frames.end(), v.frame) != frames.end(); });
  std::optional<LightFit> light;
  if (model.needsLight())
    light = fitLight(views, *inspection.scene, *inspection.surfaces, settings,
                     inspection.chosenFor(inspection.keyFor(fault.frame, fault.light)));
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(fault.frame)].camera;
  Prediction prediction;
  const Outcome<ModelFit> fit = light ? fitModel(model, light->views, light->light, settings, {}, progress)
                                      : fitModel(model, std::move(views), std::nullopt, settings);
  if (fit) {
    std::shared_ptr<const Surface> surface;
    if (light)
      if (auto found =
              correctedSurface(*inspection.scene, *inspection.surfaces, fault.frame, light->correction, meshPolicy(settings)))
        surface = *found;
    prediction = model.predict(*fit, camera, surface.get(), settings);
  } else {
    prediction = fit.failure();
  }
  return faultOf(
      compareFrame(inspection.evidence[static_cast<std::size_t>(fault.frame)], fault.light, camera, std::move(prediction)),
      fault.model);
}

/// A copy of a file in a folder of the new scene; "" without a file. Two frames of one file share the copy.
fs::path copied(const fs::path& file, const fs::path& folder, std::map<fs::path, fs::path>& done) {
  if (file.empty()) return {};
  if (const auto found = done.find(file); found != done.end()) return found->second;
  std::error_code error;
  fs::create_directories(folder, error);
  fs::path to = folder / copyNameOf(file);
  for (int n = 2; fs::exists(to); ++n) to = folder / copyNameOf(file, n);
  fs::copy_file(file, to, error);
  if (error) throw InputError(file.string(), "", "cannot be copied: " + error.message());
  return done[file] = to;
}

/// The highlights of the fault's light, as the fit and the comparison had them.
std::vector<Highlight> evidenceOf(const Inspection& inspection, const Fault& fault, int frame, bool trains) {
  std::vector<Highlight> all;
  if (trains)
    for (const TrainingView& v : inspection.views)
      if (v.frame == frame && v.highlight.light == fault.light) all.push_back(v.highlight);
  if (!trains)
    for (const Highlight& h : inspection.evidence[static_cast<std::size_t>(frame)].scored())
      if (h.light == fault.light) all.push_back(h);
  return all;
}

Scene smallScene(const Inspection& inspection, const MinimalRepro& repro, const fs::path& folder, const ProgressFn& progress) {
  const Fault& fault = repro.before;
  const Scene& from = *inspection.scene;
  Scene scene;
  scene.name = from.name + ", minimal";
  scene.folder = folder;
  scene.file = folder / "scene.json";
  for (const TrueLight& light : from.lights)
    if (light.id == fault.light) scene.lights.push_back(light);
  std::vector<int> frames = repro.kept;
  if (std::find(frames.begin(), frames.end(), fault.frame) == frames.end()) frames.push_back(fault.frame);
  std::map<fs::path, fs::path> done;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!report(progress, {"copying", static_cast<int>(i), static_cast<int>(frames.size())})) throw Stopped{};
    Frame f = from.frames[static_cast<std::size_t>(frames[i])];
    for (const auto& [path, name] : {std::pair(&f.image, "frames"),
                                     {&f.radiance, "radiance"},
                                     {&f.depth, "depth"},
                                     {&f.normals, "normals"},
                                     {&f.mask, "mask"}})
      *path = copied(*path, folder / name, done);
    f.lightsOn = {fault.light};
    f.highlights = evidenceOf(inspection, fault, frames[i], i < repro.kept.size());
    for (Highlight& h : f.highlights) h.fromScene = true;
    if (const auto source = from.surfaces.find(f.surface); source != from.surfaces.end() && !scene.surfaces.count(f.surface)) {
      SurfaceSource& surface = scene.surfaces[f.surface] = source->second;
      if (SurfaceFile* const read = surface.file()) read->file = copied(read->file, folder / "surface", done);
    }
    scene.frames.push_back(std::move(f));
  }
  return scene;
}

}  // namespace

std::string Fault::text() const {
  if (reason) return nameOf(*reason);
  const double error = errorPct.value_or(0);
  // Not "1.13e+03": whole percents from a hundred on, in groups of three digits from a thousand on.
  std::string text = formatted(error < 99.95 ? "%.3g" : error < 1e15 ? "%.0f" : "%.3g", error);
  if (error >= 99.95 && error < 1e15)
    for (int at = static_cast<int>(text.size()) - 3; at > 0; at -= 3) text.insert(static_cast<std::size_t>(at), ",");
  return "contour error " + text + " %";
}

bool sameFault(const Fault& was, const Fault& now, const FaultTolerance& tolerance) {
  if (was.reason || now.reason) return was.reason == now.reason;
  const double slack = tolerance.share * *was.errorPct;
  return *now.errorPct >= *was.errorPct - slack &&
         (tolerance.kept == FaultKept::AtLeast || *now.errorPct <= *was.errorPct + slack);
}

Outcome<Fault> faultOf(const Inspection& inspection, int frame, const std::string& model, const std::string& light) {
  const auto result = inspection.models.find(model);
  if (result == inspection.models.end()) return Failure{Reason::NotSupported, "the model " + model + " is not computed"};
  std::optional<Fault> worst;
  for (const FrameComparison& c : result->second.frames) {
    if (c.frame != frame || (!light.empty() && c.light != light)) continue;
    Fault fault = faultOf(c, model);
    if (!worst || fault.errorPct.value_or(-1) > worst->errorPct.value_or(-1)) worst = std::move(fault);
  }
  if (!worst) return Failure{Reason::NotSupported, "nothing is predicted for this frame"};
  return *worst;
}

Outcome<MinimalRepro> minimalRepro(const Inspection& inspection, const Fault& fault, const FaultTolerance& tolerance,
                                   const ProgressFn& progress) {
  require(inspection.scene && inspection.surfaces, "minimalRepro: the inspection is empty");
  require(fault.frame >= 0 && fault.frame < static_cast<int>(inspection.scene->frames.size()), "minimalRepro: no such frame");
  require(tolerance.share >= 0 && tolerance.share <= 1, "minimalRepro: the tolerance is a share");
  const std::vector<TrainingView> views = viewsOf(inspection, fault);
  std::set<int> training;
  for (const TrainingView& v : views) training.insert(v.frame);
  const bool trains = training.count(fault.frame) > 0;
  MinimalRepro result;
  result.before = result.after = fault;
  result.of = static_cast<int>(training.size());
  std::vector<int> items(training.begin(), training.end());
  const auto withFault = [&](std::vector<int> frames) {
    if (trains) frames.insert(std::lower_bound(frames.begin(), frames.end(), fault.frame), fault.frame);
    return frames;
  };
  if (trains) std::erase(items, fault.frame);
  const ProgressFn quiet = [&](const StageEvent&) {
    return report(progress, {"trying", result.asked, 0});
  };  // only to be stopped
  const auto shows = [&](const std::vector<int>& frames) {
    ++result.asked;
    return sameFault(fault, answer(inspection, fault, views, withFault(frames), quiet), tolerance);
  };
  if (!report(progress, {"trying", 0, 0})) throw Stopped{};
  if (!shows(items)) return Failure{Reason::NotReached, "a fit to the same frames does not show the selected error"};
  const auto ask = [&](int asked, int left) {
    return report(progress, {"trying, " + std::to_string(left) + " frames left", asked, 0});
  };
  items = shows({}) ? std::vector<int>{} : minimalSubset(std::move(items), shows, ask);
  result.kept = withFault(items);
  result.after = answer(inspection, fault, views, result.kept, quiet);
  return result;
}

WrittenRepro writeRepro(const Inspection& inspection, const MinimalRepro& repro, const FaultTolerance& tolerance,
                        const fs::path& folder, const ProgressFn& progress) {
  WrittenRepro written;
  const Fault& fault = repro.before;
  atomicFolder(folder, [&](const fs::path& out) {
    const Scene scene = smallScene(inspection, repro, out, progress);
    writeScene(scene, scene.file);
    InspectionRequest request = inspection.request;
    request.models = {fault.model};
    request.excluded.clear();
    request.noisePx = 0;  // it is in the contours
    request.truthFolder.clear();
    request.whatIf = {};
    // Frames that train come first; a fit without any needs one that the session can name.
    if (!inspection.train.perSurface) request.train = "first:" + std::to_string(std::max<std::size_t>(repro.kept.size(), 1));
    const Inspection small = inspect(std::make_shared<const Scene>(readScene(scene.file)), request, progress);
    int at = static_cast<int>(std::find(repro.kept.begin(), repro.kept.end(), fault.frame) - repro.kept.begin());
    const Outcome<Fault> now = faultOf(small, at, fault.model, fault.light);
    written.fault = now ? *now : Fault{at, fault.model, fault.light, {}, now.failure().reason};
    written.shows = sameFault(fault, written.fault, tolerance);
    Session session = sessionOf(small, progress);
    session.view.frame = scene.frames[static_cast<std::size_t>(at)].id;
    session.view.model = fault.model;
    session.view.light = fault.light;
    session.notes = "Minimal session: " + fault.model + ", frame " + session.view.frame + ", " + fault.text() + " with " +
                    std::to_string(repro.of) + " training frames, " + written.fault.text() + " with the " +
                    std::to_string(repro.kept.size()) + " kept here.";
    writeSession(session, out / "repro.glint");
  });
  written.session = folder / "repro.glint";
  return written;
}

}  // namespace glint

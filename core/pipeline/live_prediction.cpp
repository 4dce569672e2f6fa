// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/live_prediction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/number_text.h"
#include "core/base/stage_times.h"
#include "core/geometry/light.h"
#include "core/geometry/polyline.h"
#include "core/model/plausible.h"
#include "core/pipeline/carried.h"
#include "core/pipeline/fits.h"
#include "core/pipeline/pipeline.h"
#include "core/reflectance/lobe.h"
#include "core/surface/mesh_policy.h"
#include "core/surface/occlusion.h"
#include "core/surface/posed_surface.h"

namespace glint {

namespace {

bool sameIntrinsics(const Camera& a, const Camera& b) {
  return a.pixelFromRay == b.pixelFromRay && a.lens == b.lens && a.width == b.width && a.height == b.height;
}

}  // namespace

std::shared_ptr<const Surface> surfaceOfModel(const Inspection& inspection, const HighlightModel& model, int frame,
                                              const std::string& light) {
  if (!model.needsLight() || frame < 0) return nullptr;
  Outcome<std::shared_ptr<const Surface>> found = surfaceFor(inspection, frame, light);
  return found ? *std::move(found) : nullptr;
}

Prediction predictionFor(const Inspection& inspection, const ModelResult::Fit& fit, const HighlightModel& model, int frame,
                         const Camera& camera, const Surface* surface) {
  if (!fit.fit) return fit.fit.failure();
  const Clock::time_point start = Clock::now();
  Prediction prediction = model.predict(*fit.fit, camera, surface, inspection.request.settings);
  prediction.timeUs = microsecondsSince(start);
  dropTooSmall(prediction);
  filterPrediction(prediction, *fit.fit, camera, surface, inspection.request.settings);
  const Failure* const why = prediction.failure();
  if (!why) return prediction;
  if (why->reason != Reason::NoSurface) return prediction.filtered.empty() ? Prediction(*why) : prediction;
  if (frame < 0) return Failure{Reason::NoSurface, "the frames see different surfaces, and none of them has this id"};
  // A step that missed the surface gets the reason why the surface is missing: the file that cannot be read.
  const auto given = inspection.surfaces->surfaceOf(frame, meshPolicy(inspection.request.settings));
  return given ? *why : given.failure();
}

bool isPredicted(const Scene& scene, const InspectionRequest& request, std::optional<int> frame, const std::string& light) {
  if (!request.lights.empty()) return std::count(request.lights.begin(), request.lights.end(), light) > 0;
  return !frame || isOn(scene, request.whatIf, *frame, light);
}

LivePredictor::LivePredictor(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const ProgressFn& progress) {
  require(scene != nullptr && !scene->frames.empty(), "LivePredictor: no scene");
  const TrainSpec train = parseTrainSpec(request.train, *scene);
  // Fits need the training frames alone; of the predictions one is enough to load the surface and to build its trees.
  InspectionRequest fits = request;
  fits.settings.set("predict.band", false);  // of the one prediction; that of the poses is below
  inspection_ = answer(std::move(scene), {fits, Question::Part::Frame, train.frames.front()}, progress);
  inspection_.request = request;
  if (request.settings.flag("predict.band"))
    for (auto& [name, result] : inspection_.models) {
      std::vector<FittedBand> bands = bandsOf(inspection_, modelByName(name), result.fits, progress);
      for (std::size_t i = 0; i < bands.size(); ++i) {
        result.fits[i].bandRemarks = std::move(bands[i].remarks);
        if (bands[i].band) bands_.emplace(std::pair(name, result.fits[i].key()), std::move(bands[i].band));
      }
    }
  const std::vector<Frame>& frames = inspection_.scene->frames;
  const SurfaceCache& surfaces = *inspection_.surfaces;
  bool oneCamera = true, oneSurface = true;
  for (int f = 0; f < static_cast<int>(frames.size()); ++f) {
    const Frame& frame = frames[static_cast<std::size_t>(f)];
    frames_.emplace(frame.id, f);
    oneCamera = oneCamera && sameIntrinsics(frame.camera, frames.front().camera);
    oneSurface = oneSurface && surfaces.keyOf(f) == surfaces.keyOf(0);
  }
  if (oneCamera) sharedCamera_ = frames.front().camera;
  if (oneSurface) anyFrameOfSurface_ = 0;
}

std::optional<Failure> LivePredictor::failure() const {
  std::optional<Failure> first;
  for (const std::string& name : inspection_.request.models)
    for (const ModelResult::Fit& fit : inspection_.models.at(name).fits) {
      if (fit.fit) return std::nullopt;
      if (!first) first = Failure{fit.fit.failure().reason, name + ": " + fit.fit.failure().detail};
    }
  return first ? first : Failure{Reason::NoHighlight, "no training frame shows a highlight of a named light"};
}

Outcome<LiveAnswer> LivePredictor::predict(const std::string& id, const Eigen::Isometry3d& cameraFromWorld,
                                           const std::optional<Camera>& camera,
                                           const std::optional<Eigen::Isometry3d>& worldFromObject) const {
  LiveAnswer answer;
  if (const auto found = frames_.find(id); found != frames_.end()) answer.frame = found->second;
  const Scene& scene = *inspection_.scene;
  if (camera)
    answer.camera = *camera;
  else if (answer.frame)
    answer.camera = scene.frames[static_cast<std::size_t>(*answer.frame)].camera;
  else if (sharedCamera_)
    answer.camera = *sharedCamera_;
  else
    return Failure{Reason::NotSupported,
                   "the frames have different cameras, and none of them has this id: the line needs a camera"};
  Eigen::Isometry3d place = worldFromObject.value_or(Eigen::Isometry3d::Identity());
  if (!worldFromObject && answer.frame)
    place = inspection_.world->frames[static_cast<std::size_t>(*answer.frame)].worldFromObject;
  const auto fromWorld = [&](LightFrame frame) {
    return frame == LightFrame::Camera ? cameraFromWorld : Eigen::Isometry3d::Identity();
  };
  const auto cameraIn = [&](LightFrame frame) {
    Camera there = answer.camera;
    there.camFromWorld = frame == LightFrame::Camera ? Eigen::Isometry3d::Identity() : cameraFromWorld;
    return there;
  };
  const LightFrame of = inspection_.lightFrame.frame;
  answer.camera = cameraIn(of);
  const std::optional<int> frame = answer.frame ? answer.frame : anyFrameOfSurface_;
  for (const std::string& name : inspection_.request.models) {
    const HighlightModel& model = modelByName(name);
    for (const ModelResult::Fit& fit : inspection_.models.at(name).fits) {
      if (fit.surface && frame && *fit.surface != inspection_.surfaces->keyOf(*frame)) continue;
      if (!isPredicted(scene, inspection_.request, answer.frame, fit.light)) continue;
      std::shared_ptr<const Surface> surface = surfaceOfModel(inspection_, model, frame.value_or(-1), fit.light);
      const LightFrame own = inspection_.lightFrame.frameOf(fit.light);
      const Camera eye = cameraIn(own);
      if (surface && !scene.frames[static_cast<std::size_t>(*frame)].surface.empty())
        surface = movedTo(fromWorld(own) * place, std::move(surface));
      Prediction prediction = predictionFor(inspection_, fit, model, frame.value_or(-1), eye, surface.get());
      if (const auto band = bands_.find({name, fit.key()}); band != bands_.end())
        for (PredictedHighlight& h : prediction.editable()) h.sigmaPx = band->second->sigmaPx(h, eye, surface.get());
      if (own != of) carry(prediction, fromWorld(of) * fromWorld(own).inverse());
      answer.highlights.push_back({name, fit.light, std::move(prediction), fit.fit ? fit.fit->poor : ""});
    }
  }
  return answer;
}

namespace {

/// log of the radiance relative to what mirrors exactly; nothing if the fit does not tell.
std::optional<double> logBrightness(const ModelFit& fit, const PredictedHighlight& h, const Eigen::Vector3d& eye, double level) {
  if (!fit.lightEstimate) return std::nullopt;
  const SurfacePoint at = facing(h.brightest.point, eye);
  const Eigen::Vector3d toLight = fit.lightEstimate->directionFrom(at.position), toCamera = (eye - at.position).normalized();
  if (!toLight.allFinite() || !toCamera.allFinite()) return std::nullopt;
  if (const ReflectanceFit* const lobe = fit.as<ReflectanceFit>()) {
    const std::optional<LogRadiance> radiance = logRadiance(lobe->lobe, lobe->roughness.mean, at.normal, toLight, toCamera);
    return radiance ? std::optional(radiance->total()) : std::nullopt;
  }
  const std::optional<double> limit = fit.limitAngle();
  const double alpha = incidentAngle(at.normal, toLight, toCamera);
  if (!limit || !(*limit > 0) || !(*limit < std::numbers::pi / 2) || !(alpha < std::numbers::pi / 2)) return std::nullopt;
  const double share = std::tan(alpha) / std::tan(*limit);
  return std::log(level) * share * share;
}

std::optional<std::string> tooFaint(const std::optional<double>& own, const std::optional<double>& brightest, double least) {
  if (!(least > 0) || !own || !brightest) return std::nullopt;
  const double share = std::exp(*own - *brightest);
  if (share >= least) return std::nullopt;
  return formatted("weaker than predict.filter_brightness: %.2g of the brightest predicted one, of at least %.3g", share, least);
}

/// Asks for the contour's middle on the surface: a brightest point may lie beside what makes the outline.
bool shadowed(const ModelFit& fit, const PredictedHighlight& h, const Camera& camera, const Surface* surface) {
  if (!surface || !fit.lightEstimate) return false;
  const Outcome<SurfacePoint> hit = surface->firstHit(camera.ray(centroid(h.contour)));
  if (!hit) return false;
  const Eigen::Vector3d eye = camera.centreInWorld();
  const SurfacePoint at = facing(*hit, eye);
  return surface->occluded(at, occlusionTarget(*surface, at.position, *fit.lightEstimate, (eye - at.position).norm()));
}

}  // namespace

void filterPrediction(Prediction& prediction, const ModelFit& fit, const Camera& camera, const Surface* surface,
                      const Settings& settings) {
  const bool byArea = settings.flag("predict.filter_area"), byShadow = settings.flag("predict.filter_shadow");
  const double leastShare = settings.number("predict.filter_brightness");
  if (prediction.failure() || (!byArea && !byShadow && !(leastShare > 0))) return;
  const double leastArea = settings.number("detect.min_area"), level = settings.number("detect.level");
  const Eigen::Vector3d eye = camera.centreInWorld();
  std::optional<double> brightest;
  if (leastShare > 0)
    for (const PredictedHighlight& h : prediction.highlights())
      if (const std::optional<double> own = logBrightness(fit, h, eye, level); own && (!brightest || *own > *brightest))
        brightest = own;
  prediction.drop([&](const PredictedHighlight& h) -> std::optional<Failure> {
    std::optional<std::string> why;
    if (const double area = std::abs(signedArea(h.contour)); byArea && area < leastArea)
      why = formatted("smaller than the smallest highlight that detection takes: %.2g of %.3g px^2", area, leastArea);
    if (!why && leastShare > 0) why = tooFaint(logBrightness(fit, h, eye, level), brightest, leastShare);
    if (!why && byShadow && shadowed(fit, h, camera, surface)) why = "in the shadow of the object itself";
    if (!why) return std::nullopt;
    prediction.filtered.push_back({h, *why});
    return Failure{Reason::NoHighlight, "filtered: " + *why};
  });
}

}  // namespace glint

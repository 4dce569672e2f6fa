// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/scene_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/number_text.h"
#include "core/base/words.h"
#include "core/draw/frame_overlay.h"
#include "core/geometry/polyline.h"
#include "core/pipeline/frame_score.h"
#include "core/pipeline/summary.h"
#include "core/pipeline/training.h"

namespace glint::draw {
namespace {

constexpr double kFarLamp = 4;         ///< in scene sizes: beyond, an arrow shows the direction
constexpr double kVanishing = 1e-300;  ///< m: keeps a product of an empty ellipsoid finite
constexpr double kSamePlace = 1e-9;    ///< of unit vectors: one is the copy of the other
constexpr int kGapPoints = 61;         ///< of a bridged gap: 20 dots with gaps of twice their length

/// Whose a thing is.
SceneThing owned(SceneThing thing, int frame, int highlight, const std::string& light, const std::string& model, bool poor) {
  thing.frame = frame;
  thing.highlight = highlight;
  thing.light = light;
  thing.model = model;
  thing.poor = poor;
  return thing;
}

SceneThing ofFit(SceneThing thing, const ModelFit& fit) {
  thing.surface = fit.surface;
  return owned(std::move(thing), -1, -1, fit.light, fit.model, !fit.poor.empty());
}

SceneThing pointThing(const Camera& camera, const BrightestPoint& brightest) {
  const SurfacePoint p = facing(brightest.point, camera.centreInWorld());
  SceneThing thing;
  thing.role = SceneRole::BrightestPoint;
  thing.place = p.position.homogeneous();
  thing.normal = p.normal;
  return thing;
}

std::vector<WorldChain> onSurface(const Camera& camera, const Surface& surface, Polyline contour, double surfaceSize,
                                  std::size_t mostPoints) {
  if (mostPoints > 0 && contour.points.size() > mostPoints) contour.points = thinned(contour, static_cast<int>(mostPoints));
  return castContour(camera, surface, contour, surfaceSize, 0);
}

/// What is drawn where a highlight lies on a surface: the same for an observed one and for a predicted one.
void addMirror(SceneDrawing& things, const Camera& camera, const Plane& plane, const BrightestPoint& brightest,
               const std::vector<Pixel>& contour, const std::optional<CanonicalContour>& canonical, const DrawingOptions& options,
               const std::string& frameId) {
  const SceneScale& scale = options.scale;
  const Eigen::Vector3d& at = brightest.point.position;
  things.push_back(pointThing(camera, brightest));
  things.push_back(tangentPlaneThing(plane, at, planeRadius(camera, plane, at, contour, scale.surfaceSize, options.planeTimes)));
  things.push_back(virtualCameraThing(camera, plane, scale.cameraDepth));
  things.back().label = "virtual camera " + frameId;
  if (!canonical || !canonical->ellipse) return;
  SceneThing ellipse;
  ellipse.role = SceneRole::CanonicalEllipse;
  ellipse.chains = ellipseOnPlane(camera, plane, *canonical->ellipse, 0);
  things.push_back(std::move(ellipse));
}

void addObserved(SceneDrawing& things, const Inspection& inspection, int frame, const std::shared_ptr<const Surface>& surface,
                 const DrawingOptions& options) {
  const Frame& f = inspection.scene->frames[static_cast<std::size_t>(frame)];
  std::vector<TrainingView> views;
  for (const TrainingView& view : inspection.views)
    if (view.frame == frame && view.seen) views.push_back(view);
  if (views.empty()) views = observedViews(inspection, frame, surface, true);
  for (const TrainingView& view : views) {
    SceneDrawing own;
    addMirror(own, view.camera, view.seen->tangentPlane, view.seen->brightest, view.highlight.contour.points, view.canonical,
              options, f.id);
    for (SceneThing& ray : rayThings(inspection, view, options.scale)) own.push_back(std::move(ray));
    for (SceneThing& thing : own)
      things.push_back(owned(std::move(thing), frame, highlightOf(inspection, view), view.highlight.light, "", /*poor=*/false));
  }
  const std::vector<Highlight>& highlights = inspection.evidence[static_cast<std::size_t>(frame)].scored();
  for (std::size_t i = 0; i < highlights.size(); ++i) {
    if (highlights[i].contour.points.size() < 2) continue;
    SceneThing thing;
    thing.role = SceneRole::ObservedContour;
    thing.chains = onSurface(f.camera, *surface, highlights[i].contour, options.scale.surfaceSize, options.mostPoints);
    things.push_back(owned(std::move(thing), frame, static_cast<int>(i), highlights[i].light, "", false));
  }
}

void addPredicted(SceneDrawing& things, const Inspection& inspection, const std::string& model, const FrameComparison& comparison,
                  const Surface& surface, const DrawingOptions& options) {
  const Frame& f = inspection.scene->frames[static_cast<std::size_t>(comparison.frame)];
  const bool poor = !poorFit(inspection.models.at(model), comparison).empty();
  const std::vector<PredictedHighlight>& highlights = comparison.prediction.highlights();
  for (std::size_t i = 0; i < highlights.size(); ++i) {
    const PredictedHighlight& h = highlights[i];
    SceneDrawing own = predictedContourThings(f.camera, surface, h, options.scale.surfaceSize, options.mostPoints);
    if (options.predictedMirrors && h.tangentPlane)
      addMirror(own, f.camera, *h.tangentPlane, h.brightest, h.contour.points, h.canonical, options, f.id);
    for (SceneThing& thing : own)
      things.push_back(owned(std::move(thing), comparison.frame, static_cast<int>(i), comparison.light, model, poor));
  }
}

}  // namespace

const char* nameOf(SceneRole role) {
  static constexpr std::array kNames{"surface",           "camera",   "virtual-camera", "brightest-point",  "tangent-plane",
                                     "canonical-ellipse", "view-ray", "reflected-ray",  "observed-contour", "predicted-contour",
                                     "ellipsoid",         "light",    "fitted-lamp",    "true-lamp"};
  return kNames[static_cast<std::size_t>(role)];
}

Colour colourOf(const SceneThing& thing) {
  switch (thing.role) {
    case SceneRole::CanonicalEllipse: return canonicalColour();
    case SceneRole::VirtualCamera: return kVirtualCamera;
    case SceneRole::Surface: return kSurface;
    case SceneRole::Light:
    case SceneRole::ReflectedRay: return kLightColour;
    case SceneRole::TrueLamp: return kTruth;
    case SceneRole::Camera:
    case SceneRole::ViewRay: return kHeldOut;
    default: break;
  }
  if (!thing.model.empty()) return modelColour(thing.model, thing.poor);
  return thing.role == SceneRole::TangentPlane ? kVirtualCamera : kObserved;
}

namespace {

/// Estimates, true lamps and what was fitted, of some lights.
SceneDrawing lightThings(const Inspection& inspection, const DrawingOptions& options,
                         const std::function<bool(const std::string&)>& taken) {
  SceneDrawing things;
  for (const auto& [key, estimate] : inspection.lights) {
    if (!estimate || estimate->known || !taken(key.light)) continue;  // a known lamp is drawn once, below
    things.push_back(estimateThing(key.light, estimate->light, options.scale));
    things.back().surface = key.surface;
  }
  const auto addFits = [&](const auto& thingOf) {
    for (const std::string& model : modelsInOrder(inspection))
      for (const ModelResult::Fit& fit : inspection.models.at(model).fits)
        if (fit.fit && taken(fit.light))
          if (std::optional<SceneThing> thing = thingOf(*fit.fit)) things.push_back(std::move(*thing));
  };
  addFits([&](const ModelFit& fit) { return fittedLampThing(inspection, fit, options.scale); });
  for (const TrueLight& light : inspection.scene->lights)
    if (taken(light.id)) things.push_back(trueLampThing(light, options.leastLamp, options.scale));
  addFits([&](const ModelFit& fit) { return ellipsoidThing(fit, options.scale); });
  return things;
}

}  // namespace

SceneDrawing sceneThings(const Inspection& inspection, const DrawingOptions& options) {
  return lightThings(inspection, options,
                     [&](const std::string& light) { return inspection.lightFrame.elsewhere.count(light) == 0; });
}

SceneDrawing frameThings(const Inspection& given, int frame, const std::shared_ptr<const Surface>& surface,
                         const DrawingOptions& options) {
  require(frame >= 0 && frame < static_cast<int>(given.scene->frames.size()), "frameThings: the frame does not exist");
  const std::shared_ptr<const Inspection> there = inSceneAt(given, frame);
  const Inspection& inspection = *there;
  const Frame& f = inspection.scene->frames[static_cast<std::size_t>(frame)];
  SceneDrawing things;
  SceneThing camera;
  camera.frame = frame;
  camera.place = f.camera.centreInWorld().homogeneous();
  camera.chains = frustum(f.camera, options.scale.cameraDepth);
  camera.label = "frame " + f.id;
  things.push_back(std::move(camera));
  if (const std::set<std::string>& moving = given.lightFrame.elsewhere; !moving.empty())
    for (SceneThing& thing :
         lightThings(inspection, options, [&](const std::string& light) { return moving.count(light) > 0; })) {
      thing.frame = frame;
      things.push_back(std::move(thing));
    }
  if (!surface) return things;
  SceneThing mesh;
  mesh.role = SceneRole::Surface;
  mesh.frame = frame;
  mesh.mesh = surface;
  if (inspection.surfaces) mesh.surface = inspection.surfaces->placedKeyOf(frame);
  things.push_back(std::move(mesh));
  if (static_cast<std::size_t>(frame) < inspection.evidence.size()) addObserved(things, inspection, frame, surface, options);
  for (const std::string& model : modelsInOrder(inspection))
    for (const FrameComparison& comparison : inspection.models.at(model).frames)
      if (comparison.frame == frame) addPredicted(things, inspection, model, comparison, *surface, options);
  return things;
}

WorldChain circle(const Eigen::Vector3d& centre, const Eigen::Vector3d& axisU, const Eigen::Vector3d& axisV, int n) {
  WorldChain points;
  points.reserve(static_cast<std::size_t>(n) + 1);
  for (int i = 0; i <= n; ++i) {
    const double t = 2 * std::numbers::pi * (i % n) / n;
    points.push_back(centre + std::cos(t) * axisU + std::sin(t) * axisV);
  }
  return points;
}

std::array<Eigen::Vector3d, 4> imagePlane(const Camera& camera, double depth) {
  const double right = camera.width - 0.5, bottom = camera.height - 0.5;
  const std::array<Pixel, 4> corners{Pixel(-0.5, -0.5), Pixel(right, -0.5), Pixel(right, bottom), Pixel(-0.5, bottom)};
  const Eigen::Isometry3d worldFromCam = camera.camFromWorld.inverse();
  const Eigen::Matrix3d rayFromPixel = camera.pixelFromRay.inverse();
  std::array<Eigen::Vector3d, 4> world;
  for (std::size_t i = 0; i < 4; ++i)
    world[i] = worldFromCam * Eigen::Vector3d(depth * (rayFromPixel * corners[i].homogeneous()));
  return world;
}

std::vector<WorldChain> frustum(const Camera& camera, double depth) {
  const Eigen::Vector3d eye = camera.centreInWorld();
  const std::array<Eigen::Vector3d, 4> c = imagePlane(camera, depth);
  const Eigen::Vector3d up = 0.16 * (c[0] - c[3]), top = 0.5 * (c[0] + c[1]);
  return {{c[0], c[1], c[2], c[3], c[0]},
          {eye, c[0]},
          {eye, c[1]},
          {eye, c[2]},
          {eye, c[3]},
          {top + 0.18 * (c[0] - c[1]), top + up, top + 0.18 * (c[1] - c[0])}};
}

Eigen::Affine3d ballOf(const Ellipsoid& ellipsoid, double least) {
  const double longest = std::max(ellipsoid.semiAxes().maxCoeff(), kVanishing);
  return Eigen::Affine3d(ellipsoid.worldFromBody()) *
         Eigen::Scaling(Eigen::Vector3d(ellipsoid.semiAxes().cwiseMax(least * longest)));
}

std::vector<WorldChain> principalEllipses(const Eigen::Affine3d& worldFromUnitSphere) {
  const Eigen::Matrix3d a = worldFromUnitSphere.linear();
  const Eigen::Vector3d c = worldFromUnitSphere.translation();
  return {circle(c, a.col(0), a.col(1)), circle(c, a.col(1), a.col(2)), circle(c, a.col(2), a.col(0))};
}

SceneThing lampThing(SceneRole role, const Lamp& lamp, const std::string& label, const SceneScale& scale) {
  SceneThing thing;
  thing.role = role;
  thing.label = label;
  thing.place = lamp.centre;
  const Eigen::Vector3d middle = scale.sceneBox.center();
  const double away = lamp.atInfinity() ? 0 : (lamp.position() - middle).norm();
  thing.chains = outlineOf(lamp);
  if (!lamp.atInfinity() && away <= kFarLamp * scale.sceneSize) return thing;
  thing.label += lamp.atInfinity() ? ", at infinity" : formatted(", %.3g m away", away);
  const Eigen::Vector3d towards = (lamp.centre.head<3>() - lamp.centre.w() * middle).normalized();
  const Eigen::Vector3d from = scale.surfaceBox.center() + 0.6 * scale.surfaceSize * towards;
  thing.arrow = {from, from + 0.5 * scale.surfaceSize * towards};
  return thing;
}

SceneThing estimateThing(const std::string& light, const Lamp& estimate, const SceneScale& scale) {
  SceneThing thing = lampThing(SceneRole::Light, estimate, lightName(light) + " (estimate)", scale);
  thing.light = light;
  return thing;
}

std::optional<SceneThing> fittedLampThing(const Inspection& inspection, const ModelFit& fit, const SceneScale& scale) {
  if (!fit.lightEstimate) return {};
  SceneThing thing =
      ofFit(lampThing(SceneRole::FittedLamp, fit.lamp().value_or(*fit.lightEstimate), fit.model + " light", scale), fit);
  for (const auto& [key, estimate] : inspection.lights)
    thing.shared =
        thing.shared || (estimate && (estimate->light.homogeneous() - fit.lightEstimate->homogeneous()).norm() < kSamePlace);
  return thing;
}

SceneThing trueLampThing(const TrueLight& light, double least, const SceneScale& scale) {
  const Lamp& lamp = light.lamp;
  const Lamp shown = lamp.atInfinity() ? lamp : withRadius(lamp, std::max(radiusOf(lamp), least));
  SceneThing thing = lampThing(SceneRole::TrueLamp, shown, (light.known ? "known: " : "truth: ") + lightName(light.id), scale);
  thing.light = light.id;
  return thing;
}

std::optional<SceneThing> ellipsoidThing(const ModelFit& fit, const SceneScale& scale) {
  constexpr double kLarge = 20, kAway = 50;  // scene sizes
  const EllipsoidFit* const fitted = fit.as<EllipsoidFit>();
  if (!fitted) return {};
  SceneThing thing;
  thing.role = SceneRole::Ellipsoid;
  thing.label = fit.model;
  if (!fitted->ellipsoid) {
    thing.problem = std::string("Q* is not an ellipsoid (") + describe(fitted->quadric) + ")";
    return ofFit(std::move(thing), fit);
  }
  const Ellipsoid& e = *fitted->ellipsoid;
  if (!e.centre().allFinite() || !e.semiAxes().allFinite()) return {};
  if (e.semiAxes().maxCoeff() > kLarge * scale.sceneSize ||
      (e.centre() - scale.sceneBox.center()).norm() > kAway * scale.sceneSize)
    thing.problem = "ellipsoid not drawn, far larger or farther away than the scene";
  thing.place = e.centre().homogeneous();
  thing.body = e;
  thing.chains = principalEllipses(ballOf(e, 0));
  return ofFit(std::move(thing), fit);
}

SceneThing virtualCameraThing(const Camera& camera, const Plane& plane, double depth) {
  SceneThing thing;
  thing.role = SceneRole::VirtualCamera;
  thing.place = plane.reflected(camera.centreInWorld()).homogeneous();
  thing.chains = frustum(camera, depth);
  for (WorldChain& chain : thing.chains)
    for (Eigen::Vector3d& p : chain) p = plane.reflected(p);
  return thing;
}

SceneThing tangentPlaneThing(const Plane& plane, const Eigen::Vector3d& at, double radius) {
  SceneThing thing;
  thing.role = SceneRole::TangentPlane;
  thing.place = at.homogeneous();
  thing.normal = plane.normal;
  thing.radius = radius;
  const Eigen::Matrix<double, 3, 2> basis = tangentBasis(plane.normal);
  thing.chains = {circle(at, radius * basis.col(0), radius * basis.col(1))};
  return thing;
}

std::vector<SceneThing> rayThings(const Inspection& inspection, const TrainingView& view, const SceneScale& scale) {
  const Eigen::Vector3d eye = view.camera.centreInWorld();
  const SurfacePoint p = facing(view.seen->brightest.point, eye);
  const Eigen::Vector3d out = reflect((eye - p.position).normalized(), p.normal);
  // As far as the light where there is one in reach, so that one sees how well the rays meet there.
  double reach = 0.6 * scale.sceneSize;
  const LightEstimate* const estimate = inspection.lightFor(view.frame, view.highlight.light);
  if (estimate && !estimate->light.atInfinity()) {
    const double along = out.dot(estimate->light.position() - p.position);
    if (along > 0) reach = std::min(1.1 * along, 4 * scale.sceneSize);
  }
  std::vector<SceneThing> rays(2);
  rays[0].role = SceneRole::ViewRay;
  rays[0].chains = {{eye, p.position}};
  rays[1].role = SceneRole::ReflectedRay;
  rays[1].chains = {{p.position, p.position + reach * out}};
  return rays;
}

std::vector<SceneThing> predictedContourThings(const Camera& camera, const Surface& surface, const PredictedHighlight& highlight,
                                               double surfaceSize, std::size_t mostPoints) {
  std::vector<SceneThing> things(2);
  for (SceneThing& thing : things) thing.role = SceneRole::PredictedContour;
  things[1].gap = true;
  for (const ContourRun& run : contourRuns(highlight)) {
    Polyline part;
    part.points = run.points;
    part.closed = run.closed;
    if (run.gap && part.points.size() > 1) part.points = resample(part, kGapPoints);
    for (WorldChain& chain : onSurface(camera, surface, part, surfaceSize, mostPoints))
      things[run.gap].chains.push_back(std::move(chain));
  }
  if (things[1].chains.empty()) things.pop_back();
  return things;
}

std::vector<TrainingView> observedViews(const Inspection& inspection, int frame, const std::shared_ptr<const Surface>& surface,
                                        bool walked) {
  const FrameEvidence& evidence = inspection.evidence[static_cast<std::size_t>(frame)];
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(frame)].camera;
  std::vector<TrainingView> views;
  for (std::size_t i = 0; i < evidence.highlights.size(); ++i) {
    TrainingView view = trainingView(evidence, static_cast<int>(i), camera, surface);
    if (!view.seen) continue;
    view.frame = frame;  // evidence of one frame alone may not tell it
    if (walked)
      if (const LightEstimate* const light = inspection.lightFor(frame, view.highlight.light))
        addCanonicalContour(view, light->light, inspection.request.settings);
    views.push_back(std::move(view));
  }
  return views;
}

int highlightOf(const Inspection& inspection, const TrainingView& view) {
  const auto frame = static_cast<std::size_t>(view.frame);
  if (view.frame < 0 || frame >= inspection.evidence.size()) return -1;
  const std::vector<Highlight>& highlights = inspection.evidence[frame].highlights;
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < highlights.size(); ++i) {  // the view may have noise added: the nearest of its light
    const double d = (highlights[i].peak - view.highlight.peak).norm();
    if (highlights[i].light != view.highlight.light || !(d < least)) continue;
    nearest = static_cast<int>(i);
    least = d;
  }
  return nearest;
}

}  // namespace glint::draw

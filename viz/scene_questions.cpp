// SPDX-License-Identifier: BSD-3-Clause
#include "viz/scene_questions.h"

#include <vtkCamera.h>
#include <vtkCellPicker.h>
#include <vtkMatrix4x4.h>
#include <vtkRenderer.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>

#include "core/draw/selection.h"
#include "core/geometry/light.h"
#include "core/surface/brightest_point.h"

namespace glint::viz {

void addFrustum(const LayerInput& in, std::vector<Eigen::Vector3d>& points, int frame) {
  points.push_back(in.frame(frame).camera.centreInWorld());
  for (const Eigen::Vector3d& corner : imagePlane(in.frame(frame).camera, in.scale.cameraDepth)) points.push_back(corner);
}

std::vector<Eigen::Vector3d> selectedExtent(const LayerInput& in) {
  std::vector<Eigen::Vector3d> points;
  const int frame = in.selection.frame;
  const Camera& camera = in.frame(frame).camera;
  const auto at = static_cast<std::size_t>(frame);
  static const std::vector<Highlight> kNone;
  const std::vector<Highlight>& highlights = at < in.inspection->evidence.size() ? in.inspection->evidence[at].highlights : kNone;
  const auto addContour = [&](const Highlight& h) {
    if (!in.surface) return;
    for (const Points& chain : castContour(camera, *in.surface, h.contour, in.scale, 0))
      points.insert(points.end(), chain.begin(), chain.end());
  };
  if (in.selection.highlight >= 0 && in.selection.highlight < static_cast<int>(highlights.size()))
    addContour(highlights[static_cast<std::size_t>(in.selection.highlight)]);
  if (const PredictedHighlight* const spurious = draw::selectedSpurious(*in.inspection, in.selection); spurious && in.surface)
    for (const Points& chain : castContour(camera, *in.surface, spurious->contour, in.scale, 0))
      points.insert(points.end(), chain.begin(), chain.end());
  if (!points.empty()) return points;
  if (!in.selection.model.empty()) {
    for (const ModelFit* fit : in.fits(in.selection.model)) {
      if (!fit->ellipsoid() || fit->ellipsoid()->semiAxes().maxCoeff() > 20 * in.scale.sceneSize) continue;
      const Eigen::Matrix3d axes = fit->ellipsoid()->worldFromBody().linear() * fit->ellipsoid()->semiAxes().asDiagonal();
      for (int i = 0; i < 6; ++i) points.push_back(fit->ellipsoid()->centre() + (i % 2 ? -1 : 1) * axes.col(i / 2));
    }
  }
  if (!points.empty()) return points;
  addFrustum(in, points, frame);
  for (const Highlight& h : highlights) addContour(h);
  return points;
}

namespace {

/// The ends of the ellipsoids' axes, with a margin; those of other models than `model` ("" = none is meant) where they are small.
/// @param alone  of this model, else of all.
std::vector<Eigen::Vector3d> ellipsoidEnds(const LayerInput& in, const std::string& model, bool alone) {
  std::vector<Eigen::Vector3d> points;
  for (const std::string& name : in.models) {
    if (alone && name != model) continue;
    for (const ModelFit* fit : in.fits(name)) {
      const double most = (name == model ? 5 : 0.5) * in.scale.sceneSize;  // a needle of another model must not shrink the rest
      if (!fit->ellipsoid() || fit->ellipsoid()->semiAxes().maxCoeff() > most ||
          (fit->ellipsoid()->centre() - in.scale.sceneBox.center()).norm() > 5 * in.scale.sceneSize)
        continue;
      const Eigen::Matrix3d axes = fit->ellipsoid()->worldFromBody().linear() * fit->ellipsoid()->semiAxes().asDiagonal();
      for (int i = 0; i < 6; ++i) points.push_back(fit->ellipsoid()->centre() + (i % 2 ? -1.1 : 1.1) * axes.col(i / 2));
    }
  }
  return points;
}

}  // namespace

namespace {

/// The virtual cameras that are drawn, where they are not far away: a mirror seen at a grazing angle takes them there.
void addVirtualCameras(const LayerInput& in, std::vector<Eigen::Vector3d>& points, bool all) {
  std::set<int> frames{in.selection.frame};
  if (all)
    for (const TrainingView* view : in.views()) frames.insert(view->frame);
  const Eigen::Vector3d middle = in.scale.sceneBox.center();
  for (const int frame : frames)
    for (const LayerInput::Mirror& mirror : in.mirrors(frame)) {
      std::vector<Eigen::Vector3d> camera;
      addFrustum(in, camera, frame);
      for (const Eigen::Vector3d& p : camera)
        if (const Eigen::Vector3d q = mirror.plane.reflected(p); (q - middle).norm() < 3 * in.scale.sceneSize)
          points.push_back(q);
    }
}

constexpr double kLeansUp = 0.5;                       // cosine: a normal that leans less upwards is of a side
constexpr double kAlongUp = 0.9;                       // cosine: a view that is closer to upwards cannot have it up
constexpr double kDot = 0.125;                         // of the picture: a smaller ellipsoid has no visible shape
constexpr double kEllipsoidShare = 1.6;                // of its diagonal: then it fills about a quarter of the picture
constexpr double kWalkDisc = 1.15, kWalkArrow = 0.85;  // of the walk's reach, see walkLayer()
}  // namespace

DrawnParts drawnParts(const SceneView& view) {
  return {view.layerVisible("peaks"), view.layerVisible("ellipsoids"), view.layerVisible("virtual-cameras"),
          view.layerVisible("tangent-planes"), view.layerVisible("walk")};
}

namespace {

/// The highlight that is looked at, on its surface.
struct LookedAt {
  const Highlight& highlight;
  int index;  ///< in its frame's evidence
  const Camera& camera;
  SurfacePoint at;  ///< faces the camera
};

/// The ends on T of the walks that are drawn of it. @return how far they reach from it
double addWalks(const LayerInput& in, const LookedAt& h, bool walk, std::vector<Eigen::Vector3d>& points) {
  double reach = 0;
  const auto add = [&](const CanonicalContour& canonical) {
    for (const DirectionResult& d : canonical.directions) {
      if (!d.limitAngle || d.failure) continue;
      points.push_back(d.onTangentPlane);
      reach = std::max(reach, (d.onTangentPlane - h.at.position).norm());
    }
  };
  for (const TrainingView* view : in.views())
    if (view->frame == in.selection.frame && view->canonical && in.highlightOf(*view) == h.index) add(*view->canonical);
  if (walk || in.solo)  // where they are drawn
    for (const TrainingView& view : in.ownViews(true))
      if (in.highlightOf(view) == h.index) add(*view.canonical);
  if (!walk && in.inspection->isTraining(in.selection.frame)) return reach;
  for (const std::string& model : in.models)
    for (const FrameComparison* comparison : in.comparisons(model))
      for (const FrameComparison::Row& row : comparison->rows) {
        if (row.observed != h.index || row.predicted < 0) continue;
        const auto& canonical = comparison->prediction.highlights()[static_cast<std::size_t>(row.predicted)].canonical;
        if (canonical) add(*canonical);
      }
  return reach;
}

/// A circle about the highlight on its tangent plane, `above` it.
void addCircle(const LookedAt& h, double radius, double above, std::vector<Eigen::Vector3d>& points) {
  const Eigen::Matrix<double, 3, 2> basis = tangentBasis(h.at.normal);
  for (int i = 0; i < 16; ++i) {
    const double t = i * std::numbers::pi / 8;
    points.push_back(h.at.position + radius * (std::cos(t) * basis.col(0) + std::sin(t) * basis.col(1)) + above * h.at.normal);
  }
}

/// What lies on the surface and on the tangent plane of it, as far as it is drawn.
std::vector<Eigen::Vector3d> extentOn(const LayerInput& in, const LookedAt& h, HighlightLook look, const DrawnParts& drawn) {
  std::vector<Eigen::Vector3d> points{h.at.position};
  for (const Points& chain : castContour(h.camera, *in.surface, h.highlight.contour, in.scale, 0))
    points.insert(points.end(), chain.begin(), chain.end());
  const double reach = addWalks(in, h, drawn.walk, points);
  if (look != HighlightLook::Section) return points;
  if (drawn.walk) {  // the disc that it goes on, and the arrows at its end, whatever its direction
    addCircle(h, kWalkDisc * reach, 0, points);
    addCircle(h, reach, kWalkArrow * reach, points);
  }
  if (drawn.tangentPlanes) {
    const Plane plane = Plane::through(h.at.position, h.at.normal);
    const double own = planeRadius(h.camera, plane, h.at.position, h.highlight.contour.points, in.scale);
    addCircle(h, in.solo ? std::max(own, kAboutCanonical * reach) : own, 0, points);  // as tangentPlanesLayer() draws it
  }
  return points;
}

/// The pair of cameras, the light and the ellipsoids.
std::vector<Eigen::Vector3d> extentOfMirror(const LayerInput& in, const LookedAt& h, const DrawnParts& drawn) {
  const Eigen::Vector3d eye = h.camera.centreInWorld();
  std::vector<Eigen::Vector3d> points{h.at.position, eye, eye - 2 * h.at.normal.dot(eye - h.at.position) * h.at.normal};
  addFrustum(in, points, in.selection.frame);
  addVirtualCameras(in, points, drawn.virtualCameras);
  const LightEstimate* const light = in.inspection->lightFor(in.selection.frame, h.highlight.light);
  if (light && !light->light.atInfinity() && (light->light.position() - h.at.position).norm() < 3 * in.scale.sceneSize)
    points.push_back(light->light.position());
  if (drawn.ellipsoids)
    for (const Eigen::Vector3d& q : ellipsoidEnds(in, in.selection.model, false)) points.push_back(q);
  return points;
}

/// From the highlight towards the eye.
Eigen::Vector3d backOf(const LookedAt& h, HighlightLook look) {
  const Eigen::Vector3d& n = h.at.normal;
  const Eigen::Vector3d toCamera = (h.camera.centreInWorld() - h.at.position).normalized();
  const Eigen::Vector3d right = h.camera.camFromWorld.linear().row(0).transpose();
  if (look == HighlightLook::Camera)
    return (toCamera + 0.25 * right - 0.15 * h.camera.camFromWorld.linear().row(1).transpose()).normalized();
  const auto unitAlong = [&](const Eigen::Vector3d& side, const Eigen::Vector3d& unit) {  // seen along N, any side serves
    return side.norm() > 0.05 ? unit : Eigen::Vector3d(tangentBasis(n).col(0));
  };
  if (look == HighlightLook::Mirror) {
    const Eigen::Vector3d side = toCamera - toCamera.dot(n) * n;
    return (unitAlong(side, n.cross(side).normalized()) + 0.22 * n).normalized();
  }
  // Half from the side, and not in line with the camera's own view.
  Eigen::Vector3d side = right - right.dot(n) * n;
  side = unitAlong(side, side.normalized());
  Eigen::Vector3d across = side.cross(n);
  if (across.dot(toCamera) < 0) across = -across;
  return (0.42 * n + 0.75 * across + 0.5 * side).normalized();
}

}  // namespace

std::optional<Framing> highlightFraming(const LayerInput& in, int highlight, HighlightLook look, const DrawnParts& drawn) {
  const auto frame = static_cast<std::size_t>(in.selection.frame);
  if (!in.surface || frame >= in.inspection->evidence.size() || in.inspection->evidence[frame].highlights.empty()) return {};
  const std::vector<Highlight>& highlights = in.inspection->evidence[frame].highlights;
  const int wanted = highlight >= 0 && highlight < static_cast<int>(highlights.size()) ? highlight : 0;
  const Camera& camera = in.frame(in.selection.frame).camera;
  const Highlight& seen = highlights[static_cast<std::size_t>(wanted)];
  const Outcome<BrightestPoint> brightest = observedBrightestPoint(*in.surface, camera, seen.peak);
  if (!brightest) return {};
  const LookedAt h{seen, wanted, camera, facing(brightest->point, camera.centreInWorld())};
  const SurfacePoint& p = h.at;
  Framing place;
  place.points = extentOn(in, h, look, drawn);
  double radius = 0;
  for (const Eigen::Vector3d& q : place.points) radius = std::max(radius, (q - p.position).norm());
  if (!(radius > 0)) return {};
  place.points.push_back(p.position + 0.8 * radius * p.normal);
  // With the letter on its tip.
  if (drawn.normal) place.points.push_back(p.position + 1.7 * in.scale.arrow * p.normal);
  if (look == HighlightLook::Mirror) place.points = extentOfMirror(in, h, drawn);
  place.back = backOf(h, look);
  Eigen::Vector3d up = p.normal;
  if (look == HighlightLook::Camera) up = -camera.camFromWorld.linear().row(1).transpose();
  // A vase stands: with the highlight on its side, up is the world's up. All cameras together tell it, even if only one is shown.
  std::vector<int> cameras(in.inspection->scene->frames.size());
  std::iota(cameras.begin(), cameras.end(), 0);
  if (look != HighlightLook::Camera)
    if (const Eigen::Vector3d world = upwards(in, cameras);
        world.dot(p.normal) < kLeansUp && std::abs(world.dot(place.back)) < kAlongUp)
      up = world;
  place.up = (up - up.dot(place.back) * place.back).normalized();
  place.reference = p.position;
  place.leastDepth = 2 * radius;
  return place;
}

namespace {

std::vector<Eigen::Vector3d> ellipsoidExtent(const LayerInput& in, const std::string& model) {
  std::vector<Eigen::Vector3d> points = ellipsoidEnds(in, model, false);
  if (points.empty()) return points;
  const auto sizeOf = [](const std::vector<Eigen::Vector3d>& of) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : of) box.extend(p);
    return box.diagonal().norm();
  };
  // Those of the other models, too, where this one is still to be seen then.
  const std::vector<Eigen::Vector3d> own = ellipsoidEnds(in, model, true);
  const bool alone = !own.empty() && sizeOf(own) < kDot * sizeOf(points);
  if (alone) points = own;
  // And what comes to it, as far as it can be seen along with it: from the brightest points, a small one would be a dot.
  const double most = kEllipsoidShare * sizeOf(points);
  for (const std::string& name : in.models) {
    if (!model.empty() && name != model) continue;
    for (const ModelFit* fit : in.fits(name))
      for (const TrainingView* view : in.viewsOf(*fit)) {
        if (!view->seen || !fit->ellipsoid()) continue;
        const Eigen::Vector3d way = view->seen->brightest.point.position - fit->ellipsoid()->centre();
        points.push_back(fit->ellipsoid()->centre() + std::min(1.0, most / std::max(way.norm(), 1e-300)) * way);
        // Cones without a mirror come from the cameras themselves, and are drawn from halfway.
        if (!alone && !modelByName(name).traits().mirrored)
          points.push_back(0.5 * (view->camera.centreInWorld() + fit->ellipsoid()->centre()));
      }
  }
  return points;
}

/// A direction as near to `towards` as is square to the longest extent of the points, so that it is not seen end on; unit.
Eigen::Vector3d sideDirection(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& up,
                              const Eigen::Vector3d& towards) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  const Eigen::Vector3d longest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
  const Eigen::Vector3d square = towards - towards.dot(longest) * longest;
  if (square.norm() < 0.1) return towards;
  const Eigen::Vector3d back = (square.normalized() + 0.2 * up).normalized();  // a little from above
  return std::abs(back.dot(up)) > 0.95 ? towards : back;                       // from straight above there is no up
}

}  // namespace

Eigen::Vector3d upwards(const LayerInput& in, const std::vector<int>& frames) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero(), eyes = Eigen::Vector3d::Zero();
  for (const int frame : frames) {
    up -= in.frame(frame).camera.camFromWorld.linear().row(1).transpose();
    eyes += in.frame(frame).camera.centreInWorld();
  }
  const double n = static_cast<double>(frames.size());
  up /= n;
  // Cameras that look steeply down have an upwards of their own that is nearly level. People hold them level, though: then
  // upwards is square to all their horizontal image axes, where those tell a direction.
  Eigen::Matrix3d level = Eigen::Matrix3d::Zero();
  for (const int frame : frames) {
    const Eigen::Vector3d right = in.frame(frame).camera.camFromWorld.linear().row(0).transpose();
    level += right * right.transpose() / n;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(level);
  constexpr double kLevel = 0.02, kTells = 0.05;  // mean squares of sines: tilted by up to 8 degrees; spread by 13 or more
  if (axes.eigenvalues()[0] < kLevel && axes.eigenvalues()[1] > kTells) {
    const Eigen::Vector3d square = axes.eigenvectors().col(0);
    const double side = square.dot(up);
    if (std::abs(side) > 0.05) up = side > 0 ? square : Eigen::Vector3d(-square);
  }
  if (up.norm() < 0.2) up = eyes / n - in.scale.surfaceBox.center();
  if (up.norm() < 1e-9 * in.scale.sceneSize) up = Eigen::Vector3d::UnitZ();
  // Scenes are modelled with an axis upwards more often than not: snap to it.
  Eigen::Index axis = 0;
  up.normalize();
  if (up.cwiseAbs().maxCoeff(&axis) > 0.8) up = Eigen::Vector3d::Unit(axis) * (up[axis] > 0 ? 1 : -1);
  return up;
}

Eigen::Vector3d overviewDirection(const LayerInput& in, const std::vector<int>& frames, const Eigen::Vector3d& up) {
  Eigen::Vector3d eyes = Eigen::Vector3d::Zero();
  for (const int frame : frames) eyes += in.frame(frame).camera.centreInWorld();
  eyes /= static_cast<double>(frames.size());
  // From above the highlights, a little aside of the cameras: then neither the surface nor the frustums hide what matters.
  Eigen::Vector3d normals = Eigen::Vector3d::Zero();
  for (const TrainingView& view : in.inspection->views) {
    if (view.seen) normals += facing(view.seen->brightest.point, view.camera.centreInWorld()).normal;
  }
  const Eigen::Vector3d towardsCameras = eyes - in.scale.surfaceBox.center();
  Eigen::Vector3d towards = normals.norm() > 0.1 ? normals.normalized() : towardsCameras.normalized();
  const double height = up.dot(towards);
  Eigen::Vector3d flat = towards - height * up;
  if (flat.norm() < 0.1) {  // highlights on top: the cameras' side then, else any
    flat = towardsCameras - up.dot(towardsCameras) * up;
    if (flat.norm() < 0.05 * in.scale.sceneSize) flat = tangentBasis(up).col(0);
  }
  const double elevation = std::clamp(std::atan2(height, flat.norm()), 0.25, 0.6);
  const double side = up.dot(flat.cross(towardsCameras)) > 0 ? -1 : 1;  // away from the cameras
  flat = Eigen::AngleAxisd(0.6 * side, up) * flat.normalized();
  return std::cos(elevation) * flat + std::sin(elevation) * up;
}

std::optional<Framing> ellipsoidFraming(const LayerInput& in, const std::vector<int>& frames, const std::string& model) {
  Framing framing;
  framing.points = ellipsoidExtent(in, model);
  if (framing.points.empty()) return {};
  // The surface, too, where it is no larger than all that: half of it would puzzle.
  Eigen::AlignedBox3d held;
  for (const Eigen::Vector3d& p : framing.points) held.extend(p);
  if (in.scale.surfaceSize <= held.diagonal().norm())
    for (int i = 0; i < 8; ++i)
      framing.points.push_back(in.scale.surfaceBox.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  // The highlights' own normal is upwards where they agree on one, as on a table: cameras that look down at it do not know.
  Eigen::Vector3d up = upwards(in, frames), normals = Eigen::Vector3d::Zero();
  int views = 0;
  for (const TrainingView* view : in.views()) {
    if (!view->seen) continue;
    normals += facing(view->seen->brightest.point, view->camera.centreInWorld()).normal;
    ++views;
  }
  if (views > 0 && normals.norm() > 0.8 * views && normals.dot(up) > 0.5 * views) up = normals.normalized();  // a vase stands
  framing.back = sideDirection(framing.points, up, overviewDirection(in, frames, up));
  framing.up = framing.back.cross(up.cross(framing.back).normalized());
  framing.reference = in.scale.surfaceBox.center();
  framing.leastDepth = 0.1 * in.scale.surfaceSize;
  return framing;
}

void addDirection(const LayerInput& in, Picked& picked) {
  if (picked.layer != "observed-contours" && picked.layer != "predicted-contours") return;
  const auto frame = static_cast<std::size_t>(picked.frame);
  if (picked.frame < 0 || frame >= in.inspection->evidence.size()) return;
  const std::vector<Highlight>& highlights = in.inspection->evidence[frame].highlights;
  if (picked.highlight < 0 || picked.highlight >= static_cast<int>(highlights.size())) return;
  const Camera& camera = in.frame(picked.frame).camera;
  const std::optional<Pixel> pixel = camera.project(picked.position);
  if (!pixel) return;
  picked.direction = directionOf(camera, highlights[static_cast<std::size_t>(picked.highlight)], *pixel);
  picked.text += line("direction", *picked.direction * 180 / std::numbers::pi, "deg");
}
Picked surfaceInfo(const LayerInput& in, const SurfacePoint& hit) {
  const Camera& camera = in.frame(in.selection.frame).camera;
  const Eigen::Vector3d eye = camera.centreInWorld();
  const SurfacePoint p = facing(hit, eye);
  Picked info;
  info.layer = "surface";
  info.frame = in.selection.frame;
  info.position = p.position;
  info.text = line("frame", in.frame(in.selection.frame).id) + line("P", p.position, "m") + line("N", p.normal);
  if (const std::optional<Pixel> pixel = camera.project(p.position))
    info.text += line("pixel x", pixel->x(), "px") + line("pixel y", pixel->y(), "px");
  const Eigen::Vector3d toCamera = (eye - p.position).normalized();
  info.text += line("view angle", std::acos(std::clamp(p.normal.dot(toCamera), -1.0, 1.0)) * 180 / std::numbers::pi, "deg");
  for (const auto& [light, estimate] : in.inspection->lightsFor(in.selection.frame)) {
    if (!*estimate) continue;
    const double alpha = incidentAngle(p.normal, (*estimate)->light.directionFrom(p.position), toCamera);
    if (std::isfinite(alpha)) info.text += line("alpha (" + light + ")", alpha * 180 / std::numbers::pi, "deg");
  }
  const Outcome<Curvature> curvature = in.surface->curvatureAt(hit);
  if (curvature) info.text += line("k1", curvature->k1, "1/m") + line("k2", curvature->k2, "1/m");
  if (hit.element >= 0) info.text += line("triangle", std::to_string(hit.element));
  return info;
}

namespace {
/// The ray from the eye through a window pixel; not finite if the view has no depth.
Ray rayThrough(vtkRenderer* renderer, int xDisplay, int yDisplay) {
  const auto worldAt = [&](double depth) {
    renderer->SetDisplayPoint(xDisplay, yDisplay, depth);
    renderer->DisplayToWorld();
    double w[4];
    renderer->GetWorldPoint(w);
    return Eigen::Vector3d(toEigen(w) / w[3]);
  };
  vtkCamera* camera = renderer->GetActiveCamera();
  const Eigen::Vector3d eye = camera->GetParallelProjection() ? worldAt(0) : toEigen(camera->GetPosition()), beyond = worldAt(1);
  return {eye, (beyond - eye).normalized()};
}

/// How far along the ray a triangle lies, from either side. Moller & Trumbore, Fast, Minimum Storage Ray/Triangle Intersection.
std::optional<double> distanceTo(const Ray& ray, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, p = ray.direction.cross(ac), from = ray.origin - a, q = from.cross(ab);
  const double det = ab.dot(p), u = from.dot(p) / det, v = ray.direction.dot(q) / det, t = ac.dot(q) / det;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && t > 0)) return {};  // also NaN, where the ray is parallel
  return t;
}
}  // namespace

std::optional<Picked> cameraUnder(vtkRenderer* renderer, const LayerInput& in, int xDisplay, int yDisplay) {
  const Ray ray = rayThrough(renderer, xDisplay, yDisplay);
  if (!ray.origin.allFinite() || !ray.direction.allFinite()) return {};
  double nearest = std::numeric_limits<double>::infinity();
  int found = -1;
  for (const int frame : in.frames) {
    const Eigen::Vector3d eye = in.frame(frame).camera.centreInWorld();
    const std::array<Eigen::Vector3d, 4> c = imagePlane(in.frame(frame).camera, in.scale.cameraDepth);
    for (std::size_t i = 0; i < 4; ++i)
      for (const Eigen::Vector3d& apex : {eye, c[(i + 2) % 4]})  // a side, and half of the image plane
        if (const std::optional<double> t = distanceTo(ray, c[i], c[(i + 1) % 4], apex); t && *t < nearest) {
          nearest = *t;
          found = frame;
        }
  }
  if (found < 0) return {};
  Picked picked = cameraPicked(*in.inspection, in.models, found);
  picked.position = ray.origin + nearest * ray.direction;
  return picked;
}

std::optional<Picked> pickIn(vtkRenderer* renderer, const LayerInput& in, const std::vector<const Drawn*>& drawn,
                             bool surfaceShown, int xDisplay, int yDisplay) {
  const Ray ray = rayThrough(renderer, xDisplay, yDisplay);
  const Eigen::Vector3d eye = ray.origin;
  if (!ray.origin.allFinite() || !ray.direction.allFinite()) return {};

  std::optional<Picked> result;
  double nearest = std::numeric_limits<double>::infinity();
  if (surfaceShown && in.surface && !in.eyeMirror) {
    const Outcome<SurfacePoint> hit = in.surface->firstHit(ray);
    if (hit) {
      result = surfaceInfo(in, *hit);
      nearest = (hit->position - eye).norm();
    }
  }
  const auto pickAmong = [&](const std::function<bool(const Drawn&)>& taken) -> std::optional<Picked> {
    vtkNew<vtkCellPicker> picker;
    picker->SetTolerance(0.004);
    picker->PickFromListOn();
    for (const Drawn* d : drawn)
      if (d->pickable && taken(*d)) picker->AddPickList(d->prop);
    if (!picker->Pick(xDisplay, yDisplay, 0, renderer)) return {};
    for (const Drawn* d : drawn) {
      if (d->prop.Get() != picker->GetProp3D()) continue;
      Picked picked = d->describe ? d->describe(picker->GetCellId()) : d->info;
      picked.position = toEigen(picker->GetPickPosition());
      if (vtkMatrix4x4* moved = picker->GetProp3D()->GetUserMatrix())  // drawn nearer than it is, see Drawn::nearerPx
        picked.position = (Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(moved->GetData()).inverse() *
                           picked.position.homogeneous())
                              .hnormalized();
      return picked;
    }
    return {};
  };
  std::optional<Picked> thing = pickAmong([](const Drawn&) { return true; });
  // What lies on the surface is picked before the surface itself.
  if (!thing || (thing->position - eye).norm() > nearest + 10 * in.scale.lift) return result;
  // Where contours lie on one another the selected model stays, whichever of them is drawn on top.
  if (const std::string& model = in.selection.model; !thing->model.empty() && !model.empty() && thing->model != model) {
    const std::optional<Picked> own =
        pickAmong([&](const Drawn& d) { return d.info.layer == thing->layer && d.info.model == model; });
    if (own && (own->position - thing->position).norm() < 10 * in.scale.lift) thing = own;
  }
  addDirection(in, *thing);
  return thing;
}

bool besideEye(const LayerInput& in, int frame) {
  if (in.eye == Eye::Outside) return false;
  constexpr double kClear = 2;  // depths of a glyph that it has to be before the eye
  const Camera& eye = in.frame(in.selection.frame).camera;
  std::vector<Eigen::Vector3d> glyph;
  addFrustum(in, glyph, frame);
  return std::any_of(glyph.begin(), glyph.end(), [&](const Eigen::Vector3d& p) {
    return eye.depth(in.eyeMirror ? in.eyeMirror->reflected(p) : p) < kClear * in.scale.cameraDepth;
  });
}

}  // namespace glint::viz

// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/carried.h"

#include <utility>

#include "core/geometry/transforms.h"
#include "core/pipeline/training.h"
#include "core/surface/posed_surface.h"

namespace glint {
namespace {

SurfacePoint carriedPoint(SurfacePoint point, const Eigen::Isometry3d& by) {
  point.position = by * point.position;
  point.normal = by.linear() * point.normal;
  return point;
}

template <class Matrix>
void turn(std::optional<Matrix>& second, const Eigen::Isometry3d& by) {
  if (second) second = by.linear() * *second * by.linear().transpose();
}

void carryContour(CanonicalContour& contour, const Eigen::Isometry3d& by) {
  for (DirectionResult& d : contour.directions) {
    d.onSurface = by * d.onSurface;
    d.onTangentPlane = by * d.onTangentPlane;
  }
}

void carryHighlight(PredictedHighlight& h, const Eigen::Isometry3d& by) {
  h.brightest.point = carriedPoint(h.brightest.point, by);
  if (h.tangentPlane)
    h.tangentPlane =
        Plane::through(by * (-h.tangentPlane->offset * h.tangentPlane->normal), by.linear() * h.tangentPlane->normal);
  if (h.canonical) carryContour(*h.canonical, by);
}

}  // namespace

Camera carried(Camera camera, const Eigen::Isometry3d& by) {
  if (!isIdentity(by)) camera.camFromWorld = camera.camFromWorld * by.inverse();
  return camera;
}

std::shared_ptr<const Surface> carried(std::shared_ptr<const Surface> surface, const Eigen::Isometry3d& by) {
  if (!surface || isIdentity(by)) return surface;
  const Eigen::Isometry3d pose = by * poseOf(*surface);
  return movedTo(pose, std::move(surface));
}

Light carried(const Light& light, const Eigen::Isometry3d& by) {
  return isIdentity(by) ? light : Light::homogeneous(by.matrix() * light.homogeneous());
}

Lamp carried(const Lamp& lamp, const Eigen::Isometry3d& by) {
  return isIdentity(by) ? lamp : transformed(lamp, 1, by.linear(), by.translation());
}

TrainingView carried(const TrainingView& view, const Eigen::Isometry3d& by) {
  if (isIdentity(by)) return view;
  TrainingView there = seenAgain(view, carried(view.camera, by), carried(view.surface, by));
  there.levels = view.levels;
  there.pixels = view.pixels;
  there.fromScene = by * view.fromScene;
  there.canonical = view.canonical;
  if (there.canonical) carryContour(*there.canonical, by);
  return there;
}

LightEstimate carried(LightEstimate estimate, const Eigen::Isometry3d& by) {
  if (estimate.known) estimate.known = carried(Lamp(estimate.light.homogeneous(), *estimate.known), by).shape;
  estimate.light = carried(estimate.light, by);
  turn(estimate.covariance, by);
  turn(estimate.extent, by);
  estimate.uncertainty.reset();
  return estimate;
}

ModelFit carried(ModelFit fit, const Eigen::Isometry3d& by) {
  if (const std::optional<Lamp> lamp = fit.lamp()) std::get<ReflectanceFit>(fit.family).shape = carried(*lamp, by).shape;
  if (fit.lightEstimate) fit.lightEstimate = carried(*fit.lightEstimate, by);
  turn(fit.lightCovariance, by);
  for (SurfacePoint& hint : fit.hints) hint = carriedPoint(hint, by);
  if (LimitAngleFit* const angle = std::get_if<LimitAngleFit>(&fit.family)) turn(angle->extent, by);
  if (EllipsoidFit* const e = std::get_if<EllipsoidFit>(&fit.family)) {
    e->quadric.matrix = by.matrix() * e->quadric.matrix * by.matrix().transpose();
    if (e->ellipsoid) e->ellipsoid = Ellipsoid(by * e->ellipsoid->worldFromBody(), e->ellipsoid->semiAxes());
  }
  fit.uncertainty.reset();
  return fit;
}

void carry(Prediction& prediction, const Eigen::Isometry3d& by) {
  if (isIdentity(by)) return;
  for (PredictedHighlight& h : prediction.editable()) carryHighlight(h, by);
  for (FilteredHighlight& f : prediction.filtered) carryHighlight(f.highlight, by);
}

}  // namespace glint

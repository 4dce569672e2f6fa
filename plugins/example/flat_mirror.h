// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/model/model.h"
#include "core/model/models.h"

namespace glint::example {

/// The limit angle's contour as a flat mirror at the brightest point would show it.
class FlatMirror final : public HighlightModel {
 public:
  std::string id() const override { return "flat-mirror"; }
  std::string title() const override { return "Flat mirror"; }
  std::string assumption() const override { return "The surface is its tangent plane at the brightest point."; }
  std::string reference() const override { return "plugins/example"; }
  ModelTraits traits() const override { return {{240, 228, 66}, true, false, ModelTraits::Assumes::Plane}; }
  bool needsLight() const override { return true; }
  bool needsCanonicalContours() const override { return false; }

  Outcome<ModelFit> fit(const FitInput& input, const Settings&) const override {
    if (!input.light) return input.lightFailure.value_or(Failure{Reason::NoLight, ""});
    ModelFit fit;
    fit.lightEstimate = input.light->light;
    fit.family = LimitAngleFit{input.light->limitAngle};
    fit.hints = hintsOf(input);
    for (const TrainingView& v : input.views)
      if (v.seen) fit.frames.push_back(v.frame);
    return fit;
  }

  Prediction predict(const ModelFit& fit, const Camera& camera, const Surface* surface, const Settings& settings) const override {
    if (!surface) return Failure{Reason::NoSurface, ""};
    const auto tops = brightestPointsFor(*surface, camera, *fit.lightEstimate, settings, fit.hints);
    if (!tops) return tops.failure();
    std::vector<PredictedHighlight> found;
    for (const BrightestPoint& top : *tops) found.push_back(around(top, fit, camera));
    return found;
  }

 private:
  static PredictedHighlight around(const BrightestPoint& top, const ModelFit& fit, const Camera& camera) {
    const Eigen::Vector3d eye = camera.centreInWorld(), normal = top.point.normal;
    const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
    const auto angleAt = [&](const Eigen::Vector3d& x) {
      const Eigen::Vector3d h = (fit.lightEstimate->directionFrom(x) + (eye - x).normalized()).normalized();
      return std::acos(std::clamp(h.dot(normal), -1.0, 1.0));
    };
    PredictedHighlight found;
    found.brightest = top;
    found.contour.closed = true;
    constexpr int kDirections = 72, kHalvings = 50;
    for (int i = 0; i < kDirections; ++i) {
      const double azimuth = 2 * std::numbers::pi * i / kDirections;
      const Eigen::Vector3d along = std::cos(azimuth) * u + std::sin(azimuth) * v;
      double near = 0, far = (eye - top.point.position).norm();
      for (int n = 0; n < kHalvings; ++n) {
        const double middle = 0.5 * (near + far);
        (angleAt(top.point.position + middle * along) < *fit.limitAngle() ? near : far) = middle;
      }
      found.contour.points.push_back(*camera.project(top.point.position + near * along));
    }
    return found;
  }
};

}  // namespace glint::example

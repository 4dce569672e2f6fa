// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "core/model/level_set_prediction.h"
#include "core/model/models.h"

namespace glint {
namespace {

/// alpha of a visible surface point; empty on its dark side, and where it turns away.
std::optional<double> alphaAt(const SurfacePoint& p, const Eigen::Vector3d& eye, const Light& light) {
  const Eigen::Vector3d l = light.directionFrom(p.position), v = (eye - p.position).normalized();
  if (!(p.normal.dot(l) > 0)) return std::nullopt;
  const double alpha = incidentAngle(p.normal, l, v);
  return std::isfinite(alpha) ? std::optional<double>(alpha) : std::nullopt;
}

class LimitAngle final : public HighlightModel {
 public:
  std::string id() const override { return "limit-angle"; }
  std::string title() const override { return "Limit angle"; }
  std::string assumption() const override {
    return "The contour is the level set alpha = alpha_lim on the surface; no ellipsoid: any smooth surface, point-like light.";
  }
  std::string reference() const override { return "method.md section 7"; }
  bool needsLight() const override { return true; }
  bool needsCanonicalContours() const override { return false; }

  Outcome<ModelFit> fit(const FitInput& input, const Settings&) const override {
    if (!input.light) return input.lightFailure ? *input.lightFailure : Failure{Reason::NoLight, ""};
    ModelFit fit;
    for (const TrainingView& v : input.views)
      if (!v.failure) fit.frames.push_back(v.frame);
    if (!(input.light->limitAngle > 0)) return Failure{Reason::TooFewPoints, "no contour point on the surface"};
    fit.lightEstimate = input.light->light;
    fit.lightCovariance = input.light->covariance;
    fit.limitAngle = input.light->limitAngle;
    fit.solver = input.light->solver;
    fit.condition = input.light->condition;
    return fit;
  }

  Prediction predict(const ModelFit& fit, const Camera& camera, const Surface* surface, const Settings& settings) const override {
    Prediction p;
    if (!surface || !fit.lightEstimate || !fit.limitAngle) {
      p.failure = Failure{surface ? Reason::NoLight : Reason::NoSurface, ""};
      return p;
    }
    const Light& light = *fit.lightEstimate;
    const Eigen::Vector3d eye = camera.centreInWorld();
    const auto brightest = brightestPointsFor(*surface, camera, light, settings);
    SurfaceField field;
    field.value = [&](const SurfacePoint& at) { return alphaAt(at, eye, light); };
    field.level = *fit.limitAngle;
    if (brightest)
      for (const BrightestPoint& b : *brightest) field.peaks.push_back({b, b.alpha});
    p = predictLevelSet(field, camera, *surface, settings);
    if (p.failure && !brightest) p.failure = brightest.failure();
    return p;
  }
};

}  // namespace

std::unique_ptr<HighlightModel> makeLimitAngle() { return std::make_unique<LimitAngle>(); }

}  // namespace glint

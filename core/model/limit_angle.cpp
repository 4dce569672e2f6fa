// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/light/directed_limit.h"
#include "core/model/level_set_prediction.h"
#include "core/model/models.h"
#include "core/model/plausible.h"
#include "core/model/star.h"
#include "core/model/star_level_set.h"
#include "core/model/uncertainty.h"

namespace glint {
namespace {

/// alpha of a visible surface point; empty on its dark side, and where it turns away.
std::optional<double> alphaAt(const SurfacePoint& p, const Eigen::Vector3d& eye, const Light& light) {
  const Eigen::Vector3d l = light.directionFrom(p.position), v = (eye - p.position).normalized();
  if (!(p.normal.dot(l) > 0)) return std::nullopt;
  const double alpha = incidentAngle(p.normal, l, v);
  return std::isfinite(alpha) ? std::optional<double>(alpha) : std::nullopt;
}

/// alpha in units in which the limit angle is the same in all directions: its level set at `limit` is the contour.
std::optional<double> directedAlpha(const SurfacePoint& p, const Eigen::Vector3d& eye, const Light& light, double limit,
                                    const std::optional<Eigen::Matrix3d>& extent) {
  const std::optional<double> alpha = alphaAt(p, eye, light);
  if (!alpha || !extent) return alpha;
  return *alpha * limit /
         directedLimit(limit, *extent, p.position, p.normal, (eye - p.position).normalized(), light.homogeneous());
}

/// The extent in words: the length of a uniform lamp whose second moment, length^2 / 12, is that of the longest axis. `extent` is
/// -2 log q times it. A point lamp over a long-tailed lobe at slanted incidence asks for one, too: the model has no lobe to tell
/// them apart by.
std::string extentRemark(const Eigen::Matrix3d& extent, bool angular, double level) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(extent);
  const double length = std::sqrt(12 * std::max(0.0, axes.eigenvalues()(2)) / (-2 * std::log(level)));
  return formatted(
      "the contours suggest a light about %.2g %s long: a long light, several lights whose highlights merge, or a lobe that one "
      "limit angle does not describe (compare with reflectance, which has a lobe)",
      angular ? length * 180 / M_PI : length, angular ? "degrees" : "m");
}

WalkOptions walkOptions(const Settings& settings) {
  WalkOptions options;
  options.toleranceRad = settings.number("predict.walk_tolerance");
  return options;
}

std::optional<Failure> firstFailure(const CanonicalContour& c) {
  for (const DirectionResult& d : c.directions)
    if (d.failure) return d.failure;
  return std::nullopt;
}

class LimitAngle final : public HighlightModel {
 public:
  std::string id() const override { return "limit-angle"; }
  std::string title() const override { return "Limit angle"; }
  std::string assumption() const override {
    return "The contour is the level set alpha = alpha_lim on the surface, without an ellipsoid. Valid on any smooth surface "
           "with a point-like light.";
  }
  std::string reference() const override { return "method.md section 7"; }
  bool needsLight() const override { return true; }
  bool needsCanonicalContours() const override { return false; }
  ModelTraits traits() const override { return {{213, 94, 0}}; }
  bool walks() const override { return true; }

  Outcome<ModelFit> fit(const FitInput& input, const Settings& settings) const override {
    if (!input.light) return input.lightFailure ? *input.lightFailure : Failure{Reason::NoLight, ""};
    ModelFit fit;
    std::vector<UsedContour> used;
    double level = 0;
    for (const TrainingView& v : input.views) {
      if (!v.seen) continue;
      fit.frames.push_back(v.frame);
      level = v.highlight.level;
      used.push_back(usedContour(v));
    }
    if (!(input.light->limitAngle > 0)) return Failure{Reason::TooFewPoints, "no contour point on the surface"};
    fit.lightEstimate = input.light->light;
    fit.lightCovariance = input.light->covariance;
    fit.family = LimitAngleFit{input.light->limitAngle, input.light->extent};
    fit.solver = input.light->solver;
    fit.condition = input.light->condition;
    fit.hints = hintsOf(input);
    fit.uncertainty = input.light->uncertainty;
    if (input.light->extent && level > 0 && level < 1)
      fit.remarks.push_back(extentRemark(*input.light->extent, fit.lightEstimate->atInfinity(), level));
    fit.residualPx = input.light->residualPx;
    if (fit.residualPx.size() != used.size()) return fit;  // a light that was given, not estimated from these views
    return explaining(std::move(fit), used, true, settings.number("fit.most_residual"));
  }

  Eigen::MatrixXd bandShiftsPx(const ModelFit& fit, const PredictedHighlight& highlight, const Camera& camera,
                               const Surface* surface, const Settings&) const override {
    const LimitAngleFit* const fitted = fit.as<LimitAngleFit>();
    if (!surface || !fit.uncertainty || !fit.lightEstimate || !fitted) return {};
    const Light& light = *fit.lightEstimate;
    const Eigen::Vector3d eye = camera.centreInWorld();
    SurfaceField field;
    field.value = [&](const SurfacePoint& at) { return directedAlpha(at, eye, light, fitted->limitAngle, fitted->extent); };
    field.level = fitted->limitAngle;
    const Eigen::MatrixXd& root = fit.uncertainty->root;
    const ColumnSlopes slopes = [&](const SurfacePoint& at) -> std::optional<Eigen::VectorXd> {
      if (fitted->extent) {
        // (value - limit) with every parameter moved along one column; small against a standard deviation.
        const auto moved = [&](const Eigen::VectorXd& by) -> double {
          const Eigen::Vector4d other = light.homogeneous() + parameters::kLight.of(by);
          Eigen::Matrix3d extent = *fitted->extent + symmetric(parameters::kExtent.of(by));
          // A light at infinity keeps its angular extent where the step brings it nearer: beyond infinity is the other side of
          // it.
          if (light.atInfinity() && other.w() != 0) extent *= other.head<3>().squaredNorm() / (other.w() * other.w());
          Eigen::Vector3d toLight = (other.head<3>() - other.w() * at.position).normalized();
          if (at.normal.dot(toLight) < 0) toLight = -toLight;
          const Eigen::Vector3d toCamera = (eye - at.position).normalized();
          const double limit = fitted->limitAngle + by(parameters::kLimitAngle.first);
          return incidentAngle(at.normal, toLight, toCamera) -
                 directedLimit(limit, extent, at.position, at.normal, toCamera, other);
        };
        const double here = directedLimit(fitted->limitAngle, *fitted->extent, at.position, at.normal,
                                          (eye - at.position).normalized(), light.homogeneous());
        constexpr double kStep = 0.01;
        Eigen::VectorXd change(root.cols());
        for (Eigen::Index k = 0; k < root.cols(); ++k)
          change(k) = (moved(kStep * root.col(k)) - moved(-kStep * root.col(k))) / (2 * kStep) * fitted->limitAngle / here;
        return change;
      }
      Eigen::VectorXd byParameters(5);
      byParameters << incidentAngleByLight(at.position, at.normal, (eye - at.position).normalized(), light.homogeneous()), -1.0;
      return root.transpose() * byParameters;
    };
    return levelSetShiftsPx(highlight.contour.points, field, camera, *surface, slopes);
  }

  /// By the lobe that a limit angle stands for: log I falls with tan^2 alpha, whatever the level.
  std::optional<ModelFit> atLevelOf(const ModelFit& fit, const Pixel& place, const Camera& camera, const Surface& surface,
                                    const Settings&) const override {
    const LimitAngleFit* const fitted = fit.as<LimitAngleFit>();
    const Outcome<SurfacePoint> hit = surface.firstHit(camera.ray(place));
    if (!hit || !fit.lightEstimate || !fitted) return std::nullopt;
    const Eigen::Vector3d eye = camera.centreInWorld();
    const std::optional<double> there = alphaAt(facing(*hit, eye), eye, *fit.lightEstimate);
    if (!there) return std::nullopt;
    ModelFit other = fit;
    std::get<LimitAngleFit>(other.family).limitAngle = std::atan(std::hypot(std::tan(fitted->limitAngle), std::tan(*there)));
    return other;
  }

  Prediction predict(const ModelFit& fit, const Camera& camera, const Surface* surface, const Settings& settings) const override {
    const LimitAngleFit* const fitted = fit.as<LimitAngleFit>();
    if (!surface || !fit.lightEstimate || !fitted) return Failure{surface ? Reason::NoLight : Reason::NoSurface, ""};
    const Light& light = *fit.lightEstimate;
    const Eigen::Vector3d eye = camera.centreInWorld();
    const auto brightest = brightestPointsFor(*surface, camera, light, settings, fit.hints);
    if (!fitted->extent && settings.text("predict.query") == "local-quadric")
      return onLocalQuadrics(fitted->limitAngle, camera, *surface, light, brightest, settings);
    if (!fitted->extent && settings.text("predict.contour") == "star" && brightest && brightest->size() == 1)
      if (std::optional<PredictedHighlight> h = star(fitted->limitAngle, camera, *surface, light, brightest->front(), settings))
        return std::vector{std::move(*h)};
    if (!fitted->extent && settings.text("predict.contour") == "star" && brightest && brightest->size() > 1)
      if (Outcome<std::vector<PredictedHighlight>> several =
              stars(fitted->limitAngle, camera, *surface, light, *brightest, settings))
        return std::move(*several);
    SurfaceField field;
    field.value = [&](const SurfacePoint& at) { return directedAlpha(at, eye, light, fitted->limitAngle, fitted->extent); };
    field.level = fitted->limitAngle;
    if (brightest)
      for (const BrightestPoint& b : *brightest) field.peaks.push_back({b, b.alpha});
    Prediction p = predictLevelSet(field, camera, *surface, settings);
    return p.failure() && !brightest ? Prediction(brightest.failure()) : p;
  }

 private:
  /// One star on the patch of every brightest point; a patch knows nothing of other highlights nor of the surface's border.
  static Prediction onLocalQuadrics(double limit, const Camera& camera, const Surface& surface, const Light& light,
                                    const Outcome<std::vector<BrightestPoint>>& brightest, const Settings& settings) {
    if (!brightest) return brightest.failure();
    std::vector<PredictedHighlight> found;
    std::optional<Failure> why;
    for (const BrightestPoint& b : *brightest) {
      const Outcome<LocalQuadric> patch = LocalQuadric::of(surface, b.point);
      if (!patch) {
        why = patch.failure();
        continue;
      }
      WalkOptions options = walkOptions(settings);
      options.toleranceRad = std::max(options.toleranceRad, kPatchToleranceRad);
      const TangentWalk walk(*patch, camera, b, light, options);
      PredictedHighlight h;
      h.brightest = b;
      h.tangentPlane = walk.tangentPlane();
      const CanonicalContour c = starContour(walk, *patch, camera, limit, settings.integer("predict.directions"));
      outlineOf(c, h);
      if (h.contour.points.size() < 3) {
        why = firstFailure(c);
        continue;
      }
      h.curvatureVariation = curvatureVariation(*patch, surface, c);
      if (const Outcome<Ellipse> e = fitEllipse(c.pixels)) h.ellipse = *e;
      found.push_back(std::move(h));
    }
    dropEnclosed(found);
    return {std::move(found), std::move(why)};
  }

  /// The level set around the only brightest point by walks on the surface. Nothing when some direction fails: the region is then
  /// cut, partly hidden or not a star, and the level set answers.
  static std::optional<PredictedHighlight> star(double limit, const Camera& camera, const Surface& surface, const Light& light,
                                                const BrightestPoint& b, const Settings& settings) {
    const TangentWalk walk(surface, camera, b, light, walkOptions(settings));
    const CanonicalContour c = starContour(walk, surface, camera, limit, settings.integer("predict.directions"));
    if (std::any_of(c.directions.begin(), c.directions.end(), [](const DirectionResult& d) { return d.failure.has_value(); }))
      return std::nullopt;
    PredictedHighlight h;
    h.brightest = b;
    h.tangentPlane = walk.tangentPlane();
    outlineOf(c, h);
    if (const Outcome<Ellipse> e = fitEllipse(c.pixels)) h.ellipse = *e;
    return h;
  }

  /// The same around several brightest points, by walks along pixel rays on alpha^2, which is quadratic at its zeros. The reason
  /// where two share a region, one is not a star, or the surface may reach the limit elsewhere.
  static Outcome<std::vector<PredictedHighlight>> stars(double limit, const Camera& camera, const Surface& surface,
                                                        const Light& light, const std::vector<BrightestPoint>& brightest,
                                                        const Settings& settings) {
    const Eigen::Vector3d eye = camera.centreInWorld();
    const StarField field{
        [&](const SurfacePoint& at) {
          const std::optional<double> alpha = alphaAt(at, eye, light);
          return alpha ? *alpha * *alpha : std::nan("");
        },
        light, 0,
        [](const PartBounds& parts, double level) { return Eight(float(level) - parts.tanSquared.sqrt().atan().square()); }};
    std::vector<Summit> summits;
    for (const BrightestPoint& b : brightest) {
      Outcome<Summit> s = summitNear(field, camera, surface, b, limit * limit);
      if (!s) return s.failure();
      summits.push_back(*s);
    }
    Outcome<std::vector<PredictedHighlight>> found = starHighlights(field, camera, surface, summits, limit * limit, settings);
    if (found)
      for (PredictedHighlight& h : *found)  // the mirror points themselves are known better
        h.brightest =
            *std::min_element(brightest.begin(), brightest.end(), [&](const BrightestPoint& a, const BrightestPoint& b) {
              return (a.pixel - h.brightest.pixel).squaredNorm() < (b.pixel - h.brightest.pixel).squaredNorm();
            });
    return found;
  }
};

}  // namespace

std::unique_ptr<HighlightModel> makeLimitAngle() { return std::make_unique<LimitAngle>(); }

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/model/fit_ellipsoid.h"
#include "core/model/models.h"
#include "core/model/plausible.h"
#include "core/model/star.h"
#include "core/surface/local_quadric.h"

namespace glint {
namespace {

class Canonical final : public EllipsoidModel {
 public:
  std::string id() const override { return "canonical"; }
  std::string title() const override { return "Canonical JOLIMAS"; }
  std::string assumption() const override {
    return "Each contour is carried to its tangent plane by limit angles; the ellipses there are outlines of one fixed ellipsoid "
           "in "
           "the virtual cameras. Valid on any smooth surface.";
  }
  std::string reference() const override {
    return "Morgand, Tamaazousti, Bartoli, canonical JOLIMAS (2022); method.md sections 6 to 8";
  }
  bool needsLight() const override { return true; }
  bool needsCanonicalContours() const override { return true; }
  ModelTraits traits() const override { return {{0, 158, 115}}; }
  std::optional<ConicView> outlineIn(const TrainingView& v) const override {
    if (!v.seen || !v.canonical || !v.canonical->ellipse) return std::nullopt;
    return ConicView{v.seen->virtualCamera, *v.canonical->ellipse, v.canonical->pixels};
  }
  bool walks() const override { return true; }

  Outcome<ModelFit> fit(const FitInput& input, const Settings& settings) const override {
    if (!input.light) return input.lightFailure ? *input.lightFailure : Failure{Reason::NoLight, ""};
    return EllipsoidModel::fit(input, settings);
  }

  Prediction predict(const ModelFit& fit, const Camera& camera, const Surface* surface, const Settings& settings) const override {
    if (!surface) return Failure{Reason::NoSurface, ""};
    const Outcome<Ellipsoid> ellipsoid = ellipsoidOf(fit);
    if (!ellipsoid) return ellipsoid.failure();
    const Light light = fit.lightEstimate ? *fit.lightEstimate : Light::at(ellipsoid->centre());
    const auto brightest = brightestPointsFor(*surface, camera, light, settings, fit.hints);
    if (!brightest) return brightest.failure();
    const bool localQuadric = settings.text("predict.query") == "local-quadric";
    WalkOptions walkOptions;
    walkOptions.toleranceRad = settings.number("predict.walk_tolerance");
    if (localQuadric) walkOptions.toleranceRad = std::max(walkOptions.toleranceRad, kPatchToleranceRad);
    std::vector<PredictedHighlight> found;
    std::optional<Failure> why;
    for (const BrightestPoint& b : *brightest) {
      std::optional<LocalQuadric> patch;
      if (localQuadric) {
        Outcome<LocalQuadric> q = LocalQuadric::of(*surface, b.point);
        if (!q) return q.failure();
        patch = std::move(*q);
      }
      const Surface& walked = patch ? static_cast<const Surface&>(*patch) : *surface;
      const TangentWalk walk(walked, camera, b, light, walkOptions);
      const Outcome<Ellipse> e = outlineEllipse(*ellipsoid, virtualCamera(camera, walk.tangentPlane()));
      if (!e) {
        why = e.failure();
        continue;
      }
      PredictedHighlight h;
      h.brightest = b;
      h.tangentPlane = walk.tangentPlane();
      h.canonical = predictFromEllipse(walk, walked, camera, *e, settings.integer("predict.directions"));
      outlineOf(*h.canonical, h);
      if (patch) h.curvatureVariation = curvatureVariation(*patch, *surface, *h.canonical);
      h.ellipse = h.canonical->ellipse;
      h.canonical->ellipse = *e;  // on T, for the viewer
      if (h.contour.points.size() < 3) {
        // Too few directions close a contour; the first named reason tells why.
        for (const DirectionResult& d : h.canonical->directions)
          if (d.failure) {
            why = d.failure;
            break;
          }
        continue;
      }
      found.push_back(std::move(h));
    }
    dropEnclosed(found);
    return {std::move(found), std::move(why)};
  }

 private:
  std::optional<Failure> unused(const TrainingView& v) const override {
    if (!v.seen) return v.seen.failure();
    if (v.highlight.touchesBorder) return notWhole(v);
    if (!v.canonical) return Failure{Reason::NoBrightestPoint, ""};
    if (v.canonical->ellipse) return std::nullopt;
    // The directions know why there are too few points on the tangent plane for an ellipse.
    for (const DirectionResult& d : v.canonical->directions)
      if (d.failure) return d.failure;
    return Failure{Reason::NotAnEllipse, "the canonical contour"};
  }
  /// On the tangent plane the contour is larger than in the photograph, and so are its noise and what the ellipsoid leaves of it.
  double unitOf(const ConicView& outline, const TrainingView& v) const override {
    const double canonicalRadius = std::sqrt(outline.ellipse.semiAxes.prod());
    return canonicalRadius / radiusPx(v.highlight.contour);
  }
  void complete(const FitInput& input, ModelFit& fit) const override {
    fit.lightEstimate = input.light->light;
    fit.lightCovariance = input.light->covariance;
    std::get<EllipsoidFit>(fit.family).limitAngle = input.light->limitAngle;
    fit.hints = hintsOf(input);
    if (!fit.uncertainty || !input.light->uncertainty) return;
    // The light moves the prediction on its own as well. Taken as independent: the contours' noise enters both, through
    // different residuals.
    const Eigen::MatrixXd ellipsoid = fit.uncertainty->root, lamp = parameters::kLight.of(input.light->uncertainty->root);
    Eigen::MatrixXd& root = fit.uncertainty->root;
    root = Eigen::MatrixXd::Zero(ellipsoid.rows() + lamp.rows(), ellipsoid.cols() + lamp.cols());
    root.topLeftCorner(ellipsoid.rows(), ellipsoid.cols()) = ellipsoid;
    parameters::kLampOfEllipsoid.of(root).rightCols(lamp.cols()) = lamp;
  }
};

}  // namespace

std::unique_ptr<HighlightModel> makeCanonical() { return std::make_unique<Canonical>(); }

}  // namespace glint

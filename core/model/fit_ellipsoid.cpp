// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/fit_ellipsoid.h"

#include <string>

#include "core/light/estimate.h"

namespace glint {

Outcome<Reconstruction> fitEllipsoid(const std::vector<ConicView>& views, const std::optional<CentreAnchor>& anchor,
                                     const Settings& settings) {
  const std::string& solver = settings.text("fit.solver");
  if (solver == "anchored") {
    if (!anchor) return Failure{Reason::NoLight, "the anchored solver needs a centre"};
    return reconstructAnchored(views, anchor->position);
  }
  if (views.size() < 3) return Failure{Reason::TooFewViews, "a free centre needs 3 views, have " + std::to_string(views.size())};
  const std::optional<Eigen::Vector3d> origin = anchor ? std::optional<Eigen::Vector3d>(anchor->position) : std::nullopt;
  const Outcome<Reconstruction> linear = reconstructLinear(views, origin);
  if (solver == "linear") {
    if (linear && !linear->ellipsoid)
      return Failure{Reason::NotAnEllipsoid, std::string("the linear solution is a ") + describe(linear->quadric)};
    return linear;
  }
  std::optional<Ellipsoid> start;
  if (linear && linear->ellipsoid) start = linear->ellipsoid;
  std::optional<CentrePrior> prior;
  if (anchor && anchor->covariance) {
    const double k = settings.number("fit.prior_scale");
    prior = CentrePrior{anchor->position, k * k * *anchor->covariance};
  }
  if (!start || prior) {
    // With a prior the anchored solution is the better start: the linear one can lie far from the light.
    if (anchor) {
      const Outcome<Reconstruction> anchored = reconstructAnchored(views, anchor->position);
      if (anchored && anchored->ellipsoid) start = anchored->ellipsoid;
      else if (!start && !anchored) return anchored.failure();
    }
  }
  if (!start) {
    if (!linear) return linear.failure();
    return Failure{Reason::NotAnEllipsoid, std::string("the linear solution is a ") + describe(linear->quadric) + " and there is no anchor"};
  }
  Outcome<Reconstruction> refined = reconstructRefined(views, *start, prior);
  if (refined && linear) {
    refined->singularValues = linear->singularValues;
    refined->gapRatio = linear->gapRatio;
    refined->condition = linear->condition;
  }
  return refined;
}

std::optional<CentreAnchor> anchorFromCentres(const std::vector<TrainingView>& views) {
  std::vector<ReflectedRay> rays;
  for (const TrainingView& v : views) {
    if (v.failure || !v.highlight.ellipse) continue;
    const Ray ray = v.camera.ray(v.highlight.ellipse->centre);
    rays.push_back({ray.origin, ray.direction, ray.direction});
  }
  if (rays.size() < 2) return std::nullopt;
  const Outcome<Triangulation> t = triangulateLight(rays);
  if (!t || t->light.atInfinity()) return std::nullopt;
  return CentreAnchor{t->light.position(), t->covariance};
}

void store(const Reconstruction& r, ModelFit& fit) {
  fit.quadric = r.quadric;
  fit.ellipsoid = r.ellipsoid;
  fit.singularValues = r.singularValues;
  fit.gapRatio = r.gapRatio;
  fit.condition = r.condition;
  fit.residualPx = r.residualPx;
  fit.solver = r.solver;
}

PredictedHighlight highlightFromEllipse(const Ellipse& ellipse, const BrightestPoint& brightest, int points) {
  PredictedHighlight h;
  h.contour = Polyline{ellipse.sample(points), true};
  h.ellipse = ellipse;
  h.brightest = brightest;
  return h;
}

}  // namespace glint

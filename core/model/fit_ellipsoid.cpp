// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/fit_ellipsoid.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>

#include "core/light/estimate.h"
#include "core/model/ellipse_distance.h"

namespace glint {
namespace {

constexpr int kContourPoints = 72;
constexpr std::size_t kLeftOut = 6;  // views left out when the bias is chosen: more would not change a choice among three

/// Tried by leave-one-view-out, as fractions of the anchor's distance: practically anchored; the light's own bias (2 % on the
/// path-traced plane, 9 % on the sphere); and loose enough to leave the centre to the contours.
constexpr double kPriorBiases[] = {0.003, 0.03, 0.3};

CentrePrior priorWith(const CentreAnchor& anchor, double bias) {
  Eigen::Matrix3d covariance = anchor.covariance.value_or(Eigen::Matrix3d::Zero());
  const double sigma = bias * anchor.distance;
  covariance.diagonal().array() += sigma * sigma;
  return {anchor.position, covariance};
}

/// RMS distance of a view's points from the outline, over the size of its ellipse; infinity where there is no outline.
double outlineError(const Ellipsoid& ellipsoid, const ConicView& view) {
  const Outcome<Ellipse> e = outlineEllipse(ellipsoid, view.projection);
  if (!e) return std::numeric_limits<double>::infinity();
  double sum = 0;
  const std::vector<Pixel> points = view.points.empty() ? view.ellipse.sample(36) : view.points;
  for (const Pixel& p : points) sum += std::pow(footOnEllipse(*e, p).distance, 2);
  return std::sqrt(sum / double(points.size()) / view.ellipse.area());
}

/// The trials only rank the biases: a third of the usual contour points tells that as well.
constexpr std::size_t kPointsPerTrial = 24;

ConicView thinned(const ConicView& view, std::size_t count) {
  if (view.points.size() <= count) return view;
  ConicView few{view.projection, view.ellipse, {}};
  for (std::size_t k = 0; k < count; ++k) few.points.push_back(view.points[k * view.points.size() / count]);
  return few;
}

/// The bias whose fits predict left-out views best; the loosest when none does.
double bestPriorBias(const std::vector<ConicView>& views, const CentreAnchor& anchor) {
  // Fewer points would give the prior more weight: its covariance grows by as much.
  double all = 0, kept = 0;
  for (const ConicView& v : views) all += double(v.points.size()), kept += double(thinned(v, kPointsPerTrial).points.size());
  const double fewer = kept > 0 ? all / kept : 1;
  double best = kPriorBiases[std::size(kPriorBiases) - 1], smallest = std::numeric_limits<double>::infinity();
  for (const double bias : kPriorBiases) {
    double sum = 0;
    const std::size_t count = std::min(kLeftOut, views.size());
    CentrePrior prior = priorWith(anchor, bias);
    prior.covariance *= fewer;
    for (std::size_t k = 0; k < count && sum < smallest; ++k) {  // above the best so far it cannot win
      const std::size_t left = k * views.size() / count;
      std::vector<ConicView> others;
      for (std::size_t i = 0; i < views.size(); ++i)
        if (i != left) others.push_back(thinned(views[i], kPointsPerTrial));
      const Outcome<Reconstruction> anchored = reconstructAnchored(others, anchor.position);
      const Outcome<Reconstruction> r = anchored && anchored->ellipsoid
                                            ? reconstructRefined(others, *anchored->ellipsoid, prior)
                                            : Outcome<Reconstruction>(Failure{Reason::NotAnEllipsoid, ""});
      sum += r && r->ellipsoid ? outlineError(*r->ellipsoid, views[left]) : std::numeric_limits<double>::infinity();
    }
    if (sum < smallest) smallest = sum, best = bias;
  }
  return best;
}

}  // namespace

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
  if (anchor) {
    const Outcome<Reconstruction> anchored = reconstructAnchored(views, anchor->position);
    if (anchored) start = anchored->ellipsoid;
    else if (!linear) return anchored.failure();
  }
  // With an anchor its solution is the better start: the linear one can lie far from the light.
  if (!start && linear) start = linear->ellipsoid;
  if (!start) {
    if (!linear) return linear.failure();
    return Failure{Reason::NotAnEllipsoid, std::string("the linear solution is a ") + describe(linear->quadric) + " and there is no anchor"};
  }
  Outcome<Reconstruction> refined = Failure{Reason::NotConverged, ""};
  if (anchor && anchor->distance > 0) {
    const double bias = settings.number("fit.prior_bias");
    refined = reconstructRefined(views, *start, priorWith(*anchor, bias > 0 ? bias : bestPriorBias(views, *anchor)));
  } else {
    refined = reconstructRefined(views, *start);
  }
  if (refined && linear) {
    refined->singularValues = linear->singularValues;
    refined->gapRatio = linear->gapRatio;
    refined->condition = linear->condition;
  }
  return refined;
}

std::optional<CentreAnchor> anchorAtLight(const FitInput& input) {
  if (!input.light || input.light->light.atInfinity()) return std::nullopt;
  CentreAnchor anchor{input.light->light.position(), input.light->covariance, 0};
  int n = 0;
  for (const TrainingView& v : input.views)
    if (!v.failure && v.brightest) anchor.distance += (anchor.position - v.brightest->point.position).norm(), ++n;
  if (n > 0) anchor.distance /= n;
  return anchor;
}

bool hasWholeEllipse(const TrainingView& view) {
  return view.highlight.ellipse && !(view.failure && view.failure->reason == Reason::OutsideImage);
}

std::optional<CentreAnchor> anchorFromCentres(const std::vector<TrainingView>& views) {
  std::vector<ReflectedRay> rays;
  for (const TrainingView& v : views) {
    if (!hasWholeEllipse(v)) continue;
    const Ray ray = v.camera.ray(v.highlight.ellipse->centre);
    rays.push_back({ray.origin, ray.direction, ray.direction});
  }
  if (rays.size() < 2) return std::nullopt;
  const Outcome<Triangulation> t = triangulateLight(rays);
  if (!t || t->light.atInfinity()) return std::nullopt;
  CentreAnchor anchor{t->light.position(), t->covariance, 0};
  for (const ReflectedRay& r : rays) anchor.distance += (anchor.position - r.origin).norm() / double(rays.size());
  return anchor;
}

ConicView conicViewOf(const TrainingView& view, const Projection& projection) {
  require(view.highlight.ellipse.has_value(), "conicViewOf: the view has no ellipse");
  return {projection, *view.highlight.ellipse, resample(view.highlight.contour, kContourPoints)};
}

void store(const Reconstruction& r, ModelFit& fit) {
  fit.quadric = r.quadric;
  fit.ellipsoid = r.ellipsoid;
  fit.singularValues = r.singularValues;
  fit.gapRatio = r.gapRatio;
  fit.condition = r.condition;
  fit.residualPx = r.residualPx;
  fit.solver = r.solver;
  fit.uncertainty = r.uncertainty;
}

PredictedHighlight highlightFromEllipse(const Ellipse& ellipse, const BrightestPoint& brightest, int points) {
  PredictedHighlight h;
  h.contour = Polyline{ellipse.sample(points), true};
  h.ellipse = ellipse;
  h.brightest = brightest;
  return h;
}

}  // namespace glint

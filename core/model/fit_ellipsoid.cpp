// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/fit_ellipsoid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/base/number_text.h"
#include "core/light/estimate.h"
#include "core/model/ellipse_distance.h"
#include "core/model/plausible.h"

namespace glint {
namespace {

constexpr int kContourPoints = 72;
/// How far the centre may lie from the estimated light as a share of the light's distance: the light of a simple lobe is off by 1 % (path-traced
/// plane) to 9 % (sphere).
constexpr double kPriorBias = 0.01;
constexpr double kSameWorth = 1e-3;  // residuals tell a standard deviation to some hundredths
constexpr int kMostWeightings =
    6;  // two to four mostly; where the correlation of the residuals is cut at another lag each time it goes to and fro
constexpr double kLeastWorthPx = 0.01;  // below the accuracy of any detection; keeps the prior's weight finite on exact data

CentrePrior priorWith(const CentreAnchor& anchor, double bias) {
  Eigen::Matrix3d covariance = anchor.covariance.value_or(Eigen::Matrix3d::Zero());
  const double sigma = bias * anchor.distance;
  covariance.diagonal().array() += sigma * sigma;
  return {anchor.position, covariance};
}

/// What one contour point is worth, px: the RMS distance of the points from the outlines, times the root of 1 + 2 sum rho_k for
/// distances that are correlated along their contour. Where the ellipsoid fits to the noise that is the noise; where it does not
/// fit (a curved surface, slanted views) the distances wave slowly along the contour, and many points say no more than a few.
/// Nothing where too few views see it.
std::optional<double> worthPx(const Ellipsoid& ellipsoid, const std::vector<ConicView>& views) {
  std::vector<std::vector<double>> distances;
  double squares = 0, count = 0;
  std::size_t longest = 0;
  for (const ConicView& view : views) {
    const Outcome<Ellipse> e = outlineEllipse(ellipsoid, view.projection);
    if (!e) continue;
    distances.emplace_back();
    for (const Pixel& p : view.points.empty() ? view.ellipse.sample(36) : view.points) {
      distances.back().push_back(footOnEllipse(*e, p).distance);
      squares += distances.back().back() * distances.back().back();
    }
    count += double(distances.back().size());
    longest = std::max(longest, distances.back().size());
  }
  if (!(count > 9)) return std::nullopt;
  if (!(squares > 0)) return kLeastWorthPx;
  double inflation = 1;
  const double noticed = 2 / std::sqrt(count);  // an autocorrelation of white noise stays below this
  for (std::size_t lag = 1; lag <= longest / 2; ++lag) {
    double sum = 0;
    for (const std::vector<double>& d : distances)
      for (std::size_t i = 0; i < d.size(); ++i) sum += d[i] * d[(i + lag) % d.size()];
    if (!(sum / squares > noticed)) break;
    inflation += 2 * sum / squares;
  }
  return std::max(kLeastWorthPx, std::sqrt(inflation * squares / (count - 9)));
}

/// The refined ellipsoid with contours and prior in the same unit: standard deviations. What a contour point is worth is not
/// known before the fit, so it is estimated from the start, then from each fit, until it stays (the solver counts a pixel as one
/// standard deviation, so the prior is scaled instead). A first guess in pixels would make the answer depend on their number.
/// Where the fit with the better weight is refused, the one before it stands, with a remark.
Outcome<Reconstruction> refinedWithPrior(const std::vector<ConicView>& views, const Ellipsoid& start, const CentreAnchor& anchor, double bias) {
  const CentrePrior prior = priorWith(anchor, bias);
  const auto counting = [&](double worth) {
    return reconstructRefined(views, start, CentrePrior{prior.mean, prior.covariance / (worth * worth)});
  };
  double counted = 1;  // px, as which the fit so far counts a contour point
  Outcome<Reconstruction> refined = Failure{Reason::NotConverged, ""};
  if (const std::optional<double> worth = worthPx(start, views)) refined = counting(counted = *worth);
  // Where no weight is known, or the first one is refused: a pixel.
  if (!refined) refined = counting(counted = 1);
  for (int round = 0; round < kMostWeightings && refined && refined->ellipsoid; ++round) {
    const std::optional<double> worth = worthPx(*refined->ellipsoid, views);
    if (!worth || std::abs(*worth / counted - 1) < kSameWorth) break;
    Outcome<Reconstruction> again = counting(*worth);
    if (!again) {
      refined->remarks.push_back(formatted(
          "the fit assumes that a contour point is accurate to %.2g px; with %.2g px, as its residuals suggest, it finds "
          "no ellipsoid (%s)",
          counted, *worth, again.failure().message().c_str()));
      break;
    }
    refined = std::move(again);
    counted = *worth;
  }
  return refined;
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
  if (solver == "linear") return linear;
  std::optional<Ellipsoid> start;
  if (anchor) {
    const Outcome<Reconstruction> anchored = reconstructAnchored(views, anchor->position);
    if (anchored) start = anchored->ellipsoid;
    else if (!linear) return anchored.failure();
  }
  // With an anchor its solution is the better start: the linear one can lie far from the light.
  if (!start && linear) start = linear->ellipsoid;
  if (!start) return linear;  // nothing to refine
  Outcome<Reconstruction> refined = Failure{Reason::NotConverged, ""};
  if (anchor && anchor->distance > 0) {
    const double bias = settings.number("fit.prior_bias");
    refined = refinedWithPrior(views, *start, *anchor, bias > 0 ? bias : kPriorBias);
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
  if (view.failure && view.failure->reason == Reason::OutsideImage) return false;
  return view.highlight.ellipse && !tooSmall(view.highlight.contour);
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
  fit.remarks.insert(fit.remarks.end(), r.remarks.begin(), r.remarks.end());
}

PredictedHighlight highlightFromEllipse(const Ellipse& ellipse, const BrightestPoint& brightest, int points) {
  PredictedHighlight h;
  h.contour = Polyline{ellipse.sample(points), true};
  h.ellipse = ellipse;
  h.brightest = brightest;
  return h;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/fit_ellipsoid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/base/number_text.h"
#include "core/base/residual_spread.h"
#include "core/light/estimate.h"
#include "core/model/plausible.h"
#include "core/model/reconstruct_detail.h"

namespace glint {
namespace {

constexpr int kContourPoints = 72;
/// How far the centre may lie from the estimated light as a share of the light's distance: the light of a simple lobe is off by 1
/// % (path-traced plane) to 9 % (sphere).
constexpr double kPriorBias = 0.01;
constexpr double kSameWorth = 1e-3;     // residuals tell a standard deviation to some hundredths
constexpr int kMostWeightings = 12;     // two to four mostly
constexpr double kLeastWorthPx = 0.01;  // below the accuracy of any detection; keeps the prior's weight finite on exact data

CentrePrior priorWith(const CentreAnchor& anchor, double bias) {
  Eigen::Matrix3d covariance = anchor.covariance.value_or(Eigen::Matrix3d::Zero());
  const double sigma = bias * anchor.distance;
  covariance.diagonal().array() += sigma * sigma;
  return {anchor.position, covariance};
}

/// What one contour point is worth, px: the RMS distance of the points from the outlines, times the root of 1 + 2 sum rho_k for
/// distances that are correlated along their contour. Where the ellipsoid fits down to the noise, that is the noise. Where it
/// does not (a curved surface, slanted views), the distances vary slowly along the contour, and many points say no more than a
/// few. Nothing where there are too few views.
std::optional<double> worthPx(const Ellipsoid& ellipsoid, const std::vector<ConicView>& views) {
  std::vector<double> distances;
  std::vector<int> seenBy;
  double squares = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Outcome<Ellipse> e = outlineEllipse(ellipsoid, views[v].projection);
    if (!e) continue;
    for (const Pixel& p : views[v].points.empty() ? views[v].ellipse.sample(36) : views[v].points) {
      distances.push_back(footOnEllipse(*e, p).distance);
      seenBy.push_back(int(v));
      squares += distances.back() * distances.back();
    }
  }
  const double free = double(distances.size()) - 9;
  if (!(free > 0)) return std::nullopt;
  return std::max(kLeastWorthPx, std::sqrt(correlationInflation(distances, seenBy, Neighbours::Closed) * squares / free));
}

/// Looks for the value at which a fit counts a contour point and which its residuals then confirm. Simply taking the residuals'
/// answer goes to and fro where a looser prior makes them much smaller. Once the answers lie on both sides, the value is sought
/// between them (secant in logarithms, kept off the ends).
class SteadyWorth {
 public:
  double next(double counted, double worth) {
    const double x = std::log(counted), g = std::log(worth / counted);
    (g > 0 ? below_ : above_) = {x, g};
    if (!below_ || !above_) return worth;
    constexpr double kOffTheEnds = 0.1;  // of the interval: it shrinks in every round
    const double share = below_->second / (below_->second - above_->second);
    return std::exp(below_->first + std::clamp(share, kOffTheEnds, 1 - kOffTheEnds) * (above_->first - below_->first));
  }

 private:
  std::optional<std::pair<double, double>> below_, above_;  ///< log of the value that was counted, log of the residuals' answer
};

/// The refined ellipsoid with contours and prior in the same unit: standard deviations. What a contour point is worth is not
/// known before the fit, so it is estimated from the start, then from each fit, until it settles (the solver counts a pixel as
/// one standard deviation, so the prior is scaled instead). A first guess in pixels would make the answer depend on their number.
/// Where the fit with the better weight is refused, the one before it is kept, with a remark.
Outcome<Reconstruction> refinedWithPrior(const std::vector<ConicView>& views, const Ellipsoid& start, const CentreAnchor& anchor,
                                         double bias) {
  const CentrePrior prior = priorWith(anchor, bias);
  const auto counting = [&](double worth) {
    return reconstructRefined(views, start, CentrePrior{prior.mean, prior.covariance / (worth * worth)});
  };
  double counted = 1;  // px, as which the fit so far counts a contour point
  Outcome<Reconstruction> refined = Failure{Reason::NotConverged, ""};
  if (const std::optional<double> worth = worthPx(start, views)) refined = counting(counted = *worth);
  // A pixel, where no weight is known or the first one is refused.
  if (!refined) refined = counting(counted = 1);
  SteadyWorth steady;
  for (int round = 0; refined && refined->ellipsoid; ++round) {
    const std::optional<double> worth = worthPx(*refined->ellipsoid, views);
    if (!worth || std::abs(*worth / counted - 1) < kSameWorth) break;
    if (round == kMostWeightings) {
      refined->remarks.push_back(
          formatted("the accuracy of contour points did not settle: a fit that assumes %.2g px leaves residuals of %.2g px, so "
                    "shape and bands may be off by more than stated",
                    counted, *worth));
      break;
    }
    const double next = steady.next(counted, *worth);
    Outcome<Reconstruction> again = counting(next);
    if (!again) {
      refined->remarks.push_back(formatted(
          "the fit assumes that contour points are accurate to %.2g px; with %.2g px, as its residuals suggest, it finds "
          "no ellipsoid (%s)",
          counted, next, again.failure().message().c_str()));
      break;
    }
    refined = std::move(again);
    counted = next;
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
    if (anchored)
      start = anchored->ellipsoid;
    else if (!linear)
      return anchored.failure();
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
    if (v.seen) anchor.distance += (anchor.position - v.seen->brightest.point.position).norm(), ++n;
  if (n > 0) anchor.distance /= n;
  return anchor;
}

bool hasWholeEllipse(const TrainingView& view) {
  if (!view.seen && view.seen.failure().reason == Reason::OutsideImage) return false;
  return !notWhole(view) && !tooSmall(view.highlight.contour);
}

std::optional<Failure> notWhole(const TrainingView& view) {
  if (view.highlight.touchesBorder) return Failure{Reason::OutsideImage, "the image border cuts the highlight"};
  return view.highlight.ellipse ? std::optional<Failure>() : Failure{Reason::NotAnEllipse, "the contour"};
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

Outcome<ModelFit> EllipsoidModel::fit(const FitInput& input, const Settings& settings) const {
  std::vector<ConicView> conics;
  ModelFit fit;
  std::vector<UsedContour> used;
  for (const TrainingView& v : input.views) {
    std::optional<ConicView> outline = outlineIn(v);
    if (!outline) continue;
    used.push_back(usedContour(v, unitOf(*outline, v)));
    conics.push_back(*std::move(outline));
    fit.frames.push_back(v.frame);
  }
  const Outcome<Reconstruction> r = fitEllipsoid(conics, anchor(input), settings);
  if (!r) return withUnusedViews(r.failure(), input.views, [this](const TrainingView& v) { return unused(v); });
  store(*r, fit);
  complete(input, fit);
  return explaining(std::move(fit), used, false, settings.number("fit.most_residual"));
}

void store(const Reconstruction& r, ModelFit& fit) {
  fit.family = EllipsoidFit{r.quadric, r.ellipsoid, r.singularValues, r.gapRatio};
  fit.condition = r.condition;
  fit.residualPx = r.residualPx;
  fit.solver = r.solver;
  fit.uncertainty = r.uncertainty;
  fit.remarks.insert(fit.remarks.end(), r.remarks.begin(), r.remarks.end());
}

Outcome<Ellipsoid> ellipsoidOf(const ModelFit& fit) {
  if (fit.ellipsoid()) return *fit.ellipsoid();
  const EllipsoidFit* const other = fit.as<EllipsoidFit>();
  return Failure{Reason::NotAnEllipsoid, other ? describe(other->quadric) : ""};
}

PredictedHighlight highlightFromEllipse(const Ellipse& ellipse, const BrightestPoint& brightest, int points) {
  PredictedHighlight h;
  h.contour = Polyline{ellipse.sample(points), true};
  h.ellipse = ellipse;
  h.brightest = brightest;
  return h;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/extended_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/light/left_out.h"
#include "core/reflectance/radiance_problem.h"

namespace glint {
namespace {

constexpr double kExtentGain = 0.2;      // of the sum of squares, before an extent is believed
constexpr std::size_t kLeastFrames = 3;  // that a comparison of left-out ones needs
constexpr int kAxisScreenPoints = 16, kAxisScreenIterations = 20;
constexpr std::size_t kPromisingAxes = 3;
constexpr int kLeftOutPoints = 24;  // a view: enough to compare two models
constexpr double kSameExtent =
    1e-2;  // of a unit vector L, log m and the half axes over the distance: far less than a basin is wide
constexpr double kProbedLength = 0.4;  // of the lobe's width, as angles of the light: it would show little
// Where a lamp's length takes a part of the width that is seen, the lobe is narrower than the contours; both are tried.
constexpr std::array<double, 2> kStartWidths{0.7, 0.35};

struct Start {
  Lamp lamp;
  Roughness roughness;
  double cost = 0;    ///< mean robust square per point after a short fit, px^2
  lobe::State place;  ///< normalised

  /// Both lead to the same minimum.
  bool isNear(const Start& other) const {
    const Eigen::VectorXd at = place.place();
    lobe::State same = other.place;
    double nearest = (at - same.place()).norm();
    for (const LampShape& alias : aliasesOf(other.place.lamp.shape)) {
      same.lamp.shape = alias;
      nearest = std::min(nearest, (at - same.place()).norm());
    }
    return nearest < kSameExtent;
  }
};

/// What a length across the direction to a point lamp promises.
struct Promise {
  double gain = 0;  ///< of the sum of squares, px^2, to first order
  Eigen::Matrix<double, 3, 2> halfAxes =
      Eigen::Matrix<double, 3, 2>::Zero();  ///< normalised: what promises most, and what is left across it
};

Promise gainByLength(lobe::RadianceProblem& problem, const lobe::State& point) {
  if (point.atInfinity()) return {};
  problem.settle(point);
  // Second moments across the mean direction to the light; a length along it would hardly be seen.
  const Eigen::Vector3d towards = point.lamp.centre.head<3>().normalized();
  const Eigen::Vector3d u = towards.unitOrthogonal(), v = towards.cross(u);
  const double length = point.lengthOf(kProbedLength);
  std::vector<lobe::RadianceProblem::ProbeColumn> columns;
  for (const Eigen::Vector3d& axis : {u, v, Eigen::Vector3d((u + v) / std::sqrt(2.0))}) {
    // Compared with a segment too short to be seen, because the sine of the angle to the axis is there for any length.
    columns.push_back({point, point});
    columns.back().grown.lamp.shape = SegmentShape<>{length * axis, 0};
    columns.back().plain.lamp.shape = SegmentShape<>{1e-3 * length * axis, 0};  // as good as a point
  }
  const lobe::RadianceProblem::Probe found = problem.probe(point, columns);
  Eigen::Matrix2d moment;  // of the lamp, over the probe's
  moment << found.extra(0) + 0.5 * found.extra(2), 0.5 * found.extra(2), 0.5 * found.extra(2),
      found.extra(1) + 0.5 * found.extra(2);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(moment);
  if (!moment.allFinite() || !(eigen.eigenvalues()(1) > 0)) return {};
  Promise promise{found.gain};
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector2d axis = eigen.eigenvectors().col(1 - k);
    promise.halfAxes.col(k) =
        (axis(0) * u + axis(1) * v).normalized() * length * std::sqrt(std::max(0.0, eigen.eigenvalues()(1 - k)));
  }
  return promise;
}

/// The starts of a kind of lamp after short fits, best first, each minimum once. None that leads nowhere.
std::vector<Start> screened(const LampShape& kind, Lobe lobe, const std::vector<RadianceView>& views, const Light& light,
                            double widthRad, const std::optional<Promise>& promised, RadianceFitOptions options) {
  options.pointsPerView = std::min(options.pointsPerView, kAxisScreenPoints);
  options.maxIterations = std::min(options.maxIterations, kAxisScreenIterations);
  Outcome<lobe::ContourEvidence> gathered = lobe::gatherEvidence(views, options.pointsPerView);
  if (!gathered) return {};
  lobe::RadianceProblem problem(lobe, views, *std::move(gathered), options);
  lobe::State from = problem.start(light, 1);
  Eigen::Vector4d& centre = from.lamp.centre;
  if (!(centre.w() > 0))
    centre.w() = 0.3 * centre.head<3>().norm();  // at infinity a length has no meaning: some camera distances away
  centre.normalize();
  ExtentGuess guess{centre.head<3>().normalized(), centre.head<3>().norm() / centre.w(), {}};
  if (promised) guess.halfAxes = promised->halfAxes;
  std::vector<Start> starts;
  for (const LampShape& shape : startsOf(kind, guess))
    for (const double share : kStartWidths) {
      from.logRoughness = std::log(roughnessOf(lobe, share * widthRad, views.front().level));
      from.lamp.shape = shape;
      const lobe::Attempt a = problem.solve(from);
      if (!std::isfinite(a.cost) || !a.state.isFinite() || lobe::RadianceProblem::tooWide(a.state)) continue;
      if (problem.excess(a, lobe::kPoorShare) > lobe::kHopeless) continue;
      starts.push_back({problem.inWorld(a.state), a.state.roughness(), a.cost / problem.points(), a.state});
    }
  std::stable_sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
  if (starts.size() > kPromisingAxes) starts.resize(kPromisingAxes);
  std::vector<Start> different;
  for (const Start& s : starts)
    if (std::none_of(different.begin(), different.end(), [&](const Start& d) { return d.isNear(s); })) different.push_back(s);
  return different;
}

/// RMS residual of the views of every place under a fit to the others, px. Nothing where one of these fits fails.
std::vector<double> leftOutErrors(const RadianceFit& fit, const std::vector<RadianceView>& views, RadianceFitOptions options) {
  options.pointsPerView = std::min(options.pointsPerView, kLeftOutPoints);
  std::vector<double> errors;
  const std::vector<int> places = placesOf(views);
  for (int place = 0; place < countOf(places); ++place) {
    std::vector<RadianceView> others, left;
    for (std::size_t v = 0; v < views.size(); ++v) (places[v] == place ? left : others).push_back(views[v]);
    const Outcome<RadianceFit> without = fitLamp(fit.lobe, others, fit.lamp, fit.roughness, options);
    if (!without) return {};
    double sum = 0;
    for (const double rms : rmsOfViews(*without, left, options)) sum += rms * rms / double(left.size());
    errors.push_back(std::sqrt(sum));
  }
  return errors;
}

}  // namespace

std::optional<RadianceFit> fitExtended(const LampShape& kind, const std::vector<Lobe>& lobes,
                                       const std::vector<RadianceView>& views, const RadianceFit* plain, const Light& light,
                                       double widthRad, const RadianceFitOptions& options) {
  std::set<int> frames;
  for (const RadianceView& v : views) frames.insert(v.frame);
  if (frames.size() < kLeastFrames || (plain && plain->noiseOnly)) return std::nullopt;
  std::optional<Promise> promised;
  Light from = light;
  double width = widthRad;
  std::vector<Lobe> order = lobes;
  if (plain && !plain->poor) {
    // The promise is to first order, about the point light at the plain fit's place.
    Outcome<lobe::ContourEvidence> gathered = lobe::gatherEvidence(views, options.pointsPerView);
    if (!gathered) return std::nullopt;
    lobe::RadianceProblem problem(plain->lobe, views, *std::move(gathered), options);
    promised = gainByLength(problem, problem.start(plain->light(), plain->roughness));
    if (!(promised->gain > kExtentGain * plain->cost)) return std::nullopt;
    from = plain->light();
    width = widthOf(plain->lobe, plain->roughness, views.front().level);
    std::stable_partition(order.begin(), order.end(), [&](Lobe l) { return l == plain->lobe; });
  }
  std::optional<RadianceFit> best;
  const auto consider = [&](const Outcome<RadianceFit>& f) {
    if (f && (!best || f->cost < best->cost)) best = *f;
  };
  for (const Start& s : screened(kind, order.front(), views, from, width, promised, options)) {
    consider(fitLamp(order.front(), views, s.lamp, s.roughness, options));
    if (best && best->noiseOnly) break;
  }
  if (!best) return std::nullopt;
  const RadianceFit first = *best;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const double w = widthOf(first.lobe, first.roughness, views.front().level);
    consider(fitLamp(order[k], views, first.lamp, roughnessOf(order[k], w, views.front().level), options));
  }
  if (best->poor) return std::nullopt;
  if (!plain || plain->poor) return best->doubtful ? std::nullopt : best;
  if (!(best->cost < (1 - kExtentGain) * plain->cost)) return std::nullopt;
  return predictsLeftOutBetter(leftOutErrors(*best, views, options), leftOutErrors(*plain, views, options)) ? best : std::nullopt;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/reflectance/contour_evidence.h"
#include "core/reflectance/radiance_problem.h"

namespace glint {
namespace {

constexpr double kDoubtShare = 0.02;  // of the radius: a right lobe leaves less
constexpr double kSphereGain = 0.2;   // of the sum of squares: what a size must gain before it is believed
constexpr double kProbedSize = 0.4;   // of the lobe's width, as angles of the light: a smaller size would hardly show
// Other starts are judged by a short fit to few points; the most promising are then fitted in full.
constexpr int kScreenPoints = 16, kScreenIterations = 15;
constexpr std::size_t kPromising = 3;
constexpr double kSamePlace = 1e-2;  // of a unit vector L and of log m: far less than a basin is wide
// The peak of a wide lobe lies far from the mirror point, and the light that its reflection points to lies as far from the true
// one.
constexpr std::array<double, 2> kTilts{0.35, 0.8};  // rad
constexpr int kTiltedDirections = 6;

using lobe::Attempt;
using lobe::ContourEvidence;
using lobe::kPoorShare;
using lobe::RadianceProblem;
using lobe::State;

RadianceFit described(RadianceProblem& problem, const Attempt& a, std::size_t views, int iterations) {
  RadianceFit fit = problem.describe(a, views);
  fit.iterations = iterations;
  fit.poor = !problem.explains(a, kPoorShare);
  fit.doubtful = !problem.explains(a, kDoubtShare);
  fit.noiseOnly = problem.leavesNoiseOnly(a);
  return fit;
}

/// By how much the sum of squares, px^2, would fall to first order if a point became a sphere of some size; 0 where it would
/// rise.
double gainBySize(RadianceProblem& problem, const State& point) {
  if (point.atInfinity()) return 0;  // there a size has no meaning, only an angle
  State grown = point;
  grown.lamp.shape = SphereShape<>::of(point.lengthOf(kProbedSize));
  const RadianceProblem::Probe found = problem.probe(point, {{grown, point}});
  return found.extra(0) > 0 ? found.gain : 0;
}

Failure noMinimum(const RadianceProblem& problem, const Attempt& best, int iterations) {
  if (std::isfinite(best.cost)) return {Reason::NotConverged, "after " + std::to_string(iterations) + " iterations"};
  if (problem.lit() == 0) return {Reason::NoBrightestPoint, "no frame has a lit maximum"};
  return {Reason::NotConverged, ""};
}

}  // namespace

bool RadianceStart::promises() const { return excess <= lobe::kHopeless; }
bool RadianceStart::isNear(const RadianceStart& other) const {
  return lobe == other.lobe && (place - other.place).norm() < kSamePlace;
}

std::vector<RadianceStart> screenStarts(Lobe lobe, const std::vector<RadianceView>& views, const Light& light, double roughness,
                                        StartGrid grid, const RadianceFitOptions& options) {
  RadianceFitOptions quick = options;
  quick.pointsPerView = std::min(options.pointsPerView, kScreenPoints);
  quick.maxIterations = std::min(options.maxIterations, kScreenIterations);
  Outcome<ContourEvidence> gathered = lobe::gatherEvidence(views, quick.pointsPerView);
  if (!gathered) return {};
  RadianceProblem problem(lobe, views, *std::move(gathered), quick);
  const Eigen::Vector3d towards = problem.start(light, roughness).lamp.centre.head<3>().normalized();
  std::vector<RadianceStart> starts;
  const auto tryFrom = [&](const Eigen::Vector3d& direction, double distance, double width) {
    State from;
    from.lamp.centre << (distance > 0 ? Eigen::Vector3d(distance * direction) : direction), (distance > 0 ? 1.0 : 0.0);
    from.lamp.centre.normalize();
    from.logRoughness = std::log(std::min(width, 1.0));
    const Attempt a = problem.solve(from);
    if (!std::isfinite(a.cost) || !a.state.isFinite() || RadianceProblem::tooWide(a.state)) return;
    starts.push_back({lobe, lightOf(problem.inWorld(a.state)), a.state.roughness(), a.cost / double(problem.points()),
                      problem.excess(a, kPoorShare), a.state.place()});
  };
  if (grid == StartGrid::Distances) {
    for (const double distance : {0.5, 1.0, 2.0, 5.0, 0.0})
      for (const double factor : {1.0, 0.5, 2.0}) tryFrom(towards, distance, factor * roughness);
  } else {
    const Eigen::Vector3d u = towards.unitOrthogonal(), v = towards.cross(u);
    for (const double tilt : kTilts)
      for (int k = 0; k < kTiltedDirections; ++k) {
        const double a = 2 * M_PI * k / kTiltedDirections;
        tryFrom(std::cos(tilt) * towards + std::sin(tilt) * (std::cos(a) * u + std::sin(a) * v), 1.2, roughness);
      }
  }
  std::stable_sort(starts.begin(), starts.end(), [](const RadianceStart& a, const RadianceStart& b) { return a.cost < b.cost; });
  return starts;
}

Outcome<RadianceFit> fitRadiance(Lobe lobe, const std::vector<RadianceView>& views, const Light& light, double roughness,
                                 const RadianceFitOptions& options) {
  require(options.pointsPerView >= 3 && options.robustPx > 0 && options.maxIterations >= 1, "fitRadiance: options");
  require(roughness > 0 && std::isfinite(roughness), "fitRadiance: roughness must be positive");
  Outcome<ContourEvidence> gathered = lobe::gatherEvidence(views, options.pointsPerView);
  if (!gathered) return gathered.failure();
  RadianceProblem problem(lobe, views, *std::move(gathered), options);
  const auto good = [&](const Attempt& a) { return problem.explains(a, kPoorShare); };
  Attempt best = problem.solve(problem.start(light, roughness));
  int iterations = best.iterations;
  if (!good(best) && options.otherStarts) {
    std::vector<RadianceStart> starts = screenStarts(lobe, views, light, roughness, StartGrid::Distances, options);
    if (starts.size() > kPromising) starts.resize(kPromising);
    for (const RadianceStart& from : starts) {
      if (!from.promises()) continue;
      const Attempt other = problem.solve(problem.start(from.light, from.roughness));
      iterations += other.iterations;
      if (other.converged != best.converged ? other.converged : other.cost < best.cost) best = other;
      if (good(best)) break;
    }
  }
  if (!std::isfinite(best.cost) || !best.converged) return noMinimum(problem, best, iterations);
  // A size that the contours do not show would only take up noise. It must promise a clear gain, and then keep the promise.
  if (options.lightSize && good(best) && gainBySize(problem, best.state) > kSphereGain * best.cost) {
    // The width that is seen is that of light and lobe together. So the fit starts from a light narrower than the lobe, and from
    // a wider one.
    const Attempt point = best;
    for (const auto& [radius, width] : {std::pair{1.0, 0.9}, std::pair{1.6, 0.5}}) {
      State start = point.state;
      start.lamp.shape = SphereShape<>::of(point.state.lengthOf(radius));
      start.logRoughness += std::log(width);
      const Attempt sized = problem.solve(start);
      iterations += sized.iterations;
      if (sized.converged && sized.cost < (1 - kSphereGain) * point.cost && sized.cost < best.cost &&
          std::get<SphereShape<>>(sized.state.lamp.shape).squaredRadius > 2 * SphereShape<>::kLeast)
        best = sized;
      if (problem.leavesNoiseOnly(best)) break;
    }
  }
  return described(problem, best, views.size(), iterations);
}

Outcome<RadianceFit> fitLamp(Lobe lobe, const std::vector<RadianceView>& views, const Lamp& lamp, const Roughness& roughness,
                             const RadianceFitOptions& options) {
  require(options.pointsPerView >= 3 && options.robustPx > 0 && options.maxIterations >= 1, "fitLamp: options");
  require(roughness > 0 && std::isfinite(roughness.mean), "fitLamp: roughness must be positive");
  Outcome<ContourEvidence> gathered = lobe::gatherEvidence(views, options.pointsPerView);
  if (!gathered) return gathered.failure();
  RadianceProblem problem(lobe, views, *std::move(gathered), options);
  const Attempt found = problem.solve(problem.start(lamp, roughness));
  if (!std::isfinite(found.cost) || !found.converged) return noMinimum(problem, found, found.iterations);
  return described(problem, found, views.size(), found.iterations);
}

std::vector<double> rmsOfViews(const RadianceFit& fit, const std::vector<RadianceView>& views,
                               const RadianceFitOptions& options) {
  Outcome<ContourEvidence> gathered = lobe::gatherEvidence(views, options.pointsPerView);
  if (!gathered) return std::vector<double>(views.size(), std::numeric_limits<double>::quiet_NaN());
  RadianceProblem problem(fit.lobe, views, *std::move(gathered), options);
  return problem.rmsOfViews(problem.start(fit.lamp, fit.roughness), views.size());
}

}  // namespace glint

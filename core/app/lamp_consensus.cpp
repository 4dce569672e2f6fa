// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/lamp_consensus.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/number_text.h"
#include "core/base/numeric.h"

namespace glint {
namespace {

constexpr double kLeastPeakPx = 1e-3;  // no detection is better; a covariance of zero could not be inverted
constexpr double kContradiction = 4;   // standard deviations: normal noise reaches them once in 16000 lamps
constexpr double kLeastShare = 0.02;   // of the radius: two degrees and more of direction, beyond what a poor outline does
constexpr std::size_t kCrowd = 4;      // lamps that tell how large residuals usually are here
constexpr double kMedianOfChiSquared = 0.4549;  // of one degree of freedom
constexpr double kDoubtful = 2;                 // a place that detection set aside is known that many times worse

std::size_t ballsOf(const LampUnknowns& lamp) {
  std::set<std::size_t> balls;
  for (const WeightedPeak& p : lamp.peaks) balls.insert(p.ball);
  return balls.size();
}

/// Square of the factor by which residuals exceed what is promised, from the middle lamp.
double usualExcess(const LampProblem& problem, const std::vector<LampInFit>& lamps) {
  std::vector<double> shares;
  for (const LampInFit& lamp : lamps) {
    if (lamp.failure) continue;
    const Misfit m = misfitOf(problem, lamp.unknowns);
    if (m.degreesOfFreedom > 0) shares.push_back(m.chiSquared / m.degreesOfFreedom);
  }
  return shares.size() < kCrowd ? 1 : std::max(1.0, upperMedian(shares) / kMedianOfChiSquared);
}

class Doubts {
 public:
  Doubts(const LampProblem& problem, double excess, const std::function<Pixel(const Pixel&)>& ideal)
      : problem_(problem), excess_(excess), ideal_(ideal) {}

  bool contradicts(const LampInFit& lamp) const {
    if (lamp.failure || isLarge(misfitOf(problem_, lamp.unknowns), lamp)) return true;
    if (!lamp.unknowns.distanceFree || lamp.unknowns.lamp.inverseDistance >= 0) return false;
    // Rays that run apart meet in no lamp: what matters is how well a distant one explains them.
    const std::optional<LampUnknowns> distant = distantFrom(problem_, lamp.unknowns);
    return !distant || isLarge(misfitOf(problem_, *distant), lamp);
  }

  void settle(LampInFit& lamp) const {
    if (ballsOf(lamp.unknowns) > 2 && withoutOne(lamp)) return;
    if (withAnotherPlace(lamp)) return;
    const Misfit m = misfitOf(problem_, lamp.unknowns);
    std::string balls;
    for (std::size_t i = 0; i < lamp.sources.size(); ++i) {
      drop(lamp, i, "contradicts the other balls, or they contradict it");
      balls += (balls.empty() ? "" : ", ") + std::to_string(lamp.sources[i]->object + 1);
    }
    const std::string detail = formatted(
        "the highlights on balls %s contradict each other by %.3g px; one of them is not this lamp's", balls.c_str(), m.rmsPx);
    lamp.failure = Failure{Reason::NotConverged, detail};
  }

 private:
  double outlineRadius(std::size_t ball) const { return problem_.parametersOf(ball).z(); }

  bool isLarge(const Misfit& m, const LampInFit& lamp) const {
    double least = 0;
    for (const WeightedPeak& p : lamp.unknowns.peaks) {
      const double radius = outlineRadius(p.ball);
      least = least > 0 ? std::min(least, radius) : radius;
    }
    return m.degreesOfFreedom > 0 && m.chiSquared > kContradiction * kContradiction * excess_ * m.degreesOfFreedom &&
           m.rmsPx > kLeastShare * least;
  }

  static void drop(LampInFit& lamp, std::size_t i, const std::string& why) {
    lamp.dropped.push_back({lamp.frame, lamp.sources[i]->object, lamp.sources[i]->peak, why});
  }

  /// The one without which the others agree best.
  bool withoutOne(LampInFit& lamp) const {
    std::optional<LampInFit> best;
    double least = 0;
    for (std::size_t i = 0; i < lamp.sources.size(); ++i) {
      LampInFit rest = lamp;
      rest.unknowns.peaks.erase(rest.unknowns.peaks.begin() + static_cast<std::ptrdiff_t>(i));
      rest.sources.erase(rest.sources.begin() + static_cast<std::ptrdiff_t>(i));
      fitAlone(problem_, rest);
      if (rest.failure) continue;
      const double left = misfitOf(problem_, rest.unknowns).chiSquared;
      if (best && left >= least) continue;
      drop(rest, i, "");
      rest.dropped.back() = {lamp.frame, lamp.sources[i]->object, lamp.sources[i]->peak, "contradicts the other balls"};
      best = std::move(rest);
      least = left;
    }
    if (!best || contradicts(*best)) return false;
    lamp = *std::move(best);
    return true;
  }

  /// Another bright place of one ball that agrees with the other balls, where it is the only one.
  bool withAnotherPlace(LampInFit& lamp) const {
    std::optional<LampInFit> found;
    for (std::size_t i = 0; i < lamp.sources.size(); ++i)
      for (const DroppedHighlight& other : lamp.sources[i]->dropped) {
        LampInFit changed = lamp;
        changed.unknowns.peaks[i].peak = ideal_(other.place);
        changed.unknowns.peaks[i].root /= kDoubtful;
        if (!changed.unknowns.peaks[i].peak.allFinite()) continue;
        fitAlone(problem_, changed);
        if (contradicts(changed)) continue;
        if (found) return false;
        drop(changed, i, "contradicts the other balls; another bright place on this ball agrees with them");
        found = std::move(changed);
      }
    if (!found) return false;
    lamp = *std::move(found);
    return true;
  }

  const LampProblem& problem_;
  double excess_;
  const std::function<Pixel(const Pixel&)>& ideal_;
};

}  // namespace

WeightedPeak weightedPeak(const LampObservation& seen, const Pixel& ideal) {
  const Eigen::Matrix2d covariance = seen.covariance + kLeastPeakPx * kLeastPeakPx * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d root = covariance.llt().matrixL();
  return {seen.object, ideal, root.inverse()};
}

void fitAlone(const LampProblem& problem, LampInFit& lamp) {
  lamp.failure.reset();
  std::vector<MirrorRay> rays;
  for (const WeightedPeak& p : lamp.unknowns.peaks) {
    const Outcome<MirrorRay> ray = mirrorRay(problem.view(), problem.ball(p.ball), p.peak);
    if (!ray) {
      lamp.failure = ray.failure();
      return;
    }
    rays.push_back(*ray);
  }
  LampUnknowns& u = lamp.unknowns;
  const bool several = ballsOf(u) > 1 && problem.standApart(u);
  AimedLamp distant;
  distant.reference = u.lamp.reference;
  distant.direction.setZero();
  for (const MirrorRay& r : rays) distant.direction += r.direction;
  distant.direction.normalize();
  for (const bool finite : {true, false}) {
    if (finite && !several) continue;
    u.lamp = finite ? lampOfRays(rays, distant.reference, problem.scale()) : distant;
    u.distanceFree = false;
    u.distanceFree = several && problem.tellsDistance(u);
    std::vector<LampUnknowns> one{u};
    LampProblem same = problem;
    if (!same.solve(one, false)) continue;
    u = one.front();
    return;
  }
  lamp.failure = Failure{Reason::NotConverged, "no lamp explains its highlights"};
}

std::optional<LampUnknowns> distantFrom(const LampProblem& problem, const LampUnknowns& lamp) {
  std::vector<LampUnknowns> one{lamp};
  one.front().distanceFree = false;
  one.front().lamp.inverseDistance = 0;
  LampProblem same = problem;
  return same.solve(one, false) ? std::optional(one.front()) : std::nullopt;
}

Misfit misfitOf(const LampProblem& problem, const LampUnknowns& lamp) {
  Misfit m;
  const std::optional<Eigen::VectorXd> r = problem.residuals(lamp);
  if (!r) return m;
  m.chiSquared = r->squaredNorm();
  m.degreesOfFreedom = static_cast<int>(r->size() - lamp.count());
  double squares = 0;
  for (std::size_t i = 0; i < lamp.peaks.size(); ++i)
    squares += (lamp.peaks[i].root.inverse() * r->segment<2>(2 * static_cast<Eigen::Index>(i))).squaredNorm();
  m.rmsPx = std::sqrt(squares / static_cast<double>(lamp.peaks.size()));
  return m;
}

bool dropContradictions(const LampProblem& problem, std::vector<LampInFit>& lamps,
                        const std::function<Pixel(const Pixel&)>& ideal) {
  const Doubts doubts(problem, usualExcess(problem, lamps), ideal);
  bool changed = false;
  for (LampInFit& lamp : lamps) {
    if (lamp.failure || !doubts.contradicts(lamp)) continue;
    doubts.settle(lamp);
    changed = true;
  }
  return changed;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/bundle_attempt.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/numeric.h"

namespace glint::bundling {
namespace {

/// Direction to the light with N.L > 0, not normalised.
Eigen::Vector3d towards(const EvidencePoint& s, const Eigen::Vector4d& light) {
  const Eigen::Vector3d d = light.head<3>() - light.w() * s.position;
  return s.normal.dot(d) < 0 ? Eigen::Vector3d(-d) : d;
}
}  // namespace

double angle(const EvidencePoint& s, const Eigen::Vector4d& light) {
  return incidentAngle(s.normal, towards(s, light).normalized(), s.toCamera);
}

namespace {
double residual(const ContourEvidence& e, const Attempt& a, double incident) {
  const double limit =
      a.directed ? directedLimit(a.limit, symmetric(a.extent), e.at.position, e.at.normal, e.at.toCamera, a.light) : a.limit;
  return e.pixelsPerRadian * (incident - limit) - e.biasPx;
}
}  // namespace

double residual(const ContourEvidence& e, const Attempt& a) { return residual(e, a, angle(e.at, a.light)); }

namespace {
/// The incident angles at a contour point and at its neighbours under one light, rad; NaN where the surface ended.
struct AnglesAround {
  double here, left, right, up, down;
};
std::vector<AnglesAround> anglesAround(const std::vector<ContourEvidence>& points, const Eigen::Vector4d& light) {
  const auto of = [&](const std::optional<EvidencePoint>& s) { return s ? angle(*s, light) : std::nan(""); };
  std::vector<AnglesAround> angles;
  angles.reserve(points.size());
  for (const ContourEvidence& e : points) angles.push_back({angle(e.at, light), of(e.left), of(e.right), of(e.up), of(e.down)});
  return angles;
}

/// 1 / |d alpha / d pixel| of every point under the light of these angles.
void reweight(std::vector<ContourEvidence>& points, const std::vector<AnglesAround>& angles) {
  std::vector<double> slopes;
  slopes.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ContourEvidence& e = points[i];
    const AnglesAround& at = angles[i];
    const auto slope = [&](bool before, double low, bool after, double high) {
      return ((after ? high : at.here) - (before ? low : at.here)) /
             ((before ? ContourEvidence::kStepPx : 0) + (after ? ContourEvidence::kStepPx : 0));
    };
    slopes.push_back(std::hypot(slope(e.left.has_value(), at.left, e.right.has_value(), at.right),
                                slope(e.up.has_value(), at.up, e.down.has_value(), at.down)));
  }
  // Where the angle hardly changes over the image (a facet, a start far off) a pixel must not weigh without bound.
  const double floor = std::max(0.05 * upperMedian(slopes), 1e-12);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].pixelsPerRadian = 1 / std::max(slopes[i], floor);
}
}  // namespace

void reweight(std::vector<ContourEvidence>& points, const Eigen::Vector4d& light) {
  reweight(points, anglesAround(points, light));
}

double noiseShare(const std::vector<ContourEvidence>& points, const Attempt& a) {
  struct Member {
    Pixel pixel;
    double residual, azimuth = 0;
  };
  std::vector<double> sizes, steps;
  std::map<int, std::vector<Member>> views;
  for (const ContourEvidence& e : points) {
    const double r = residual(e, a);
    sizes.push_back(std::abs(r));
    views[e.view].push_back({e.pixel, r});
  }
  for (auto& [view, members] : views) {
    // Neighbours by their azimuth about the middle: a given contour may start anywhere and list its points in any order.
    Pixel middle(0, 0);
    for (const Member& m : members) middle += m.pixel / double(members.size());
    for (Member& m : members) m.azimuth = std::atan2(m.pixel.y() - middle.y(), m.pixel.x() - middle.x());
    std::sort(members.begin(), members.end(), [](const Member& x, const Member& y) { return x.azimuth < y.azimuth; });
    for (std::size_t i = 0; i < members.size(); ++i)
      steps.push_back(std::abs(members[i].residual - members[(i + 1) % members.size()].residual));
  }
  constexpr double kVisiblePx = 0.01;  // the effect goes with the square of the noise
  const double all = upperMedian(sizes);
  if (steps.size() < 5 || !(all > kVisiblePx)) return 0;
  return std::min(1.0, 0.5 * std::pow(upperMedian(steps) / all, 2));
}

ResidualSpread spreadOf(const std::vector<ContourEvidence>& points, const Attempt& a, int parameters, double scale) {
  std::vector<double> residuals;
  std::vector<int> views;
  for (const ContourEvidence& e : points) {
    residuals.push_back(residual(e, a));
    views.push_back(e.view);
  }
  return residualSpread(residuals, views, parameters, scale);
}

namespace {
/// Noise moves a measured point along a contour that bends away from it: isotropic noise of variance s^2 displaces the residual
/// by s^2 / 2 times the Laplacian of alpha on average, outwards. s is what the residuals show (their median, so that a few wild
/// points do not count), and the correction is kept below s / 2: it fades where the contour is as small as the noise. The slope,
/// taken at the noisy point, errs together with the residual: where alpha bends along its gradient g (alpha_gg) this displaces
/// the residual by -s^2 alpha_gg, and its product with its own derivative by as much again. `share` is the share of noise in s^2,
/// see noiseShare().
void unbias(std::vector<ContourEvidence>& points, const Attempt& a, double share, const std::vector<AnglesAround>& angles) {
  std::vector<double> sizes;
  for (std::size_t i = 0; i < points.size(); ++i) sizes.push_back(std::abs(residual(points[i], a, angles[i].here)));
  const double sigma = 1.4826 * upperMedian(sizes);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ContourEvidence& e = points[i];
    e.biasPx = 0;
    if (!e.left || !e.right || !e.up || !e.down) continue;
    const auto& [here, left, right, up, down] = angles[i];
    const double step2 = ContourEvidence::kStepPx * ContourEvidence::kStepPx;
    const double xx = (left + right - 2 * here) / step2, yy = (up + down - 2 * here) / step2;
    double bend = xx + yy;
    if (share > 0 && e.leftUp && e.rightUp && e.leftDown && e.rightDown) {
      const double falling = angle(*e.leftUp, a.light) + angle(*e.rightDown, a.light);
      const double rising = angle(*e.rightUp, a.light) + angle(*e.leftDown, a.light);
      const double xy = (falling - rising) / (4 * step2);
      const Eigen::Vector2d g = Eigen::Vector2d(right - left, down - up).normalized();
      if (g.allFinite()) bend -= 4 * share * (g.x() * g.x() * xx + g.y() * g.y() * yy + 2 * g.x() * g.y() * xy);
    }
    e.biasPx = 0.5 * sigma * std::clamp(sigma * bend * e.pixelsPerRadian, -1.0, 1.0);
  }
}

}  // namespace

void renew(std::vector<ContourEvidence>& points, const Attempt& a, double share) {
  const std::vector<AnglesAround> angles = anglesAround(points, a.light);
  reweight(points, angles);
  unbias(points, a, share, angles);
}

void keepBiases(const std::vector<ContourEvidence>& points, Attempt& a) {
  a.biasesPx.clear();
  for (const ContourEvidence& e : points) a.biasesPx.push_back(e.biasPx);
}
void restoreBiases(std::vector<ContourEvidence>& points, const Attempt& a) {
  for (std::size_t i = 0; i < points.size(); ++i) points[i].biasPx = a.biasesPx[i];
}

double robustCost(const std::vector<ContourEvidence>& points, const Attempt& a, double scale) {
  double sum = 0;
  for (const ContourEvidence& e : points) {
    const double r = std::abs(residual(e, a));
    sum += r <= scale ? r * r : scale * (2 * r - scale);
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

void settleSide(const std::vector<ContourEvidence>& points, Attempt& a) {
  if (a.light.w() < 0) a.light = -a.light;
  std::size_t behind = 0;
  for (const ContourEvidence& e : points) behind += e.at.normal.dot(a.light.head<3>() - a.light.w() * e.at.position) <= 0;
  if (a.light.w() == 0 && 2 * behind > points.size()) {  // a direction has no side of its own
    a.light.head<3>() *= -1;
    behind = points.size() - behind;
  }
  a.behind = 10 * behind > points.size();
}

}  // namespace glint::bundling

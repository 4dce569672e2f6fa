// SPDX-License-Identifier: BSD-3-Clause
#include "core/lamps/ball_outline.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/median.h"

namespace glint {
namespace {

constexpr double kSearchShare = 0.1;      // the start is right to a tenth of its radius
constexpr int kProfiles = 720;            // one for each half degree
constexpr double kLeastStep = 4;          // grey levels along the profile, over the noise of a JPEG
constexpr int kRounds = 20;               // of reweighting; three to five are usual
constexpr double kTukey = 4.685;          // 95 % as good as least squares under normal noise
constexpr std::size_t kLeastPoints = 30;  // ten for each parameter
constexpr double kFloorPx = 0.05;         // no edge of a photograph is known better

/// Mean of all photographs and channels at a place between pixels; nothing outside.
double greyAt(std::span<const Image> photographs, double x, double y) {
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const double u = x - x0, v = y - y0;
  double sum = 0;
  for (const Image& p : photographs)
    for (int c = 0; c < p.channels; ++c)
      sum += (1 - v) * ((1 - u) * p.at(x0, y0, c) + u * p.at(x0 + 1, y0, c)) +
             v * ((1 - u) * p.at(x0, y0 + 1, c) + u * p.at(x0 + 1, y0 + 1, c));
  return sum / static_cast<double>(photographs.size() * photographs[0].channels);
}

/// The steepest step along one profile.
std::vector<EdgePoint> edgePoints(std::span<const Image> photographs, const BallOutline& start) {
  std::vector<EdgePoint> points;
  const int reach = std::max(3, static_cast<int>(kSearchShare * start.radius));
  std::vector<double> value(2 * reach + 1);
  for (int k = 0; k < kProfiles; ++k) {
    const double angle = 2 * std::numbers::pi * k / kProfiles;
    const Eigen::Vector2d outwards(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d first = start.centre + (start.radius - reach) * outwards,
                          last = start.centre + (start.radius + reach) * outwards;
    const auto inside = [&](const Eigen::Vector2d& p) {
      return p.x() >= 0 && p.y() >= 0 && p.x() < photographs[0].width - 1 && p.y() < photographs[0].height - 1;
    };
    if (!inside(first) || !inside(last)) continue;
    for (int i = 0; i <= 2 * reach; ++i) {
      const Eigen::Vector2d p = first + i * outwards;
      value[i] = greyAt(photographs, p.x(), p.y());
    }
    int best = 0;
    double steepest = 0;
    const auto step = [&](int i) { return std::abs(value[i + 1] - value[i - 1]); };
    for (int i = 2; i + 2 <= 2 * reach; ++i)
      if (step(i) > steepest) steepest = step(best = i);
    if (steepest < kLeastStep) continue;
    const double before = step(best - 1), after = best + 2 <= 2 * reach ? step(best + 1) : before;
    const double bend = before - 2 * steepest + after;
    const double shift = bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
    points.push_back({first + (best + shift) * outwards, 1.0});
  }
  return points;
}

}  // namespace

Outcome<RefinedOutline> refineBallOutline(std::span<const Image> photographs, const Eigen::Vector2d& corner,
                                          const BallOutline& start) {
  require(!photographs.empty() && start.radius > 0, "refineBallOutline: no photograph or no radius");
  std::vector<EdgePoint> points = edgePoints(photographs, {start.centre - corner, start.radius});
  if (points.size() < kLeastPoints) return Failure{Reason::TooFewPoints, "the ball has no outline to see there"};
  Eigen::Vector3d circle(start.centre.x() - corner.x(), start.centre.y() - corner.y(), start.radius);
  double scale = 0;
  Eigen::Matrix3d normal;
  double weightSum = 0, squares = 0;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> absolute;
    for (const EdgePoint& p : points) absolute.push_back(std::abs((p.place - circle.head<2>()).norm() - circle[2]));
    scale = std::max(kFloorPx, 1.4826 * upperMedian(absolute));
    normal.setZero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    weightSum = squares = 0;
    for (const EdgePoint& p : points) {
      const Eigen::Vector2d d = p.place - circle.head<2>();
      const double r = d.norm(), residual = r - circle[2], t = residual / (kTukey * scale);
      if (std::abs(t) >= 1) continue;
      const double w = (1 - t * t) * (1 - t * t);
      const Eigen::Vector3d row(d.x() / r, d.y() / r, 1);
      normal += w * row * row.transpose();
      right += w * residual * row;
      weightSum += w;
      squares += w * residual * residual;
    }
    circle += normal.ldlt().solve(right);
  }
  if (!circle.allFinite() || circle[2] <= 0) return Failure{Reason::NotConverged, "no circle passes through the edge points"};
  RefinedOutline result;
  result.outline = {circle.head<2>() + corner, circle[2]};
  result.residualPx = std::sqrt(squares / weightSum);
  result.covariance = std::max(scale * scale, squares / weightSum) * normal.inverse();
  for (const EdgePoint& p : points)
    if (std::abs((p.place - circle.head<2>()).norm() - circle[2]) < kTukey * scale)
      result.edge.push_back({p.place + corner, scale});
  result.degreesOfFreedom = static_cast<int>(result.edge.size()) - 3;
  return result;
}

}  // namespace glint

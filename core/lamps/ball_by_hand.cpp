// SPDX-License-Identifier: BSD-3-Clause
#include "core/lamps/ball_by_hand.h"

#include <Eigen/LU>

namespace glint {

namespace {
constexpr double kLargest = 1e6;  // of the points' distance: beyond, the last digits of the points decide
}

Outcome<BallOutline> circleThrough(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  if (!a.allFinite() || !b.allFinite() || !c.allFinite()) return Failure{Reason::NotFinite, "a point of the rim"};
  // 2 (p - a) . x = |p - a|^2 for the other two points, x from a.
  Eigen::Matrix2d rows;
  rows << (b - a).transpose(), (c - a).transpose();
  const double size = rows.norm();
  const Eigen::Vector2d squares = rows.rowwise().squaredNorm();
  if (!(size > 0) || !(kLargest * std::abs(rows.determinant()) > size * size))
    return Failure{Reason::RankDeficient, "the three points lie on a line"};
  const Eigen::Vector2d x = rows.inverse() * (0.5 * squares);
  return BallOutline{a + x, x.norm()};
}

}  // namespace glint

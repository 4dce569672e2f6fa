// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/model/reconstruct_detail.h"

namespace glint {

EllipseFoot footOnEllipse(const Ellipse& ellipse, const Pixel& p) {
  const double a = ellipse.semiAxes.x(), b = ellipse.semiAxes.y();
  const Eigen::Vector2d major(std::cos(ellipse.angle), std::sin(ellipse.angle)), minor(-major.y(), major.x());
  const Eigen::Vector2d local((p - ellipse.centre).dot(major), (p - ellipse.centre).dot(minor));
  const double x = std::abs(local.x()), y = std::abs(local.y());
  Eigen::Vector2d foot;
  if (y > 0) {
    const double ratio = (a / b) * (a / b), zx = x / a, zy = y / b;
    // Root of (ratio zx / (s + ratio))^2 + (zy / (s + 1))^2 = 1, convex and falling on s > -1; both starts lie left of it.
    double s = std::max(zy - 1, ratio * (zx - 1));
    for (int i = 0; i < 200; ++i) {
      const double u = ratio * zx / (s + ratio), v = zy / (s + 1);
      const double step = (u * u + v * v - 1) / (2 * (u * u / (s + ratio) + v * v / (s + 1)));
      const double next = s + step;
      if (!(next > s)) break;
      s = next;
    }
    foot << ratio * x / (s + ratio), y / (s + 1);
  } else {
    const double numerator = a * x, denominator = a * a - b * b;
    if (numerator < denominator) {
      const double t = numerator / denominator;
      foot << a * t, b * std::sqrt(1 - t * t);
    } else {
      foot << a, 0;
    }
  }
  const Eigen::Vector2d signs(local.x() < 0 ? -1 : 1, local.y() < 0 ? -1 : 1);
  foot = foot.cwiseProduct(signs);
  const Eigen::Vector2d normal = Eigen::Vector2d(foot.x() * (b / a), foot.y() * (a / b)).normalized();
  EllipseFoot result;
  result.distance = normal.dot(local - foot);
  result.point = ellipse.centre + foot.x() * major + foot.y() * minor;
  result.normal = normal.x() * major + normal.y() * minor;
  return result;
}

}  // namespace glint

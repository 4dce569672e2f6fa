// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/star.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace glint {
namespace {

// Chords of 36 directions cost 0.13 % of the diameter on a circle; 288 cost 0.002 %.
constexpr int kVertices = 288, kSubdivisions = 8;  // at most that many between two directions
constexpr int kStencil = 6;  // points of the interpolating polynomial: its error is below the walk's other errors

/// Weights of the polynomial through `count` equally spaced points, at `at` steps after the first one.
std::array<double, kStencil> weights(int count, double at) {
  std::array<double, kStencil> w{};
  for (int a = 0; a < count; ++a) {
    w[a] = 1;
    for (int b = 0; b < count; ++b)
      if (b != a) w[a] *= (at - b) / double(a - b);
  }
  return w;
}

using Table = std::array<std::array<double, kStencil>, kSubdivisions>;

/// The weights of a full stencil around a chord, for each of `parts` subdivisions: nearly all chords use these.
const Table& centredWeights(int parts) {
  static const auto tables = [] {
    std::array<Table, kSubdivisions + 1> t{};
    for (int of = 1; of <= kSubdivisions; ++of)
      for (int k = 0; k < of; ++k) t[of][k] = weights(kStencil, (kStencil - 1) / 2 + double(k) / of);
    return t;
  }();
  return tables[parts];
}

}  // namespace

void outlineOf(const CanonicalContour& c, PredictedHighlight& h) {
  const int n = static_cast<int>(c.directions.size());
  std::vector<Pixel> pixelOf(n, Pixel(0, 0));
  std::vector<char> ok(n, 0);
  for (int i = 0, k = 0; i < n; ++i)
    if (!c.directions[i].failure) ok[i] = 1, pixelOf[i] = c.pixels[k++];
  const bool all = static_cast<int>(c.pixels.size()) == n;
  const auto isOk = [&](int i) { return all || ok[(i % n + n) % n] != 0; };
  h.coverage = n ? double(c.pixels.size()) / n : 0;
  h.contour = Polyline{{}, true};
  const int parts = std::clamp(kVertices / std::max(1, n), 1, kSubdivisions);
  const Table& centredOnes = centredWeights(parts);
  h.contour.points.reserve(static_cast<std::size_t>(n) * parts);
  for (int i = 0; i < n; ++i) {
    if (!ok[i]) continue;
    h.contour.points.push_back(pixelOf[i]);
    if (!isOk(i + 1)) {
      h.gaps.emplace_back(static_cast<int>(h.contour.points.size()) - 1, static_cast<int>(h.contour.points.size()));
      continue;
    }
    int first = i, last = i + 1;  // grow the stencil evenly within the run
    while (last - first + 1 < std::min(kStencil, n)) {
      const bool left = isOk(first - 1), right = isOk(last + 1);
      if (!left && !right) break;
      if (left && (!right || i - first <= last - i - 1))
        --first;
      else
        ++last;
    }
    const int count = last - first + 1;
    const bool centred = count == kStencil && i - first == (kStencil - 1) / 2;
    double x[kStencil], y[kStencil];
    for (int a = 0, j = (first + n) % n; a < count; ++a, j = j + 1 < n ? j + 1 : 0) x[a] = pixelOf[j].x(), y[a] = pixelOf[j].y();
    for (int k = 1; k < parts; ++k) {
      const std::array<double, kStencil> w = centred ? centredOnes[k] : weights(count, i - first + double(k) / parts);
      double sumX = 0, sumY = 0;
      if (centred)  // of known length
        for (int a = 0; a < kStencil; ++a) sumX += w[a] * x[a], sumY += w[a] * y[a];
      else
        for (int a = 0; a < count; ++a) sumX += w[a] * x[a], sumY += w[a] * y[a];
      h.contour.points.emplace_back(sumX, sumY);
    }
  }
  // The last gap closes on the first vertex.
  const int count = static_cast<int>(h.contour.points.size());
  for (auto& [from, to] : h.gaps) to %= std::max(1, count);
}

CanonicalContour starContour(const TangentWalk& walk, const Surface& surface, const Camera& camera, double limit, int n) {
  require(n >= 1, "starContour: needs directions");
  CanonicalContour result;
  result.directions.resize(n);
  const Eigen::Vector3d origin = walk.brightest().point.position;
  std::vector<SurfacePoint> ends(n);
  // To first order the level set is the ellipse |J x| = limit. Directions are taken at equal steps of its parameter: the curve is
  // then close to one harmonic of it, so that few directions and the interpolation between them suffice also where it is long.
  const Eigen::Matrix2d rate = walk.angularRate();
  const double size = rate.norm(), determinant = rate.determinant();
  Eigen::Matrix2d ellipse = Eigen::Matrix2d::Identity() * (limit / size);
  // Beyond an axis ratio of 100 (a fold) the second order matters more than this ellipse.
  if (std::abs(determinant) > 1e-2 * size * size) ellipse = limit * rate.inverse();
  if (ellipse.determinant() < 0) ellipse.col(1) = -ellipse.col(1);  // azimuths turn the same way as everywhere
  ReachGuess guess;                                                 // reach over its first order
  SurfacePoint neighbour;
  for (int i = 0; i < n; ++i) {
    DirectionResult& r = result.directions[i];
    const double t = 2 * std::numbers::pi * i / n;
    const Eigen::Vector2d first = ellipse * Eigen::Vector2d(std::cos(t), std::sin(t));
    const double reachToFirstOrder = first.norm();
    r.azimuth = std::atan2(first.y(), first.x());
    const Eigen::Vector3d v = walk.direction(r.azimuth);
    if (!std::isfinite(reachToFirstOrder) || !(reachToFirstOrder > 0)) {
      r.failure = Failure{Reason::NotReached, "alpha does not grow"};
      continue;
    }
    const double ratio = guess.next(), expected = ratio * reachToFirstOrder;
    const bool follow = guess.known() && ratio > 0.02 && ratio < 50;
    const Outcome<TangentWalk::Reach> reach =
        follow ? walk.reachNear(v, limit, expected, neighbour, 0.45 * expected)
               : walk.reachOnSurface(v, limit, 0.45 * std::clamp(ratio, 0.02, 50.0) * reachToFirstOrder);
    if (!reach) {
      r.failure = reach.failure();
      guess.interrupt();
      continue;
    }
    guess.add(reach->distance / reachToFirstOrder);
    neighbour = reach->point;
    r.onTangentPlane = origin + reach->distance * v;
    r.limitAngle = limit;
    ends[i] = reach->point;
  }
  keepVisible(result, ends, surface, camera);
  return result;
}

double curvatureVariation(const LocalQuadric& patch, const Surface& surface, const CanonicalContour& walked) {
  const int n = static_cast<int>(walked.directions.size());
  double largest = 0;
  for (int k = 0; k < 4; ++k) {
    const DirectionResult& d = walked.directions[(3 * k * n / 8) % n];
    if (d.failure || !d.limitAngle || !(*d.limitAngle > 0)) continue;
    const SurfacePoint& at = patch.origin();
    const Outcome<SurfacePoint> onPatch = patch.foot(d.onSurface, at.normal, at),
                                exact = surface.foot(d.onSurface, at.normal, at);
    if (!onPatch || !exact) return 1;
    Eigen::Vector3d n1 = exact->normal;
    if (n1.dot(onPatch->normal) < 0) n1 = -n1;
    largest = std::max(largest, std::atan2(n1.cross(onPatch->normal).norm(), n1.dot(onPatch->normal)) / *d.limitAngle);
  }
  return std::min(largest, 1.0);
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/shared_lamp.h"

#include <algorithm>
#include <cmath>

#include "core/base/numeric.h"

namespace glint {
namespace {

using Views = std::vector<std::vector<ReflectedRay>>;

double missOf(const ReflectedRay& r, const Light& light) {
  const Eigen::Vector3d toLamp = light.directionFrom(r.origin);
  return std::acos(std::clamp(r.direction.dot(toLamp), -1.0, 1.0));
}

SharedLamp judged(const Views& views, const Light& light) {
  SharedLamp lamp{light, {}, {}, 0};
  for (const std::vector<ReflectedRay>& rays : views) {
    int best = -1;
    double least = EIGEN_PI;
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (const double miss = missOf(rays[i], light); miss < least) {
        least = miss;
        best = static_cast<int>(i);
      }
    lamp.chosen.push_back(best);
    lamp.misses.push_back(least);
  }
  std::vector<double> misses = lamp.misses;
  lamp.miss = ranked(misses, 3 * (misses.size() - 1) / 4);
  return lamp;
}

/// Halfway between the nearest points of two rays; nothing behind their origins, or if they are parallel.
std::optional<Light> between(const ReflectedRay& a, const ReflectedRay& b) {
  const Eigen::Vector3d apart = b.origin - a.origin;
  const double c = a.direction.dot(b.direction), across = 1 - c * c;
  constexpr double kParallel = 1e-8;  // the square of a sine: rays of one direction to round-off meet nowhere
  if (!(across > kParallel)) return std::nullopt;
  const double p = apart.dot(a.direction), q = apart.dot(b.direction);
  const double s = (p - c * q) / across, t = (c * p - q) / across;
  if (!(s > 0) || !(t > 0)) return std::nullopt;
  return Light::at((a.origin + s * a.direction + b.origin + t * b.direction) / 2);
}

/// The same lamp placed by all views that agree with it.
std::optional<Light> ofThoseThatAgree(const Views& views, const SharedLamp& lamp) {
  std::vector<ReflectedRay> rays;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (lamp.chosen[v] < 0) continue;
    const ReflectedRay& r = views[v][static_cast<std::size_t>(lamp.chosen[v])];
    if (lamp.misses[v] <= lamp.miss) rays.push_back(r);
  }
  const Outcome<Triangulation> placed = triangulateLight(rays);
  return placed ? std::optional(placed->light) : std::nullopt;
}

}  // namespace

std::optional<SharedLamp> sharedLamp(const Views& views) {
  std::optional<SharedLamp> best;
  const auto consider = [&](const std::optional<Light>& light) {
    if (!light) return;
    SharedLamp lamp = judged(views, *light);
    if (!best || lamp.miss < best->miss) best = std::move(lamp);
  };
  std::size_t seeing = 0;
  for (std::size_t a = 0; a < views.size(); ++a) {
    seeing += !views[a].empty();
    for (const ReflectedRay& r : views[a]) {
      consider(Light::towards(r.direction));
      for (std::size_t b = 0; b < a; ++b)
        for (const ReflectedRay& other : views[b]) consider(between(r, other));
    }
  }
  if (seeing < 2) return std::nullopt;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds && best; ++round) consider(ofThoseThatAgree(views, *best));
  return best;
}

double squaredMiss(const std::optional<SharedLamp>& lamp) {
  if (!lamp) return EIGEN_PI * EIGEN_PI;
  std::vector<double> misses = lamp->misses;
  std::sort(misses.begin(), misses.end());
  const std::size_t n = (3 * misses.size() + 3) / 4;
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += misses[i] * misses[i] / double(n);
  return sum;
}

}  // namespace glint

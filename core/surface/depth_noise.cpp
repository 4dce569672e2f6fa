// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/depth_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/base/outcome.h"

namespace glint {
namespace {

constexpr double kDisparityPerInverse = 351.3;  // px m: focal length times baseline of the device, as published
constexpr double kDisparitySigma = 1.0 / 6;     // px, published
constexpr double kShufflePx = 0.5;              // published: standard deviation of where a pixel's depth is taken from
constexpr int kEdgePx = 2;                      // projector and camera look from two places: at edges one of them is hidden
constexpr double kEdgeJump = 0.05;              // of the depth, as where a depth map is cut
constexpr double kLost = 0.5;                   // of the pixels at edges: about what a real map shows there

/// Standard normal by Box and Muller, so that every standard library gives the same numbers.
double normal(std::mt19937& random) {
  constexpr double kSteps = 4294967296.0;  // 2^32, the values of the generator
  const double u = (random() + 1.0) / kSteps, v = random() / kSteps;
  return std::sqrt(-2 * std::log(std::min(1.0, u))) * std::cos(2 * std::numbers::pi * v);
}

bool atEdge(const Image& depth, int x, int y) {
  const float z = depth.at(x, y);
  for (int j = std::max(0, y - kEdgePx); j <= std::min(depth.height - 1, y + kEdgePx); ++j)
    for (int i = std::max(0, x - kEdgePx); i <= std::min(depth.width - 1, x + kEdgePx); ++i) {
      const float n = depth.at(i, j);
      if (!(n > 0) || std::abs(n - z) > kEdgeJump * std::min(n, z)) return true;
    }
  return false;
}

}  // namespace

void addKinectNoise(Image& depth, double times, unsigned seed) {
  require(depth.channels == 1, "depth noise: one channel expected");
  require(std::isfinite(times) && times >= 0, "depth noise: the factor must be finite and not negative");
  if (times == 0) return;
  const Image exact = depth;
  std::mt19937 random(seed);
  const double perInverse = kDisparityPerInverse / times, shuffle = kShufflePx * std::min(1.0, times);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      // All numbers are drawn for every pixel, so that one pixel's depth does not change another one's noise.
      const double dx = shuffle * normal(random), dy = shuffle * normal(random), error = kDisparitySigma * normal(random);
      const bool drawn = random() < kLost * 4294967296.0;
      if (!(exact.at(x, y) > 0) || !std::isfinite(exact.at(x, y))) continue;
      const int i = std::clamp(x + int(std::lround(dx)), 0, depth.width - 1);
      const int j = std::clamp(y + int(std::lround(dy)), 0, depth.height - 1);
      const float from = exact.at(i, j);
      const double z = from > 0 && std::isfinite(from) ? from : exact.at(x, y);
      const double disparity = std::floor(perInverse / z + error + 0.5);
      depth.at(x, y) = disparity > 0 && !(drawn && atEdge(exact, x, y)) ? static_cast<float>(perInverse / disparity) : 0.f;
    }
}

}  // namespace glint

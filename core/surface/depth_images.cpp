// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/depth_images.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

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

namespace {

/// A depth pixel in the other camera: measured pixel and inverse depth. Inverse depth 0 = none.
struct Moved {
  Pixel at{0, 0};
  double inverse = 0, own = 0;  ///< own: depth in the depth camera
};

std::vector<Moved> movedPixels(const Image& depth, const Camera& depthCamera, const Camera& camera) {
  std::vector<Moved> moved(depth.data.size());
  const Eigen::Isometry3d cameraFromDepth = depthCamera.camFromWorld.inverse();
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const double z = depth.at(x, y);
      if (!(std::isfinite(z) && z > 0)) continue;
      const Eigen::Vector3d ray =
          depthCamera.pixelFromRay.triangularView<Eigen::Upper>().solve(depthCamera.undistorted(Pixel(x, y)).homogeneous());
      const Eigen::Vector3d p = cameraFromDepth * Eigen::Vector3d(z / ray.z() * ray);
      if (!p.allFinite() || !(p.z() > 0)) continue;
      const Pixel at = camera.distorted((camera.pixelFromRay * p).hnormalized());
      if (at.allFinite()) moved[static_cast<std::size_t>(y) * depth.width + x] = {at, 1 / p.z(), z};
    }
  return moved;
}

/// Inverse depth is linear in the image; the largest is in front.
void draw(const std::array<Moved, 3>& t, std::vector<double>& inverse, int width, int height) {
  const Eigen::Vector2d e1 = t[1].at - t[0].at, e2 = t[2].at - t[0].at;
  const double area = e1.x() * e2.y() - e1.y() * e2.x();
  constexpr double kLeastArea = 1e-12;  // px^2: seen edge-on
  if (!(std::abs(area) > kLeastArea)) return;
  const auto within = [](double v, int size) { return static_cast<int>(std::clamp(v, -1.0, double(size))); };
  const double lowX = std::min({t[0].at.x(), t[1].at.x(), t[2].at.x()}),
               highX = std::max({t[0].at.x(), t[1].at.x(), t[2].at.x()});
  const double lowY = std::min({t[0].at.y(), t[1].at.y(), t[2].at.y()}),
               highY = std::max({t[0].at.y(), t[1].at.y(), t[2].at.y()});
  constexpr double kEdge = -1e-9;  // a pixel on the edge of two triangles belongs to both
  for (int y = std::max(0, within(std::ceil(lowY), height)); y <= std::min(height - 1, within(std::floor(highY), height)); ++y)
    for (int x = std::max(0, within(std::ceil(lowX), width)); x <= std::min(width - 1, within(std::floor(highX), width)); ++x) {
      const Eigen::Vector2d d = Pixel(x, y) - t[0].at;
      const double u = (d.x() * e2.y() - d.y() * e2.x()) / area, v = (e1.x() * d.y() - e1.y() * d.x()) / area;
      if (u < kEdge || v < kEdge || u + v > 1 - kEdge) continue;
      double& here = inverse[static_cast<std::size_t>(y) * width + x];
      here = std::max(here, (1 - u - v) * t[0].inverse + u * t[1].inverse + v * t[2].inverse);
    }
}

}  // namespace

Image registeredDepth(const Image& depth, const Camera& depthCamera, const Camera& camera, double jump) {
  require(depth.channels == 1 && depth.width == depthCamera.width && depth.height == depthCamera.height,
          "registeredDepth: one channel of the depth camera's size expected");
  require(jump > 0, "registeredDepth: the jump must be positive");
  const std::vector<Moved> moved = movedPixels(depth, depthCamera, camera);
  std::vector<double> inverse(static_cast<std::size_t>(camera.width) * camera.height, 0);
  for (int y = 0; y + 1 < depth.height; ++y)
    for (int x = 0; x + 1 < depth.width; ++x) {
      const std::size_t n = static_cast<std::size_t>(y) * depth.width + x;
      const std::array<Moved, 4> cell{moved[n], moved[n + 1], moved[n + depth.width], moved[n + depth.width + 1]};
      const auto drawn = [&](int a, int b, int c) {
        const std::array<Moved, 3> t{cell[a], cell[b], cell[c]};
        double least = std::numeric_limits<double>::infinity(), most = 0;
        for (const Moved& m : t) {
          if (!(m.inverse > 0)) return;
          least = std::min(least, m.own), most = std::max(most, m.own);
        }
        if (most - least <= jump * least) draw(t, inverse, camera.width, camera.height);
      };
      if (cell[0].inverse > 0 && cell[3].inverse > 0) {
        drawn(0, 2, 3);
        drawn(0, 3, 1);
      } else {
        drawn(0, 2, 1);
        drawn(1, 2, 3);
      }
    }
  Image result(camera.width, camera.height, 1);
  for (std::size_t i = 0; i < inverse.size(); ++i) result.data[i] = inverse[i] > 0 ? static_cast<float>(1 / inverse[i]) : 0.f;
  return result;
}

}  // namespace glint

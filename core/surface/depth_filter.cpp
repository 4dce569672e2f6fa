// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/depth_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "core/base/median.h"
#include "core/base/outcome.h"
#include "core/base/parallel.h"

namespace glint {

double medianDepth(const Image& depth) {
  std::vector<float> values;
  for (const float z : depth.data)
    if (std::isfinite(z) && z > 0) values.push_back(z);
  if (values.empty()) return 1;
  return upperMedian(std::move(values));
}

SmoothDepth bilateralDepth(const Image& depth, const Camera& camera, double radius) {
  require(depth.channels == 1 && radius > 0, "bilateralDepth: one channel and a positive radius expected");
  const double median = medianDepth(depth);
  const double sigmaPx = 0.5 * radius * camera.pixelFromRay(0, 0) / median;
  const double sigmaInverse = 0.5 * radius / (median * median);
  // Pixels without depth count as infinitely far: their inverse is so different that their weight vanishes.
  cv::Mat1f inverse(depth.height, depth.width, 0.f), smooth;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      if (depth.at(x, y) > 0) inverse(y, x) = 1.f / depth.at(x, y);
  constexpr double kSmallestPx = 0.5, kLargestPx = 12;  // OpenCV's time grows with the square
  cv::bilateralFilter(inverse, smooth, 0, sigmaInverse, std::clamp(sigmaPx, kSmallestPx, kLargestPx));
  SmoothDepth result{depth, {}};
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      if (depth.at(x, y) > 0 && smooth(y, x) > 0) result.depth.at(x, y) = 1.f / smooth(y, x);
  return result;
}

namespace {

constexpr int kTerms = 6, kMoments = 15;
constexpr int kLargestReachPx = 16;   // farther ones are sampled more coarsely: there are enough of them
constexpr int kLeastQuadratic = 18;   // neighbours: three for each term
constexpr int kLeastLinear = 9;       // the same for the three of a plane
constexpr double kRidge = 1e-6;       // of the moments, against terms that the neighbours do not determine
constexpr double kLeastPivot = 1e-9;  // of the largest: below it is round-off

struct LocalFit {
  double inverse = 0, byX = 0, byY = 0;  ///< per pixel
};

/// Weighted sums about one pixel: sum of w x^i y^j for i + j <= 4, and of w v x^i y^j for i + j <= 2; x, y in units of the reach.
struct Sums {
  double moment[kMoments] = {}, right[kTerms] = {};
  int count = 0;

  void add(double x, double y, double v, double w) {
    const double wx = w * x, wy = w * y, wxx = wx * x, wxy = wx * y, wyy = wy * y;
    const double terms[kMoments] = {w,       wx,      wy,          wxx,         wxy,         wyy,         wxx * x,    wxx * y,
                                    wxy * y, wyy * y, wxx * x * x, wxx * x * y, wxx * y * y, wxy * y * y, wyy * y * y};
    for (int k = 0; k < kMoments; ++k) moment[k] += terms[k];
    for (int k = 0; k < kTerms; ++k) right[k] += terms[k] * v;
    ++count;
  }

  template <int N>
  std::optional<LocalFit> solve(double reach) const {
    // Which moment stands where: exponents of the terms 1, x, y, x^2, x y, y^2 added.
    static constexpr int kPlace[kTerms][kTerms] = {{0, 1, 2, 3, 4, 5},    {1, 3, 4, 6, 7, 8},    {2, 4, 5, 7, 8, 9},
                                                   {3, 6, 7, 10, 11, 12}, {4, 7, 8, 11, 12, 13}, {5, 8, 9, 12, 13, 14}};
    Eigen::Matrix<double, N, N> a;
    Eigen::Matrix<double, N, 1> b;
    for (int i = 0; i < N; ++i) {
      b(i) = right[i];
      for (int j = 0; j < N; ++j) a(i, j) = moment[kPlace[i][j]];
    }
    a.diagonal().array() += kRidge * moment[0];
    a(0, 0) -= kRidge * moment[0];  // the value itself is not drawn to 0
    const Eigen::LDLT<Eigen::Matrix<double, N, N>> ldlt(a);
    const Eigen::Matrix<double, N, 1> pivots = ldlt.vectorD();
    if (!(pivots.minCoeff() > kLeastPivot * pivots.maxCoeff())) return std::nullopt;
    const Eigen::Matrix<double, N, 1> c = ldlt.solve(b);
    if (!c.allFinite()) return std::nullopt;
    return LocalFit{c(0), c(1) / reach, c(2) / reach};
  }
};

/// One round of fits over a whole map.
class Fitter {
 public:
  /// @param shape  the depth that says which pixels lie in a ball: measured, or from the round before
  Fitter(const Image& measured, const Image& shape, const Camera& camera, double radius)
      : measured_(measured), shape_(shape), fx_(camera.pixelFromRay(0, 0)), fy_(camera.pixelFromRay(1, 1)), radius_(radius) {}

  std::optional<LocalFit> at(int x, int y) const {
    const double z = shape_.at(x, y);
    const int reachX = std::max(2, int(radius_ * fx_ / z)), reachY = std::max(2, int(radius_ * fy_ / z));
    const int step = (std::max(reachX, reachY) + kLargestReachPx - 1) / kLargestReachPx;
    const double reach = std::max(reachX, reachY), ball = 1 / (radius_ * radius_), perX = z / fx_, perY = z / fy_;
    const double centre = 1 / z;  // values about it keep their digits
    Sums sums;
    for (int j = -reachY / step * step; j <= reachY; j += step) {
      if (y + j < 0 || y + j >= measured_.height) continue;
      for (int i = -reachX / step * step; i <= reachX; i += step) {
        if (x + i < 0 || x + i >= measured_.width) continue;
        const double n = shape_.at(x + i, y + j);
        if (!(n > 0)) continue;
        const double across = i * i * perX * perX + j * j * perY * perY, along = (n - z) * (n - z);
        const double share = (across + along) * ball;
        if (!(share < 1)) continue;
        sums.add(i / reach, j / reach, 1 / double(measured_.at(x + i, y + j)) - centre, (1 - share) * (1 - share));
      }
    }
    std::optional<LocalFit> fit;
    if (sums.count >= kLeastQuadratic) fit = sums.solve<kTerms>(reach);
    if (!fit && sums.count >= kLeastLinear) fit = sums.solve<3>(reach);
    if (!fit) return fit;
    fit->inverse += centre;
    if (!(fit->inverse > 0)) return std::nullopt;
    return fit;
  }

 private:
  const Image& measured_;
  const Image& shape_;
  double fx_, fy_, radius_;
};

/// Towards the camera. The plane through the point: inverse depth = a X/Z + b Y/Z + c, hence a X + b Y + c Z = 1.
Eigen::Vector3d normalOf(const LocalFit& fit, int x, int y, const Camera& camera) {
  const Eigen::Matrix3d& k = camera.pixelFromRay;
  Pixel at(x, y);
  Eigen::Vector2d slope(fit.byX, fit.byY);
  if (camera.hasDistortion()) {
    at = camera.undistorted(at);
    Eigen::Matrix2d idealFromMeasured;
    idealFromMeasured.col(0) = 0.5 * (camera.undistorted(Pixel(x + 1, y)) - camera.undistorted(Pixel(x - 1, y)));
    idealFromMeasured.col(1) = 0.5 * (camera.undistorted(Pixel(x, y + 1)) - camera.undistorted(Pixel(x, y - 1)));
    slope = idealFromMeasured.inverse().transpose() * slope;
    if (!slope.allFinite() || !at.allFinite()) return Eigen::Vector3d::Zero();
  }
  // Pixel x = fx X/Z + skew Y/Z + cx.
  const double a = slope.x() * k(0, 0), b = slope.x() * k(0, 1) + slope.y() * k(1, 1);
  const double c = fit.inverse + slope.x() * (k(0, 2) - at.x()) + slope.y() * (k(1, 2) - at.y());
  return -Eigen::Vector3d(a, b, c).normalized();
}

}  // namespace

SmoothDepth fittedDepth(const Image& depth, const Camera& camera, double radius) {
  require(depth.channels == 1 && radius > 0, "fittedDepth: one channel and a positive radius expected");
  // First about the points as measured, whose noise decides which of them lie in a ball; then about the smoothed ones.
  SmoothDepth result{depth, {}};
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    const Image shape = result.depth;
    const Fitter fitter(depth, shape, camera, radius);
    const bool last = round + 1 == kRounds;
    if (last) result.normals.assign(depth.data.size(), Eigen::Vector3d::Zero());
    parallelFor(
        depth.height,
        [&](int y) {
          for (int x = 0; x < depth.width; ++x) {
            if (!(depth.at(x, y) > 0)) continue;
            const std::optional<LocalFit> fit = fitter.at(x, y);
            if (!fit) continue;
            result.depth.at(x, y) = static_cast<float>(1 / fit->inverse);
            if (last) result.normals[static_cast<std::size_t>(y) * depth.width + x] = normalOf(*fit, x, y, camera);
          }
        },
        {}, "depth");
  }
  return result;
}

}  // namespace glint

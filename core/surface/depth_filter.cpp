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

#include "core/base/numeric.h"
#include "core/base/outcome.h"
#include "core/base/progress.h"

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
// Farther neighbours are sampled more coarsely: the first round only says which points lie in a ball.
constexpr int kFirstReachPx = 12;
constexpr int kLastReachPx = 16;      // there are enough of them
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

  /// One row of neighbours at y: its sums of w x^i, i <= 4, and of w v x^i, i <= 2.
  void addRow(double y, const double (&row)[5], const double (&rowRight)[3], int n) {
    const double y2 = y * y, y3 = y2 * y, y4 = y2 * y2;
    const double terms[kMoments] = {row[0],      row[1],     row[0] * y,  row[2],      row[1] * y,
                                    row[0] * y2, row[3],     row[2] * y,  row[1] * y2, row[0] * y3,
                                    row[4],      row[3] * y, row[2] * y2, row[1] * y3, row[0] * y4};
    for (int k = 0; k < kMoments; ++k) moment[k] += terms[k];
    const double rights[kTerms] = {rowRight[0], rowRight[1], rowRight[0] * y, rowRight[2], rowRight[1] * y, rowRight[0] * y2};
    for (int k = 0; k < kTerms; ++k) right[k] += rights[k];
    count += n;
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
  /// @param inverse  of the measured depths
  /// @param shape    the depth that says which pixels lie in a ball: measured, or from the round before
  Fitter(const std::vector<double>& inverse, const Image& shape, const Camera& camera, double radius, int reachPx)
      : inverse_(inverse),
        shape_(shape),
        fx_(camera.pixelFromRay(0, 0)),
        fy_(camera.pixelFromRay(1, 1)),
        radius_(radius),
        reachPx_(reachPx) {}

  std::optional<LocalFit> at(int x, int y) const {
    const double z = shape_.at(x, y);
    const double most = std::max(shape_.width, shape_.height);
    const int reachX = int(std::clamp(radius_ * fx_ / z, 2.0, most)), reachY = int(std::clamp(radius_ * fy_ / z, 2.0, most));
    const int step = (std::max(reachX, reachY) + reachPx_ - 1) / reachPx_;
    const double reach = std::max(reachX, reachY), ball = 1 / (radius_ * radius_), perX = z / fx_, perY = z / fy_;
    const double centre = 1 / z;  // values about it keep their digits
    const int left = -std::min(reachX, x) / step * step, right = std::min(reachX, shape_.width - 1 - x);
    Sums sums;
    for (int j = -std::min(reachY, y) / step * step; j <= reachY && y + j < shape_.height; j += step) {
      const std::size_t start = static_cast<std::size_t>(y + j) * shape_.width + x;
      const double down = j * perY * j * perY;
      double row[5] = {}, rowRight[3] = {};
      int n = 0;
      for (int i = left; i <= right; i += step) {
        const double there = shape_.data[start + i];
        if (!(there > 0)) continue;
        const double along = there - z, across = i * perX;
        const double rest = 1 - (across * across + down + along * along) * ball;
        if (!(rest > 0)) continue;
        const double w = rest * rest, u = i / reach, wu = w * u, wuu = wu * u, v = inverse_[start + i] - centre;
        row[0] += w, row[1] += wu, row[2] += wuu, row[3] += wuu * u, row[4] += wuu * u * u;
        rowRight[0] += w * v, rowRight[1] += wu * v, rowRight[2] += wuu * v;
        ++n;
      }
      if (n > 0) sums.addRow(j / reach, row, rowRight, n);
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
  const std::vector<double>& inverse_;
  const Image& shape_;
  double fx_, fy_, radius_;
  int reachPx_;
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
  // First about the measured points, whose noise decides which of them lie in a ball; then about the smoothed ones.
  SmoothDepth result{depth, {}};
  std::vector<double> inverse;
  for (const float z : depth.data) inverse.push_back(z > 0 ? 1 / double(z) : 0);
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    const Image shape = result.depth;
    const bool last = round + 1 == kRounds;
    const Fitter fitter(inverse, shape, camera, radius, last ? kLastReachPx : kFirstReachPx);
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

// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/background.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/base/dense_algebra.h"
#include "core/base/numeric.h"

namespace glint {
namespace {

constexpr double kInner = 1.6;  // in footprints: the lobe is below 0.17 of its peak for level 0.5
constexpr double kOuter = 4.0;
constexpr int kLeastPixels = 60;           // several per unknown
constexpr std::size_t kMostPixels = 8000;  // a denser sample changes the fit by less than its own noise
constexpr int kTrimRounds = 8;
constexpr double kNearlyAsGood = 1.1;  // of the spread: two tails that differ by less cannot be told apart

struct BackgroundSample {
  Eigen::Matrix<double, 9, 1> row;
  double value;
};

/// Usable pixels in the ring around a footprint, thinned evenly. @param scale  px, of u and v
std::vector<BackgroundSample> backgroundSamples(const Image& image, const std::vector<char>& usable, const Footprint& footprint,
                                                const Pixel& reach, double scale, const std::function<double(double)>& fall) {
  const Eigen::LLT<Eigen::Matrix2d> shape(footprint.shape);
  const int x0 = std::max(0, static_cast<int>(footprint.centre.x() - reach.x())),
            y0 = std::max(0, static_cast<int>(footprint.centre.y() - reach.y()));
  const int x1 = std::min(image.width - 1, static_cast<int>(footprint.centre.x() + reach.x()) + 1);
  const int y1 = std::min(image.height - 1, static_cast<int>(footprint.centre.y() + reach.y()) + 1);
  const double cells = std::max(0, x1 - x0 + 1) * static_cast<double>(std::max(0, y1 - y0 + 1));
  const int stride = std::max(1, static_cast<int>(std::sqrt(cells / static_cast<double>(kMostPixels))));
  std::vector<BackgroundSample> samples;
  for (int y = y0; y <= y1; y += stride)
    for (int x = x0; x <= x1; x += stride) {
      if (!usable[static_cast<std::size_t>(y) * image.width + x]) continue;
      const Pixel d = Pixel(x, y) - footprint.centre;
      const double rho2 = shape.matrixL().solve(d).squaredNorm();
      if (rho2 < kInner * kInner || rho2 > kOuter * kOuter) continue;
      const double u = d.x() / scale, v = d.y() / scale;
      const double tail = fall(rho2);
      BackgroundSample s;
      s.row << 1, u, v, u * u, u * v, v * v, tail, u * tail, v * tail;
      s.value = image.at(x, y);
      samples.push_back(s);
    }
  return samples;
}

}  // namespace

double Background::at(double x, double y) const {
  const double u = (x - centre.x()) / scale, v = (y - centre.y()) / scale;
  return coefficients[0] + u * coefficients[1] + v * coefficients[2] + u * u * coefficients[3] + u * v * coefficients[4] +
         v * v * coefficients[5];
}

Background fitBackground(const Image& image, const std::vector<char>& usable, const Footprint& footprint, double fallback,
                         Tail tail) {
  const double logLevel = std::log(footprint.level), ggx = 1 / std::sqrt(footprint.level) - 1;
  return tail == Tail::Ggx
             ? fitBackground(image, usable, footprint, fallback, [&](double r) { return std::pow(1 + ggx * r, -2); })
             : fitBackground(image, usable, footprint, fallback, [&](double r) { return std::exp(logLevel * r); });
}

Background fitBackground(const Image& image, const std::vector<char>& usable, const Footprint& footprint, double fallback,
                         const std::function<double(double)>& fall) {
  Background result;
  result.coefficients[0] = fallback;
  result.centre = footprint.centre;
  const Pixel reach = kOuter * footprint.shape.diagonal().cwiseSqrt();
  result.scale = std::max(1.0, reach.maxCoeff());
  const std::vector<BackgroundSample> samples = backgroundSamples(image, usable, footprint, reach, result.scale, fall);
  if (samples.size() < static_cast<std::size_t>(kLeastPixels)) return result;

  // Iteratively reweighted least squares, Tukey's biweight; the first round is unweighted about the median.
  std::vector<double> residual(samples.size()), absolute(samples.size());
  std::vector<double> values(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) values[i] = samples[i].value;
  const double start = upperMedian(values);
  for (std::size_t i = 0; i < samples.size(); ++i) residual[i] = samples[i].value - start;
  Eigen::Matrix<double, 9, 1> solution = Eigen::Matrix<double, 9, 1>::Zero();
  double spread = 0;
  // Values in the tenth column; nine rows of damping and a zero one below the pixels'.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 10>;
  Rows rows(static_cast<Eigen::Index>(samples.size()) + 10, 10);
  for (int round = 0; round < kTrimRounds; ++round) {
    for (std::size_t i = 0; i < samples.size(); ++i) absolute[i] = std::abs(residual[i]);
    spread = 1.4826 * upperMedian(absolute);
    // Tukey's constant; the floor keeps it above round-off of the values where the image is exactly the model.
    const double cut = 4.685 * std::max(spread, 1e-12 * (std::abs(start) + 1e-300));
    Eigen::Index used = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double t = residual[i] / cut;
      if (std::abs(t) >= 1) continue;
      const double root = 1 - t * t;  // of the weight
      rows.row(used).head<9>() = root * samples[i].row.transpose();
      rows(used, 9) = root * samples[i].value;
      ++used;
    }
    // A trace of damping, 3e-5 of the rows' size, keeps directions that the pixels do not determine (no tail visible, a thin
    // strip) at zero.
    const double damping = std::sqrt(1e-9) * rows.topLeftCorner(used, 9).norm();
    rows.middleRows<10>(used).setZero();
    rows.middleRows<9>(used).leftCols<9>().diagonal().setConstant(damping);
    used += 10;
    const Eigen::Matrix<double, 10, 10> r = triangularFactor(rows.topRows(used));
    solution = r.topLeftCorner<9, 9>().triangularView<Eigen::Upper>().solve(r.topRightCorner<9, 1>());
    if (!solution.allFinite()) return result;
    for (std::size_t i = 0; i < samples.size(); ++i) residual[i] = samples[i].value - samples[i].row.dot(solution);
  }
  result.coefficients = solution.head<6>();
  result.spread = spread;
  result.pixels = static_cast<int>(samples.size());
  return result;
}

double backgroundUncertaintyPct(const Image& image, const std::vector<char>& usable, const Footprint& footprint,
                                double peakValue) {
  if (!(peakValue > 0) || !(footprint.level > 0 && footprint.level < 1)) return 0;
  const Background gaussian = fitBackground(image, usable, footprint, 0, Tail::Gaussian);
  const Background ggx = fitBackground(image, usable, footprint, 0, Tail::Ggx);
  if (gaussian.pixels == 0 || ggx.pixels == 0) return 0;
  if (ggx.spread > kNearlyAsGood * gaussian.spread) return 0;
  // A background too high by b shifts the level q to q + (1 - q) b / I_peak; level^(rho^2) says how far the contour moves.
  const double off =
      (gaussian.at(footprint.centre.x(), footprint.centre.y()) - ggx.at(footprint.centre.x(), footprint.centre.y())) / peakValue;
  const double q = footprint.level, moved = (1 - q) * off / (2 * q * -std::log(q));
  return 50 * std::abs(moved);
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/peak.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

namespace glint {
namespace {

constexpr int kEnoughPixels = 12;      // twice the six coefficients
constexpr double kLowestWindow = 0.3;  // below this the lobe's tail, not its top, would decide
constexpr double kWindowStep = 0.1;

/// Binomial 3x3 mean, so that noise on single pixels does not fray the window.
double smoothed(const Image& image, int x, int y) {
  static constexpr int kWeight[3] = {1, 2, 1};
  double sum = 0, weights = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const int u = x + dx, v = y + dy;
      if (u < 0 || v < 0 || u >= image.width || v >= image.height || !std::isfinite(image.at(u, v))) continue;
      const double w = kWeight[dx + 1] * kWeight[dy + 1];
      sum += w * image.at(u, v);
      weights += w;
    }
  return weights > 0 ? sum / weights : 0;
}

std::vector<Eigen::Vector2i> windowPixels(const Image& image, int x, int y, double threshold) {
  std::vector<char> seen(image.data.size(), 0);
  std::vector<Eigen::Vector2i> window{{x, y}};
  seen[static_cast<std::size_t>(y) * image.width + x] = 1;
  for (std::size_t i = 0; i < window.size(); ++i) {
    const Eigen::Vector2i at = window[i];
    for (const Eigen::Vector2i& step :
         {Eigen::Vector2i(1, 0), Eigen::Vector2i(-1, 0), Eigen::Vector2i(0, 1), Eigen::Vector2i(0, -1)}) {
      const Eigen::Vector2i p = at + step;
      if (p.x() < 0 || p.y() < 0 || p.x() >= image.width || p.y() >= image.height) continue;
      char& mark = seen[static_cast<std::size_t>(p.y()) * image.width + p.x()];
      if (mark) continue;
      mark = 1;
      if (smoothed(image, p.x(), p.y()) >= threshold) window.push_back(p);
    }
  }
  return window;
}

}  // namespace

Outcome<PeakFit> fitPeak(const Image& image, int x, int y, double windowLevel) {
  require(image.channels == 1 && x >= 0 && y >= 0 && x < image.width && y < image.height,
          "fitPeak: pixel of a one-channel image");
  const double top = smoothed(image, x, y);
  if (!(top > 0)) return Failure{Reason::NotConverged, "the maximum is not positive"};
  std::vector<Eigen::Vector2i> window;
  for (double level = windowLevel; level >= kLowestWindow - 1e-9; level -= kWindowStep) {  // round-off of the sum of steps
    window = windowPixels(image, x, y, level * top);
    if (static_cast<int>(window.size()) >= kEnoughPixels) break;
  }
  if (static_cast<int>(window.size()) < kEnoughPixels)
    return Failure{Reason::TooFewPoints, "only " + std::to_string(window.size()) + " pixels around the peak"};

  // Centred and scaled coordinates: the columns of the fit are then of one size.
  Pixel centre(0, 0), low(window[0].cast<double>()), high(low);
  for (const Eigen::Vector2i& p : window) {
    centre += p.cast<double>();
    low = low.cwiseMin(p.cast<double>());
    high = high.cwiseMax(p.cast<double>());
  }
  centre /= static_cast<double>(window.size());
  const double scale = std::max(1.0, 0.5 * (high - low).maxCoeff());

  using Row = Eigen::Matrix<double, 6, 1>;
  Eigen::Matrix<double, Eigen::Dynamic, 6> rows(static_cast<Eigen::Index>(window.size()), 6);
  Eigen::VectorXd right(static_cast<Eigen::Index>(window.size()));
  double weights = 0;
  int used = 0;
  for (const Eigen::Vector2i& p : window) {
    const double value = image.at(p.x(), p.y());
    if (!std::isfinite(value) || value <= 0) continue;
    const Pixel q = (p.cast<double>() - centre) / scale;
    Row row;
    row << 1, q.x(), q.y(), q.x() * q.x(), q.x() * q.y(), q.y() * q.y();
    const double root = value / top;  // of the weight
    rows.row(used) = root * row.transpose();
    right(used) = root * std::log(value / top);
    weights += root * root;
    ++used;
  }
  if (used < kEnoughPixels) return Failure{Reason::TooFewPoints, "too few usable pixels around the peak"};
  const Eigen::ColPivHouseholderQR<Eigen::Matrix<double, Eigen::Dynamic, 6>> qr(rows.topRows(used));
  if (qr.rank() < 6) return Failure{Reason::NotConverged, "singular fit"};
  const Row c = qr.solve(right.head(used));
  if (!c.allFinite()) return Failure{Reason::NotConverged, "singular fit"};
  Eigen::Matrix2d hessian;
  hessian << 2 * c[3], c[4], c[4], 2 * c[5];
  const Eigen::Vector2d curvatures = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(hessian).eigenvalues();
  if (!(curvatures.maxCoeff() < 0)) return Failure{Reason::NotConverged, "log I has no maximum near the peak"};
  const Pixel offset = -hessian.ldlt().solve(c.segment<2>(1));
  PeakFit fit;
  fit.at = centre + scale * offset;
  if ((fit.at.array() < low.array() - 1).any() || (fit.at.array() > high.array() + 1).any())
    return Failure{Reason::NotConverged, "the fitted maximum lies outside its window"};
  fit.value = top * std::exp(c[0] + 0.5 * c.segment<2>(1).dot(offset));
  fit.rms = (rows.topRows(used) * c - right.head(used)).norm() / std::sqrt(weights);
  fit.pixels = used;
  return fit;
}

double outsideOfContour(const Highlight& highlight) {
  constexpr double kPeakKnownPx = 0.5;  // a quadratic through noisy pixels finds it to a few tenths
  if (highlight.contour.points.empty() || contains(highlight.contour, highlight.peak)) return 0;
  const double away = distance(highlight.contour, highlight.peak);
  return away > kPeakKnownPx ? away : 0;
}

}  // namespace glint

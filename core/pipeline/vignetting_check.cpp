// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/vignetting_check.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/base/numeric.h"

namespace glint {
namespace {

constexpr int kFallPoints = 1500;        // of a view: the loss is good to 2 % of the light where noise is a tenth of it
constexpr std::size_t kFewestViews = 3;  // of a point, so that one that is off does not lead
constexpr std::size_t kFewestFallPoints = 200;
constexpr double kDarkest = 0.15;    // of the bright points: ratios of darker ones are noise
constexpr double kLeastLoss = 0.15;  // moves contours by less than 0.1 % below
constexpr double kSure = 8;          // standard deviations; neighbouring points are not independent
constexpr int kReweightings = 12;    // the loss settles in eight
constexpr double kOutliers = 3;      // spreads beyond which a value counts less
// Shares of the loss: how far it may differ along the axes, and what slope there may be. Long tails of highlights, which look
// like a loss of 10 to 80 %, have slopes of half of it or losses along the axes of twice as much.
constexpr double kAlike = 1.6, kSlope = 0.25;
constexpr double kRidge = 1e-9;           // of the trace: tails that no view shows stay zero
constexpr double kFallSpread = 0.1;       // a code of 8 bits in the dark: steps of the codes are no outliers
constexpr double kNormalMedian = 1.4826;  // standard deviations in a median of absolute ones

using Terms = std::vector<double> (*)(const Eigen::Vector2d& place);
std::vector<double> radial(const Eigen::Vector2d& p) { return {p.squaredNorm()}; }
std::vector<double> anySmooth(const Eigen::Vector2d& p) { return {p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y()}; }

/// One value of a point, as a share of the point's mean.
struct Sighting {
  double value = 0, weight = 1;
  Eigen::VectorXd row;  ///< gains of the views but the first, two tails, terms
};
using PointSightings = std::vector<Sighting>;
using Points = std::vector<std::vector<TexturePanel::Sample>>;

double meanOf(const std::vector<TexturePanel::Sample>& point) {
  double mean = 0;
  for (const TexturePanel::Sample& s : point) mean += s.value / static_cast<double>(point.size());
  return mean;
}

std::vector<PointSightings> rowsOf(const Points& points, const std::vector<Eigen::Vector2d>& middles, Terms terms) {
  const Eigen::Index gains = static_cast<Eigen::Index>(middles.size()) - 1,
                     own = static_cast<Eigen::Index>(terms(Eigen::Vector2d(0, 0)).size());
  std::vector<PointSightings> rows;
  for (const std::vector<TexturePanel::Sample>& point : points) {
    const double mean = meanOf(point);
    PointSightings& all = rows.emplace_back();
    for (const TexturePanel::Sample& s : point) {
      Sighting seen{s.value / mean, 1, Eigen::VectorXd::Zero(gains + 2 + own)};
      if (s.view > 0) seen.row(static_cast<Eigen::Index>(s.view) - 1) = 1;
      seen.row(gains) = s.tail[0] / mean;
      seen.row(gains + 1) = s.tail[1] / mean;
      const std::vector<double> values = terms((s.at - middles[s.view]) / middles[s.view].norm());
      seen.row.tail(own) = Eigen::Map<const Eigen::VectorXd>(values.data(), own);
      all.push_back(std::move(seen));
    }
  }
  return rows;
}

/// Takes each point's own mean off.
void takeMeansOff(std::vector<PointSightings>& rows) {
  for (PointSightings& point : rows) {
    double sum = 0, value = 0;
    Eigen::VectorXd row = Eigen::VectorXd::Zero(point.front().row.size());
    for (const Sighting& s : point) {
      sum += s.weight;
      value += s.weight * s.value;
      row += s.weight * s.row;
    }
    for (Sighting& s : point) {
      s.value -= value / sum;
      s.row -= row / sum;
    }
  }
}

struct FittedFall {
  Eigen::VectorXd terms, sigma;
};

/// Robust least squares with a mean of each point's own. @param own  how many terms
FittedFall fittedFall(std::vector<PointSightings> rows, Eigen::Index own) {
  const Eigen::Index n = rows.front().front().row.size();
  FittedFall fitted;
  for (int round = 0; round < kReweightings; ++round) {
    takeMeansOff(rows);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (const PointSightings& point : rows)
      for (const Sighting& s : point) {
        normal.selfadjointView<Eigen::Lower>().rankUpdate(s.row, s.weight);
        right += s.weight * s.value * s.row;
      }
    normal.diagonal().array() += kRidge * normal.trace();
    const Eigen::LDLT<Eigen::MatrixXd> factors(normal.selfadjointView<Eigen::Lower>());
    const Eigen::VectorXd solved = factors.solve(right);
    std::vector<double> left;
    for (const PointSightings& point : rows)
      for (const Sighting& s : point) left.push_back(std::abs(s.value - solved.dot(s.row)));
    const double spread = std::max(kNormalMedian * upperMedian(left), kFallSpread);
    for (PointSightings& point : rows)
      for (Sighting& s : point) s.weight = 1 / (1 + std::pow((s.value - solved.dot(s.row)) / (kOutliers * spread), 2));
    fitted.terms = solved.tail(own);
    fitted.sigma = spread * factors.solve(Eigen::MatrixXd::Identity(n, n)).diagonal().tail(own).cwiseMax(0).cwiseSqrt();
  }
  return fitted;
}

}  // namespace

std::optional<Vignetting> vignettingOf(const TexturePanel& panel) {
  Points points = panel.sightings(kFallPoints);
  std::vector<double> bright;
  for (const auto& point : points)
    for (const TexturePanel::Sample& s : point) bright.push_back(s.value);
  if (bright.empty()) return std::nullopt;
  const double least = kDarkest * ranked(bright, bright.size() - 1 - bright.size() / 20);
  std::erase_if(points, [&](const std::vector<TexturePanel::Sample>& point) {
    return point.size() < kFewestViews || !(meanOf(point) > least);
  });
  if (points.size() < kFewestFallPoints) return std::nullopt;
  std::vector<Eigen::Vector2d> middles;
  for (const TextureView& view : panel.views()) middles.emplace_back((view.value.width - 1) / 2.0, (view.value.height - 1) / 2.0);
  const FittedFall fall = fittedFall(rowsOf(points, middles, radial), 1);
  const Vignetting found{-fall.terms(0), fall.sigma(0)};
  const double k = found.cornerLoss;
  if (!(k > kLeastLoss && k > kSure * found.sigma)) return std::nullopt;
  const FittedFall any = fittedFall(rowsOf(points, middles, anySmooth), 5);
  const auto isAlike = [&](double along) { return -along > k / kAlike && -along < k * kAlike; };
  const bool round = std::abs(any.terms(0)) < kSlope * k && std::abs(any.terms(1)) < kSlope * k && isAlike(any.terms(2)) &&
                     isAlike(any.terms(4));
  return round ? std::optional(found) : std::nullopt;
}

std::string vignettingRemark(const std::optional<Vignetting>& found, std::size_t views, const CameraResponse& response) {
  if (!found) return "";
  // To a hundredth: the light does not fall with a square to more digits.
  const std::string fix = response.withVignetting(std::round(100 * found->cornerLoss) / 100).text();
  return formatted(
      "the images get darker towards their corners: about %.0f %% less light there, as the same surface points show in %zu "
      "frames (vignetting; state it: \"response\": \"%s\" in the camera, or --response \"%s\" for a capture)",
      100 * found->cornerLoss, views, fix.c_str(), fix.c_str());
}

}  // namespace glint

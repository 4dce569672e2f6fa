// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/sighting_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/base/numeric.h"

namespace glint {
namespace {

constexpr int kSightedPoints = 1500;       // of a view: a loss is good to 2 % of the light where noise is a tenth of it
constexpr std::size_t kFewestOfPoint = 3;  // views, so that one that is off does not lead
constexpr std::size_t kFewestSighted = 200;
constexpr double kDarkest = 0.15;         // of the bright points: ratios of darker ones are noise
constexpr int kReweightings = 12;         // shares settle in eight
constexpr double kSettled = 1e-3;         // of all shares: a tenth of what is said of them
constexpr double kFarOff = 3;             // spreads beyond which a value counts less
constexpr double kRidge = 1e-9;           // of the trace: tails that no view shows stay zero
constexpr double kRatioSpread = 0.1;      // a code of 8 bits in the dark: steps of the codes are no outliers
constexpr double kNormalMedian = 1.4826;  // standard deviations in a median of absolute ones

/// One value of a point, as a share of the point's mean.
struct Sighting {
  double value = 0, weight = 1;
  Eigen::VectorXd row;  ///< gains of the views but the first, two tails, terms
};
using PointSightings = std::vector<Sighting>;

double meanOf(const PointSamples& point) {
  double mean = 0;
  for (const TexturePanel::Sample& s : point) mean += s.value / static_cast<double>(point.size());
  return mean;
}

std::vector<PointSightings> rowsOf(const std::vector<PointSamples>& points, std::size_t views, const SightingTerms& terms) {
  const Eigen::Index gains = static_cast<Eigen::Index>(views) - 1;
  std::vector<PointSightings> rows;
  for (const PointSamples& point : points) {
    const double mean = meanOf(point);
    PointSightings& all = rows.emplace_back();
    for (const TexturePanel::Sample& s : point) {
      const std::vector<double> values = terms(s, mean);
      const Eigen::Index own = static_cast<Eigen::Index>(values.size());
      Sighting seen{s.value / mean, 1, Eigen::VectorXd::Zero(gains + 2 + own)};
      if (s.view > 0) seen.row(static_cast<Eigen::Index>(s.view) - 1) = 1;
      seen.row(gains) = s.tail[0] / mean;
      seen.row(gains + 1) = s.tail[1] / mean;
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

}  // namespace

std::vector<PointSamples> brightSightings(const TexturePanel& panel) {
  std::vector<PointSamples> points = panel.sightings(kSightedPoints);
  std::vector<double> bright;
  for (const PointSamples& point : points)
    for (const TexturePanel::Sample& s : point) bright.push_back(s.value);
  if (bright.empty()) return {};
  const double least = kDarkest * ranked(bright, bright.size() - 1 - bright.size() / 20);
  std::erase_if(points, [&](const PointSamples& point) { return point.size() < kFewestOfPoint || !(meanOf(point) > least); });
  if (points.size() < kFewestSighted) points.clear();
  return points;
}

SightingFit fittedSightings(const std::vector<PointSamples>& points, std::size_t views, const SightingTerms& terms) {
  std::vector<PointSightings> rows = rowsOf(points, views, terms);
  const Eigen::Index n = rows.front().front().row.size(), own = n - static_cast<Eigen::Index>(views) - 1;
  SightingFit fitted;
  for (const PointSightings& point : rows) fitted.samples += point.size();
  Eigen::VectorXd before = Eigen::VectorXd::Zero(n);
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
    fitted.left = 0;
    const double spread = std::max(kNormalMedian * upperMedian(left), kRatioSpread);
    for (PointSightings& point : rows)
      for (Sighting& s : point) {
        const double off = std::pow(s.value - solved.dot(s.row), 2);
        s.weight = 1 / (1 + off / std::pow(kFarOff * spread, 2));
        fitted.left += s.weight * off;
      }
    fitted.terms = solved.tail(own);
    fitted.sigma = spread * factors.solve(Eigen::MatrixXd::Identity(n, n)).diagonal().tail(own).cwiseMax(0).cwiseSqrt();
    if ((solved - before).norm() < kSettled * solved.norm()) break;
    before = solved;
  }
  return fitted;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/residual_spread.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/numeric.h"
#include "core/base/outcome.h"

namespace glint {

namespace {

/// Sum of the products of values `lag` apart within runs of one view. On closed contours only lags up to half of a run: beyond,
/// the same pairs come again.
double productsAt(std::size_t lag, const std::vector<double>& values, const std::vector<int>& views, Neighbours neighbours) {
  double sum = 0;
  for (std::size_t first = 0, end = 0; first < values.size(); first = end) {
    while (end < values.size() && views[end] == views[first]) ++end;
    const std::size_t size = end - first;
    if (neighbours == Neighbours::Open) {
      for (std::size_t i = first; i + lag < end; ++i) sum += values[i] * values[i + lag];
    } else if (2 * lag <= size) {
      for (std::size_t i = 0; i < size; ++i) sum += values[first + i] * values[first + (i + lag) % size];
    }
  }
  return sum;
}

}  // namespace

double correlationInflation(const std::vector<double>& values, const std::vector<int>& views, Neighbours neighbours) {
  require(values.size() == views.size(), "correlationInflation: sizes");
  double squares = 0;
  for (const double v : values) squares += v * v;
  if (!(squares > 0)) return 1;
  double inflation = 1, share = 1;
  const double noticed = 2 / std::sqrt(double(values.size()));  // an autocorrelation of white residuals stays below this
  for (std::size_t lag = 1; lag <= values.size() / 2; ++lag) {
    const double correlation = productsAt(lag, values, views, neighbours) / squares;
    if (!(correlation > noticed)) break;
    // Shares never grow: what follows a lag that hardly counts would come and go with it.
    share = std::min(share, (correlation - noticed) / noticed);
    inflation += 2 * share * correlation;
  }
  return inflation;
}

ResidualSpread residualSpread(const std::vector<double>& residuals, const std::vector<int>& views, int parameters,
                              double robustScale, Neighbours neighbours) {
  require(!residuals.empty() && residuals.size() == views.size() && robustScale > 0, "residualSpread: sizes and scale");
  const double n = double(residuals.size()), free = std::max(1.0, n - parameters);
  std::vector<double> psi, absolute;
  double squares = 0, inliers = 0;
  for (const double r : residuals) {
    psi.push_back(std::clamp(r, -robustScale, robustScale));
    absolute.push_back(std::abs(r));
    squares += psi.back() * psi.back();
    inliers += std::abs(r) <= robustScale;
  }
  ResidualSpread spread;
  // The median of |x| of a unit normal is 1 / 1.4826.
  spread.noisePx = 1.4826 * upperMedian(absolute) * std::sqrt(n / free);
  const double slope = std::max(inliers, 1.0) / n, k = 1 + parameters / n * (1 - slope) / slope;
  const double inflation = correlationInflation(psi, views, neighbours);
  spread.factor = inflation * k * k * squares / free / (slope * slope);
  spread.degreesOfFreedom = std::max(1.0, free / inflation);
  return spread;
}

double rmsWithoutTail(const std::vector<double>& residuals) {
  if (residuals.empty()) return 0;
  std::vector<double> sizes;
  for (const double r : residuals) {
    if (!std::isfinite(r)) return std::nan("");
    sizes.push_back(std::abs(r));
  }
  const double most = 2 * ranked(sizes, (2 * sizes.size() - 1) / 3);  // the last of the smaller two thirds
  double sum = 0;
  for (const double size : sizes) sum += std::pow(std::min(size, most), 2);
  return std::sqrt(sum / double(sizes.size()));
}

}  // namespace glint

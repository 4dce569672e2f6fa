// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/scene/convention_report.h"

namespace glint {
namespace {

constexpr std::size_t kSample = 20000;  // vertices looked at: more would not change a share
constexpr std::size_t kLeast = 12;      // fewer say nothing about a last digit

/// Share of last digits that vary when numbers were rounded: 1/2 of binary ones, 9/10 of decimal ones. Shapes with round
/// coordinates stay below.
constexpr double kUsedBits = 0.2, kUsedDecimals = 0.5;

/// Distance of neighbouring floats at a value of this size.
double floatStep(double size) {
  return double(std::nextafter(static_cast<float>(size), INFINITY)) - double(static_cast<float>(size));
}

std::optional<double> floatGrid(const std::vector<double>& values) {
  std::size_t odd = 0;
  double largest = 0;
  for (const double v : values) {
    const float f = static_cast<float>(v);
    if (double(f) != v) return std::nullopt;
    odd += std::bit_cast<std::uint32_t>(f) & 1u;
    largest = std::max(largest, std::abs(v));
  }
  const double share = double(odd) / double(values.size());
  // All are odd: one value, such as the height of a plane.
  return share > kUsedBits && share < 1 - kUsedBits ? std::optional<double>(floatStep(largest)) : std::nullopt;
}

std::optional<double> decimalGrid(const std::vector<double>& values) {
  double largest = 0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  for (int places = -6; places <= 12; ++places) {
    const double scale = std::pow(10.0, places);
    constexpr double kRoundOff = 4.4e-16;  // of a double that stands for a decimal number, and of the product
    const double slack = largest * scale * kRoundOff;
    if (slack > 0.01) return std::nullopt;  // any double would look like such a number
    std::size_t used = 0;
    bool all = true;
    for (const double v : values) {
      const double whole = std::round(v * scale);
      all = std::abs(v * scale - whole) <= slack;
      if (!all) break;
      used += std::fmod(whole, 10) != 0;
    }
    if (all) return used > kUsedDecimals * double(values.size()) ? std::optional<double>(1 / scale) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::optional<CoordinateGrid> coordinateGrid(const std::vector<Eigen::Vector3d>& vertices) {
  if (vertices.size() < kLeast) return std::nullopt;
  const std::size_t step = std::max<std::size_t>(1, vertices.size() / kSample);
  std::optional<CoordinateGrid> widest;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (std::size_t i = 0; i < vertices.size(); i += step) values.push_back(vertices[i][axis]);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    if (*low == *high) continue;
    const std::optional<double> decimal = decimalGrid(values), single = decimal ? std::nullopt : floatGrid(values);
    const double spacing = decimal.value_or(single.value_or(0));
    if (spacing > 0 && (!widest || spacing > widest->spacing)) widest = CoordinateGrid{spacing, single.has_value()};
  }
  return widest;
}

}  // namespace glint

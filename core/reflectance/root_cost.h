// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/reflectance/radiance_problem.h"

namespace ceres {
class CostFunction;
}

/// Residuals of RadianceProblem for Ceres; internal to core/reflectance, sources only.
namespace glint::lobe {

inline constexpr double kUnlitPx = 100;  // residual of a point that the light does not reach

/// Parameter blocks of a state as the cost functions take them: L (4), log m (1), then the shape's own, where it has any, then
/// the logarithm of the ratio of two widths, where the lobe has them.
struct Blocks {
  Blocks(State& s, Lobe lobe)
      : at{s.lamp.centre.data(), &s.logRoughness, &s.logRatio, &s.logRatio}, count(hasTwoWidths(lobe) ? 3 : 2) {
    if (unknownCount(s.lamp.shape) == 0) return;
    at[2] = unknownsOf(s.lamp.shape).data();
    ++count;
  }
  std::vector<double*> used() const { return {at, at + count}; }

  double* at[4];
  int count;
};

/// (g - sqrt(-log q)) of one contour point in pixels, with its derivatives by dual numbers; log I at the frame's peak is the
/// problem's, of the same parameters. A point that the light does not reach has a large residual without derivatives.
std::unique_ptr<ceres::CostFunction> rootCost(const LampShape& shape, const RadianceProblem& problem, const Evidence& evidence);

/// log I at a point with its derivatives by the blocks' entries up to the shape's; nothing where it is undefined.
std::optional<LogAndSlopes> logAndSlopes(const RadianceProblem& problem, const Seen& s, State state);

}  // namespace glint::lobe

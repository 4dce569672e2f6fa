// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/base/progress.h"

namespace ceres {
class Problem;
}

namespace glint {

struct DenseSolution {
  bool usable = false;     ///< the parameters are finite and no worse than the start
  bool converged = false;  ///< within the tolerances, not out of iterations
  double cost = 0;         ///< half the sum of squares after the loss
  int iterations = 0;
};

/// Levenberg-Marquardt for a handful of unknowns under many residuals: QR of the Jacobian (no normal equations), silent, on the
/// caller's thread. The parameters are changed in place.
/// @param tolerance      relative change of cost and unknowns that ends the iteration; the gradient's is a hundredth of
///                       it, so that a flat valley does not end it early
/// @param costTolerance  the cost's own, where it may be looser
/// @param progress       asked after every iteration
/// Stopped.
DenseSolution solveDense(ceres::Problem& problem, int maxIterations, double tolerance, std::optional<double> costTolerance = {},
                         const ProgressFn& progress = {});

}  // namespace glint

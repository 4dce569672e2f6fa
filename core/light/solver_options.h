// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/solver.h>

#include <algorithm>

namespace glint {

/// Options for a handful of unknowns under many residuals: QR of the Jacobian (no normal equations), silent, on the caller's thread.
/// @param tolerance  relative change of cost and unknowns that ends the iteration; the gradient's is a hundredth of it, so that a
///                   flat valley does not end it early.
inline ceres::Solver::Options denseSolver(int maxIterations, double tolerance) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = std::max(1, maxIterations);
  options.function_tolerance = tolerance;
  options.parameter_tolerance = tolerance;
  options.gradient_tolerance = 0.01 * tolerance;
  return options;
}

/// Converged, or so close to an exact fit that the cost is round-off of its `residuals` squares (px).
inline bool converged(const ceres::Solver::Summary& summary, std::size_t residuals) {
  constexpr double kExact = 1e-20;  // px^2 a residual
  return summary.termination_type == ceres::CONVERGENCE || summary.final_cost <= kExact * static_cast<double>(residuals);
}

}  // namespace glint

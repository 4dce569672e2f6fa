// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/dense_solver.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <vector>

#include "core/base/solver_trace.h"

namespace glint {

DenseSolution solveDense(ceres::Problem& problem, int maxIterations, double tolerance, std::optional<double> costTolerance) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = std::max(1, maxIterations);
  options.function_tolerance = costTolerance.value_or(tolerance);
  options.parameter_tolerance = tolerance;
  options.gradient_tolerance = 0.01 * tolerance;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  // Half the sum of squares, with the costs of steps that were not taken among them.
  std::vector<double> costs;
  for (const ceres::IterationSummary& step : summary.iterations)
    if (step.iteration == 0 || step.step_is_successful) costs.push_back(2 * step.cost);
  traceRound(costs);
  // The first entry of the log is the start.
  return {summary.IsSolutionUsable(), summary.termination_type == ceres::CONVERGENCE, summary.final_cost,
          std::max<int>(1, static_cast<int>(summary.iterations.size()) - 1)};
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/dense_solver.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <vector>

#include "core/base/solver_trace.h"

namespace glint {
namespace {

/// Ends the solver where the caller says so.
class AskToGoOn final : public ceres::IterationCallback {
 public:
  explicit AskToGoOn(const ProgressFn& progress) : progress_(progress) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    stopped_ = stopped_ || !report(progress_, {"fit", 0, 0});
    return stopped_ ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }
  bool stopped() const { return stopped_; }

 private:
  const ProgressFn& progress_;
  bool stopped_ = false;
};

}  // namespace

DenseSolution solveDense(ceres::Problem& problem, int maxIterations, double tolerance, std::optional<double> costTolerance,
                         const ProgressFn& progress) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = std::max(1, maxIterations);
  options.function_tolerance = costTolerance.value_or(tolerance);
  options.parameter_tolerance = tolerance;
  options.gradient_tolerance = 0.01 * tolerance;
  AskToGoOn ask(progress);
  if (progress) options.callbacks.push_back(&ask);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  // No exception may pass through the solver, which is not written for it.
  if (ask.stopped()) throw Stopped{};
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

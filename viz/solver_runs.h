// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/solver_trace.h"

namespace glint::viz {

/// Runs of solvers that the layer "solver-runs" draws: where the light, or the centre of the ellipsoid, started and ended.
struct DrawnRuns {
  std::string model, light;
  std::vector<SolverRun> runs;
};

}  // namespace glint::viz

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to this folder.

#include <string>
#include <utility>
#include <vector>

#include "core/inspect/summary.h"
#include "core/report/report.h"

namespace glint::evaluation {

/// By name, in the order of the request.
BestModel bestOf(const std::vector<std::pair<std::string, ModelSummary>>& models);

}  // namespace glint::evaluation

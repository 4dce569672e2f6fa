// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/app/trial_search.h"
#include "core/choice/tradeoff.h"
#include "core/pipeline/inspection.h"

namespace glint {

struct TradeoffOptions {
  std::string input;  ///< as the user named it, for the report
  TradeoffBound bound;
  int repeats = 5;  ///< of every timed prediction
  SearchOptions search;
  /// Interrupted work resumes from here; the caller removes it once the result is safe; empty = none.
  std::filesystem::path workFile;
  std::string program;  ///< version: work of another one is not resumed
};

class TradeoffBench;

/// The models that a request names, in one order, from simple to rich. InputError for an unknown one.
std::vector<std::string> namedModels(const std::vector<std::string>& named);
/// What is known before anything is measured. InputError if no frame is held out: every trial would fail, one after the other.
Tradeoff emptyTradeoff(const Scene& scene, const InspectionRequest& request, const TradeoffOptions& options);
/// How time and memory were measured, in words.
std::string measurementText(const TradeoffBench& bench, int repeats);

/// Measures what each sensible setting costs and gives on this input (method.md section 12): searchTrials on few frames, then a
/// full measurement of what is left, then the front, the presets and the choice.
/// @param request  its models are compared; its settings are the base from which knobs are turned.
/// @throw Stopped (the work so far stays in the work file); InputError, also at once where the request leaves no frame held out.
Tradeoff measureTradeoff(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const TradeoffOptions& options,
                         const ProgressFn& progress = {});

}  // namespace glint

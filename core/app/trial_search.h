// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/choice/tradeoff.h"

namespace glint {

/// A model with complete settings.
struct Trial {
  std::string model;
  Settings settings;
};

/// What a trial on few frames gave.
struct TrialResult {
  double errorPct = 0;      ///< rankedErrorPct
  double us = 0;            ///< per frame
  std::string predictions;  ///< equal for trials that predicted the same contours
  std::string poor{};       ///< why the model explains its training views badly; "" if it explains them
};

struct SearchOptions {
  int maxTrials = 240;
  int maxFinalists = 32;
};

struct SearchResult {
  std::vector<Trial> finalists;     ///< worth a full measurement
  std::vector<PrunedPoint> pruned;  ///< everything else that was considered
  int trials = 0;
};

/// Finds the settings worth measuring in full without trying all combinations:
/// 1. every model with the base settings; one that another clearly dominates is given up with all its knobs;
/// 2. one knob at a time: a value without effect on predictions and time, or that improves neither error nor time, is given up;
/// 3. combinations of the values that are left, starting from the front, until the front stays: where the effects of the single
///    values, multiplied, say that a combination is clearly dominated, it is not tried;
/// 4. what is on the front, or too near to tell, goes on; of several that cannot be told apart one stays. The base of every model
///    that answered goes on too, for comparison.
/// Poor trials are given up, unless every trial that answers is poor: then the first one of each model goes on.
/// "Clearly" means beyond the noise of a short measurement, kErrorSlack and kTimeSlack.
/// @param models  from simple to rich.   @param tryOne  a failure gives the trial up, with its reason.
SearchResult searchTrials(const std::vector<std::string>& models, const Settings& base, const std::vector<Knob>& knobs,
                          const std::function<Outcome<TrialResult>(const Trial&)>& tryOne, const SearchOptions& options = {});

inline constexpr double kErrorSlack = 1.1;  ///< few frames tell an error to about a tenth
inline constexpr double kTimeSlack = 1.25;  ///< medians of a few runs on a machine that does other work

}  // namespace glint

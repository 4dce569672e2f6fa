// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/tradeoff/tradeoff.h"

namespace glint {

/// What the user asks of the choice; at most one is set, none means the balanced preset.
struct TradeoffBound {
  std::optional<double> budgetUs = {}, maxErrorPct = {};
};

/// Sorts the points by time, marks the front, finds the presets, picks a point and says why in one sentence.
/// If no point meets the bound, `chosen` stays empty and `reason` names the nearest point.
void choosePoint(Tradeoff& tradeoff, const TradeoffBound& bound);

/// The point that a preset's name means: "fast", "balanced", "exact", or "chosen". InputError (place "--preset NAME").
const TradeoffPoint& pointOfPreset(const Tradeoff& tradeoff, const std::string& name);

}  // namespace glint

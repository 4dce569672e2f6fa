// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/shard.h"
#include "core/trials/run.h"

namespace glint {

/// The settings that the shards of a trade-off measure, from the request alone: every model with the request's settings, then every value of
/// every knob by itself, the models in turn. Nothing that was measured decides what else is, so that the list is the same on every machine.
std::vector<Trial> fixedTrials(const InspectionRequest& request, const std::vector<std::string>& models);

/// Measures every n-th of fixedTrials() in full, one after the other, and returns the part as JSON text (docs/formats.md, "Parts").
/// @param options  its limit on trials bounds the list; what is left out is said. No work file.
/// @throw as measureTradeoff().
std::string tradeoffPart(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const TradeoffOptions& options,
                         const Shard& shard, const ProgressFn& progress = {});

/// The points of all parts, with front, presets and choice from the times in the parts.
/// @throw InputError (file, place): as readParts(), parts of another request or other inputs, settings that are in no part or in two.
Tradeoff mergedTradeoff(const std::vector<std::string>& files);

}  // namespace glint

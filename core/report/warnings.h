// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/inspect/inspection.h"

namespace glint {

/// What makes a run's answers doubtful, one sentence each, the same for text, JSON and HTML: clipped highlights with their
/// frames, frames in which highlights of several lights are one, and the remarks of every fit after its model and light.
std::vector<std::string> warningsOf(const Inspection& inspection);

/// One remark of a fit as such a sentence.
std::string fitWarning(const std::string& model, const std::string& light, const std::optional<std::string>& surface,
                       const std::string& remark);

/// The warning of a poor fit, before its reason.
std::string poorWarning(const std::string& reason);

/// What the predictions of held-out frames are scored against: "truth" (--truth), "given contours" (of the scene file) or "own
/// detection" (of at least one held-out frame).
std::string scoredAgainst(const Inspection& inspection);

}  // namespace glint

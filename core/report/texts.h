// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What several reports say in the same words.
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"
#include "core/pipeline/summary.h"

namespace glint {

/// The command line that computes a request: `glint evaluate INPUT …`, quoted for a POSIX shell; settings at their defaults are
/// left out. INPUT is the scene's file; where its photographs and meshes were looked for is named, too. All paths are absolute,
/// so that it works in any folder. NotSupported for what has no flag (a what-if): only a session can hold it.
Outcome<std::string> commandOf(const Scene& scene, const InspectionRequest& request);

/// The text as one word of a POSIX shell.
std::string shellWord(const std::string& text);

/// The bands of a model's matched highlights in held-out frames (all frames where every surface has its own model), each
/// highlight counted alike. Nothing without predict.band.
std::optional<BandScore> bandSummary(const Inspection& inspection, const ModelResult& result);

/// Remarks on the bands of a model: how wide they are, how many vertices they hold, and the remarks of its fits, each
/// with the light where there are several fits. Empty without predict.band.
std::vector<std::string> bandLines(const Inspection& inspection, const ModelResult& result);

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

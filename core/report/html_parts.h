// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to this folder: the parts of the page of an evaluation, each as HTML.

#include <string>
#include <vector>

#include "core/pipeline/inspection.h"
#include "core/pipeline/summary.h"

namespace glint::html {

/// A square in the colour of a model, before its name.
std::string swatch(const std::string& model);

/// Observed and predicted contours of a frame over its photograph, around what is observed, with errors below.
/// @param model  of this one alone; "" = of all
/// @param title  before the errors; "" = the frame's name
std::string frameFigure(const Inspection& inspection, int frame, const std::string& model, const std::string& title);
/// Error over frames as the inspector plots it.
std::string errorFigure(const Inspection& inspection);
/// A model in pictures: a frame with a median error, the worst one, and one where it missed something.
std::string bestFigures(const Inspection& inspection, const std::string& model);
/// Up to `count` held-out frames, the worst of each model in turn; first those where highlights were missed, up to a third.
std::vector<int> worstFrames(const Inspection& inspection, std::size_t count);

/// Mean errors as bars, with what was missed and invented.
std::string overview(const Inspection& inspection, const std::string& best);
/// Every statistic; a group of rows for each model, with one row for each light where there are several.
std::string statisticsTable(const Inspection& inspection);
/// What each model assumes, what its fits say, and which highlights it missed or invented, each with the reason.
std::string modelSections(const Inspection& inspection);

}  // namespace glint::html

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "core/model/model.h"

namespace glint {

/// One maker per model; registry.cpp lists them from simple to rich.
std::unique_ptr<HighlightModel> makePrimal();
std::unique_ptr<HighlightModel> makeDual();
std::unique_ptr<HighlightModel> makeCanonical();
std::unique_ptr<HighlightModel> makeLimitAngle();

/// Search options for brightest points from the settings.
BrightestPointOptions brightestOptions(const Settings& settings);

/// Leaves one highlight where several brightest points share one contour: those whose peak lies inside a larger predicted
/// contour are dropped (method.md section 8: a component that encloses several brightest points is returned once).
void dropEnclosed(std::vector<PredictedHighlight>& highlights);

}  // namespace glint

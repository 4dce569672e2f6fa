// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/inspect/inspection.h"

namespace glint {

/// One sentence about the highlights that a model predicts in held-out frames and that nothing observed matches: how many, and which filters of
/// predictions (predict.filter_area, predict.filter_shadow) take some of them and none that is observed. Errors of contours do not count them, so
/// that no remedy of a diagnosis shows in them.
/// @return "" where no prediction is spurious
std::string spuriousNote(const Inspection& inspection, const ModelResult& result);

}  // namespace glint

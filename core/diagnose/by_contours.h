// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "core/diagnose/diagnosis.h"

namespace glint {

/// The change with contours alone as evidence, which takes seconds where pixels take a minute. If pixels fail again, both predict
/// the same.
/// Nothing where that saves nothing: the pixels of the base were explained, or the change does not fit them again.
/// @param base   complete, with the model
/// @param model  of the change
std::optional<Change> byContours(const Inspection& base, const Change& change, const std::string& model);

}  // namespace glint

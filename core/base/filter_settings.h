// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/settings.h"

namespace glint {

/// `others` with the settings `predict.filter_...` after those of other predictions, for `allParams`.
std::vector<ParamSpec> withFilterParams(std::vector<ParamSpec> others);

}  // namespace glint

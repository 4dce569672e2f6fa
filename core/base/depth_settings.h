// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/settings.h"

namespace glint {

/// `others` with the settings `surface.depth_...` after those of other surfaces, for `allParams`.
std::vector<ParamSpec> withDepthParams(std::vector<ParamSpec> others);

}  // namespace glint

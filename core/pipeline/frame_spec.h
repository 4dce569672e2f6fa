// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace glint {

/// Frame numbers named by a SPEC of formats.md: ids or numbers, ranges ("0-5", "0,14,28"), "first:K", "spread:K".
/// Sorted and unique. InputError (place: `flag`) when it does not parse or names a frame that does not exist.
std::vector<int> parseFrames(const std::string& text, const Scene& scene, const std::string& flag);

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace glint {

/// Frame numbers named by a SPEC (docs/formats.md, "Frame SPEC"): ids or numbers, ranges ("0-5", "0,14,28"), "first:K",
/// "spread:K". Sorted and unique. InputError (place: `flag`) when it does not parse or names a frame that does not exist.
std::vector<int> parseFrames(const std::string& text, const Scene& scene, const std::string& flag);

/// A SPEC of ids and ranges of ids that names these frames in this scene; numbers stand where an id would be read as something
/// else (a comma, a range). "" for no frame.
/// @param frames  sorted and unique
std::string frameSpec(const std::vector<int>& frames, const Scene& scene);

}  // namespace glint

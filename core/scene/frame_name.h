// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/words.h"
#include "core/scene/scene.h"

namespace glint {

// How a person is told of a frame: always by its id. Its place in the sequence would read like the id of another frame ("0004" is
// not frame 4 where frames were left out of a capture).

/// The frame's id. "at position N" for a number that names no frame of this scene, for example in a file of another scene.
inline std::string frameName(const Scene& scene, int frame) {
  return frame >= 0 && frame < static_cast<int>(scene.frames.size()) ? scene.frames[static_cast<std::size_t>(frame)].id
                                                                     : "at position " + std::to_string(frame);
}

/// The names of all frames, in the same order.
inline std::vector<std::string> frameIds(const Scene& scene, const std::vector<int>& frames) {
  std::vector<std::string> ids;
  for (const int frame : frames) ids.push_back(frameName(scene, frame));
  return ids;
}

/// "frame 0012", "frames 0012, 0014 and 5 more".
inline std::string framesText(const std::vector<std::string>& ids) {
  return (ids.size() == 1 ? "frame " : "frames ") + shortList(ids);
}

/// Frame numbers named by a SPEC (docs/formats.md, "Frame SPEC"): ids or numbers, ranges ("0-5", "0,14,28"), "first:K",
/// "spread:K". Sorted and unique. InputError (place: `flag`) when it does not parse or names a frame that does not exist.
std::vector<int> parseFrames(const std::string& text, const Scene& scene, const std::string& flag);

/// A SPEC of ids and ranges of ids that names these frames in this scene; numbers stand where an id would be read as something
/// else (a comma, a range). "" for no frame.
/// @param frames  sorted and unique
std::string frameSpec(const std::vector<int>& frames, const Scene& scene);

}  // namespace glint

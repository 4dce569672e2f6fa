// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/highlight/highlight.h"
#include "core/surface/surface.h"

namespace glint {

/// One frame as the assignment sees it.
struct TrackedFrame {
  Camera camera;
  const Surface* surface = nullptr;   ///< may be null: its highlights then keep no light unless only one is on
  std::vector<std::string> lightsOn;  ///< empty = not stated
  std::vector<Highlight> highlights;
};

struct TrackOptions {
  double inlierPx =
      3;  ///< a highlight belongs to a light when its peak is this close to the mirror point that the light predicts
  int maxPairs = 3000;  ///< pairs of highlights tried as seeds
  unsigned seed = 1;    ///< of the choice of pairs when there are more
};

/// Sets the light of every highlight, in place.
///
/// A frame where one light is on gives all its highlights that light; frames that state none, in a scene that states none
/// anywhere, "light". Otherwise highlights are grouped over frames: two reflected rays from different frames intersect
/// in a candidate light (triangulation), the candidate that most frames confirm (the reflected rays that pass it, measured as the
/// angle between the ray and the direction to it, in pixels) becomes a group and its highlights are taken out; at most one per
/// surface highlight of a frame joins. A group is named by the frames' `lightsOn`: the id that is on in most of its frames and
/// that no other group has. Highlights of no group keep "".
/// @return number of groups found (0 when nothing had to be grouped).
int assignLights(std::vector<TrackedFrame>& frames, const TrackOptions& options = {});

}  // namespace glint

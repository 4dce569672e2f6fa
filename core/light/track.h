// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/highlight/highlight.h"
#include "core/surface/surface.h"

namespace glint {

/// One frame as the assignment sees it.
struct TrackedFrame {
  Camera camera;
  std::vector<std::string> lightsOn;  ///< empty = not stated
  std::vector<Highlight> highlights;  ///< a light that one of them already has is kept, and names its group
  /// To other coordinates in which a light may stand still, too: to those of the camera, or back. All frames have it or none.
  std::optional<Eigen::Isometry3d> elsewhereFromHere{};
};

struct TrackOptions {
  /// A light is confirmed by peaks this close to its mirror point; a fifth of the highlight's size is added (in squares).
  double inlierPx = 3;
  int maxPairs = 3000;  ///< pairs of highlights tried as seeds
  unsigned seed = 1;    ///< of the choice of pairs when there are more
};

/// Sets the light of every highlight, in place.
///
/// A frame where one light is on gives all its highlights that light. Otherwise highlights are grouped over frames: two reflected
/// rays from different frames meet in a candidate light, every highlight votes with its distance in pixels from the candidate's
/// mirror point (one Newton step on the surface around its peak), and the candidate with most votes (a truncated sum of squares)
/// becomes a group. When all lights are found, every highlight goes to the light whose mirror point it contains, the nearest
/// where several do, and the lights are triangulated again, until nothing changes. A light may own several highlights of a frame
/// (concave surfaces). Where frames have other coordinates, a light may stand still there: more highlights must say so than for
/// one that stands still here. A highlight that contains the mirror points of two lights is of both if the other light has no
/// highlight of its own in that frame; it belongs to neither and keeps "".
///
/// Groups are as many as the frames' `lightsOn` name. They get the names that agree best with the frames where each is on, and
/// with highlights that are named already; lights that are on in the same frames cannot be told apart, and their names are then
/// arbitrary. Where no frame states anything, all highlights are of one "light" unless they prove that there are more: another
/// light counts (named "light-2" ...) when at least 3 frames and half of those with unexplained highlights confirm it, most of
/// which show another light too; up to three may prove each other, since lamps are switched. Highlights of no group keep "".
/// @param surfaceOf  the surface that a frame sees, asked once per frame that has highlights and only where something has to be
///                   grouped; null: the frame's highlights keep no light unless only one is on.
/// @return number of groups found (0 when nothing had to be grouped).
int assignLights(std::vector<TrackedFrame>& frames, const std::function<std::shared_ptr<const Surface>(std::size_t)>& surfaceOf,
                 const TrackOptions& options = {});

}  // namespace glint

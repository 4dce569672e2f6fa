// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/advise/explain.h"
#include "core/advise/walk_trace.h"
#include "core/draw/frame_overlay.h"
#include "core/geometry/light.h"
#include "viz/style.h"

namespace glint::viz {

/// The limit-angle walk of one direction, step by step: forwards (an observed contour: on S, then on T) or inverse (a prediction:
/// on T, then on S). All pictures of the walk draw this.
struct WalkStory {
  int frame = -1;
  std::string light, model;  ///< model: of the inverse walk, else ""
  bool inverse = false;
  Camera camera;
  std::optional<double> direction;  ///< Selection::direction of its end on S; nothing if no highlight was observed
  Light lamp;
  Eigen::Vector3d along{1, 0, 0};   ///< unit, on T
  Eigen::Vector3d normal{0, 0, 1};  ///< of T, unit, towards the camera
  WalkTrace trace;

  int steps() const { return static_cast<int>(trace.onSurface.size() + trace.onPlane.size()); }
  /// The walk's place at a step; a step beyond the ends is the nearest end.
  struct Moment {
    bool onSurface = true;
    int place = 0;                                 ///< index into the trace's places on S or on T
    int visitedOnSurface = 0, visitedOnPlane = 0;  ///< places passed, this one included
  };
  Moment at(int step) const;
  const WalkPlace& place(const Moment& m) const {
    return (m.onSurface ? trace.onSurface : trace.onPlane)[static_cast<std::size_t>(m.place)];
  }
  /// The walk has reached the limit angle at this place.
  bool reached(const Moment& m) const {
    return m.place + 1 == static_cast<int>((m.onSurface ? trace.onSurface : trace.onPlane).size());
  }
  Eigen::Vector3d toEye(const WalkPlace& p) const;
  Eigen::Vector3d toLight(const WalkPlace& p) const;
  Eigen::Vector3d half(const WalkPlace& p) const;  ///< unit(L + V)
};

/// The direction that ends nearest to the selected one in the photograph, of those that arrived. Computes for milliseconds.
/// @param direction  as Selection::direction; nothing = to the right.
/// Failure: why there is no walk (no light, a model that does not walk, no direction that arrived).
Outcome<WalkStory> walkStory(const Inspection& inspection, const Explanation& explanation, bool inverse,
                             std::optional<double> direction);

/// The image points of the walk so far: where it has been on S and on T, seen by the camera, on top of an overlay of its frame.
void addWalk(const WalkStory& story, int step, FrameOverlay& overlay);

/// "on S: 3.21° of 4.77°"
std::string walkText(const WalkStory& story, int step);

/// Where both walks end: "S: 12.3 mm from P_B, T: 30.1 mm, both at 3.34°".
std::string walkEnds(const WalkStory& story);

}  // namespace glint::viz

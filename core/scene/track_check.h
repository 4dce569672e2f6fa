// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/scene/correction.h"
#include "core/scene/scene.h"
#include "core/surface/registration.h"

namespace glint {

/// Cameras and surface of a capture against the sparse points that the other program measured itself (COLMAP, NVM, Bundler): a
/// wrongly read convention moves every point away from where the photographs show it, and a mesh in another frame or unit does
/// not pass through them. nerfstudio's points come without a list of photographs that show them: cameras that have a point in
/// their image stand for those that saw it.
struct TrackCheck {
  int points = 0, observations = 0;
  bool withTracks = true;                ///< the program says which photographs show a point; else there are no observations
  int sampled = 0, inView = 0;           ///< points of a sample, and of them those inside of some image; without tracks
  int behind = 0;                        ///< observations whose point is not in front of the camera
  double medianPx = 0, p95Px = 0;        ///< distance of a projected point from where it was seen, px
  Eigen::Vector2d shiftPx{0, 0};         ///< median of seen - projected along x and y, px
  int met = 0;                           ///< points of a sample whose line of sight meets the surface
  int onSurface = 0;                     ///< of them, those that lie on it: depths agree to 1 %
  double depthRatio = 0;                 ///< median of distance to the surface / distance to the point; 0 = none met
  bool surfaceElsewhere = false;         ///< it misses most of the points; where it misses nearly all, the last finding says so
  std::vector<SeenPoint> sample;         ///< of the points, in metres, with a camera that saw each
  std::vector<std::string> findings;     ///< what looks wrong, one line each, with the likely cause
  std::optional<Correction> correction;  ///< that undoes the last finding
};

/// Nothing where the scene is no capture with sparse points. A finding where these cannot be read. InputError where the cameras
/// cannot be read again; Stopped.
std::optional<TrackCheck> checkTracks(const Scene& scene, const ProgressFn& progress = {});

}  // namespace glint

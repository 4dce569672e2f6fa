// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/transforms.h"
#include "core/highlight/highlight.h"
#include "core/scene/correction.h"

namespace glint {

/// A change of all cameras of a scene, as the highlights can be asked about it. The surface stays: a mesh that is turned or of
/// another unit is the same as cameras that move about it.
struct CameraChange {
  double cx = 0, cy = 0, logFocal = 0;  ///< added to the principal point (px) and to the logarithm of the focal length
  bool swapXY = false;                  ///< of the pixels, before the flips
  bool flipX = false, flipY = false;
  const GeometryCorrection* poses = nullptr;  ///< before the next
  Similarity camerasFromMesh = {};            ///< where the mesh belongs, from its coordinates as they were read

  Camera of(Camera camera) const;
  /// Peak and contour, in pixels of a picture of the camera's size; the contour keeps its sense.
  void move(Highlight& highlight, const Camera& camera) const;
};

/// A mistake that a user may have made, the change that undoes it, and how a person does that.
struct LikelyMistake {
  std::string subject;  ///< "the images", "the mesh"
  bool many = false;    ///< of the subject
  std::string is;       ///< "mirrored left-right", "in millimetres"
  CameraChange undoing;
  std::optional<Correction> correction;
  std::string remedy;  ///< for a person where there is no correction
};

/// Images that are mirrored or turned, meshes turned by quarters and halves about an axis, meshes of another unit or size, poses
/// of another convention, images that were resized where the principal point is their middle. Those that people meet most come
/// first: if several fit equally well, the first one is named.
const std::vector<LikelyMistake>& likelyMistakes();

}  // namespace glint

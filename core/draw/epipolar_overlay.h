// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/draw/frame_overlay.h"
#include "core/geometry/epipolar.h"

namespace glint::draw {

enum class PairCameras { Real, Virtual };
enum class PairEllipse { Observed, Canonical };

struct PairRequest {
  std::array<int, 2> frames{0, 0};
  int highlight = -1;  ///< of the first frame; -1 = its first. The second frame's is its first one of the same light
  PairCameras cameras = PairCameras::Real;
  PairEllipse ellipse = PairEllipse::Observed;
};

inline constexpr Colour kRealEpipolar{0.66, 0.86, 0.16};  ///< those of real cameras; virtual ones have kVirtualCamera

/// Tangent epipolar lines of one pair of ellipses, over both photographs: own tangents solid, those carried over from the other
/// image dashed. Neither colour is a model's.
struct EpipolarPicture {
  std::array<FrameOverlay, 2> frames;
  std::optional<EpipolarTangents> tangents;
  std::optional<Failure> failure;  ///< why the lines are missing
};

/// Virtual cameras are those of the training views; in other frames the mirror is the tangent plane of the first model that
/// predicts one. Canonical ellipses exist in training frames only. std::invalid_argument for frames that do not exist.
EpipolarPicture epipolarPicture(const Inspection& inspection, const PairRequest& request);

}  // namespace glint::draw

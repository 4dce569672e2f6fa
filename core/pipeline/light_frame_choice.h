// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/pipeline/frame_evidence.h"
#include "core/scene/light_frame.h"
#include "core/scene/scene.h"

namespace glint {

/// In which coordinates a capture's lights stand still, and what speaks for it (method.md section 16).
struct LightFrameChoice {
  LightFrame frame = LightFrame::World;  ///< the coordinates of the scene that is computed with
  std::set<std::string> elsewhere;  ///< labels of lights that stand still in the other ones, where lamps of both kinds are on
  std::string reason;               ///< for a person
  std::string doubt;  ///< what may be wrong about it: two lamps that move differently, or views that cannot tell; "" = nothing
  struct Residuals {
    std::optional<double> world, camera;  ///< px, RMS over the views; nothing where no place of the light leaves finite ones
  };
  std::map<std::string, Residuals> byLight;  ///< by the light's label

  /// In what this light stands still.
  LightFrame frameOf(const std::string& light) const;
  /// Whether a light moves with the camera.
  bool anyMoves() const { return frame == LightFrame::Camera || !elsewhere.empty(); }
};

/// Chooses by `light.frame`; `auto` decides by the training highlights alone. In each frame of coordinates it looks for the lamp
/// that the mirrored rays of the peaks share, and measures by how many pixels its brightest points miss the peaks. The camera is
/// chosen where it explains them and the world leaves several times as much. Where unknown lights differ, each gets its own
/// frame, and the scene has that of most of them. Frames with a depth map of their own are asked where no training frame has
/// another surface.
/// @param scene     in the world
/// @param surfaces  of that scene
/// @param training  frames that train
/// @param evidence  of all frames
LightFrameChoice chooseLightFrame(const Scene& scene, const SurfaceCache& surfaces, const std::vector<int>& training,
                                  const std::vector<FrameEvidence>& evidence, const Settings& settings);

}  // namespace glint

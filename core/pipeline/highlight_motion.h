// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/pipeline/frame_evidence.h"
#include "core/scene/scene.h"

namespace glint {

class PanelDepths;

/// What `detect.motion` asks for.
enum class MotionUse { Off, Flag, Reject };
MotionUse motionUse(const Settings& settings);

/// What other views say about a bright spot: paint stays on its surface point, a highlight moves over it with the camera.
struct MotionVerdict {
  enum class Kind {
    Unremarkable,  ///< it is elsewhere in other views, or nothing suggests paint
    CannotTell,    ///< it stays on its point, but a highlight might do so too
    Texture,       ///< it stays on its point where a highlight would have left it
    Waiting        ///< views that were not searched yet may decide
  };
  Kind kind = Kind::Unremarkable;
  int stays = 0;          ///< views from different sides that find it on its point, where a highlight would lie elsewhere
  int alike = 0;          ///< views that find it on its point, where a highlight would lie too, or another one does
  int away = 0;           ///< views from different sides that see the point, should find the spot there, and do not
  bool apart = false;     ///< the frame's surface is its own depth map, and that of no other view has the spot's point
  double lampWithin = 0;  ///< where stays > 0: a lamp that leaves a highlight there is nearer to the surface than this, m
  /// In words, as a reason or a flag; "" if there is nothing to say.
  std::string text() const;
};

/// The frames that are asked about the highlights of each frame: up to twelve that see the same surface, spread evenly over the
/// sequence. Frames with given highlights ask none and are not asked: a hand that labels highlights leaves the paint out. Frames
/// whose surface is their own depth map ask each other; `judgedByMotion` (depth_motion.h) takes care of that.
/// @return  by frame, sorted, without the frame itself
std::vector<std::vector<int>> motionPanels(const Scene& scene, const SurfaceCache& surfaces);

/// Tells paint from highlights by their motion over the surface (method.md section 1, "Motion").
/// With P the surface point under the middle of a contour, every other view that sees P answers by the two places
///   paint:      the contour, carried over on the surface
///   highlight:  predicted brightest points of lamps along the mirrored ray at P, from a fifth of the camera's distance to
///               infinity, at rest in the world or with the camera (which serves objects that turn before a still camera)
/// It speaks for paint if a candidate of like size and strength lies on the first, and the second is farther away than
/// twice the match's tolerance, at least 4 px; against it if the spot would be strong enough to be found at the first and is not.
/// Paint needs two views for it, three times as many as against it (views within one degree count once), and a remaining motion
/// towards the second place below what a lamp at a fiftieth of the camera's distance would cause. Nearer lamps look like paint,
/// and so does relief that the surface lacks: the text says so.
/// @param frame     whose highlights are judged; spots that the image or the silhouette cuts, or that are seen edge-on, are not
/// @param panel     see motionPanels()
/// @param evidence  of all frames, as detected; `frame` < 0 = not searched yet
/// @param surface   that these frames see; null = no verdicts
/// @param depths    where that is the frame's own depth map: views whose depth maps do not have the spot's point answer nothing
/// @return  one for each highlight of the frame, in their order
std::vector<MotionVerdict> motionVerdicts(const Scene& scene, int frame, const std::vector<int>& panel,
                                          const std::vector<FrameEvidence>& evidence, const Surface* surface,
                                          const Settings& settings, const PanelDepths* depths = nullptr);

/// Moves paint from the evidence to `rejected`, with the reason, and to `textures`. NoHighlight if none is left.
/// @param camera    of the frame: `rejected` holds measured pixels
/// @param verdicts  one for each highlight
void withholdTextures(FrameEvidence& evidence, const std::vector<MotionVerdict>& verdicts, const Camera& camera);
/// Undoes withholdTextures().
void returnTextures(FrameEvidence& evidence);
/// Another detection of the same frame (another level, lights kept apart) loses what overlaps with these textures.
void dropTextures(FrameEvidence& again, const std::vector<WithheldTexture>& textures);

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/app/ball_observation.h"
#include "core/base/image.h"
#include "core/base/outcome.h"

namespace glint {

/// Bright reflections on one ball that stay in place from photograph to photograph, such as a window's: they are not the lamps'.
struct StillReflections {
  Image mask;                                        ///< one channel, above 0 on them and close around; empty without any
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< of its first pixel in the shot
  std::vector<Eigen::Vector2d> places;               ///< their middles in the shot

  /// Whether they cover this pixel of the shot.
  bool cover(const Eigen::Vector2d& place) const;
};

/// Finds what is bright in three of four photographs. A moving lamp never stays in place for so many.
/// @param photographs  of one size, as for findLampHighlight(); fewer than two tell nothing. @param corner,ball  as there
StillReflections stillReflections(std::span<const Image> photographs, const Eigen::Vector2d& corner, const BallOutline& ball);

/// The reflection of the lamp on a mirror ball.
///
/// The lamp's image is usually clipped, and scratches, dust and lens add streaks and stars. So its place is not the
/// mean of the light, but the middle of the largest disc brighter than a level: streaks are narrower than the core and do not
/// move it. Five levels close below the top tell how reliable the place is. The least channel counts: streaks are coloured, the
/// core is not. Other bright things are dropped by name: the lamp's own streaks, smaller and dimmer things, what lies at the
/// outline, and reflections of another ball (if a distant camera sees it at the same depth; its highlights are images of the
/// lamp, too).
///
/// @param photograph  8-bit values 0 to 255 as float, 1 or 3 channels.
/// @param corner      the place of its first pixel in the shot.
/// @param balls       the outlines of all balls in the shot. @param which  the ball to look at.
/// @param still       places to ignore.
/// @return  `frame` stays empty. The covariance has the scatter of the levels and the core's shape, but nothing of the outline.
///          NoHighlight: nothing stands out, two are equal, or the largest is another ball or at the outline; Clipped:
///          as wide as a fifth of the ball's radius, no single place; OutsideImage: cut by the photograph's border; NotFinite.
Outcome<LampObservation> findLampHighlight(const Image& photograph, const Eigen::Vector2d& corner,
                                           std::span<const BallOutline> balls, std::size_t which,
                                           const StillReflections& still = {});

}  // namespace glint

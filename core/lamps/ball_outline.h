// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/lamps/observation.h"

namespace glint {

/// What the outline of a sphere needs to know of the camera: a pinhole with square pixels, lens distortion removed.
struct OutlineCamera {
  double focalPx = 0;                                   ///< > 0
  Eigen::Vector2d principal = Eigen::Vector2d::Zero();  ///< px, in the shot
};

/// The outline of one ball from its photographs by one fixed camera, to a fraction of a pixel.
///
/// Edges are the steepest places of linear light along lines across the outline, in 120 sectors of 3 degrees, in every photograph alone: with another
/// lamp other parts of the outline stand out. The values are taken as sRGB, because an edge that is blurred lies elsewhere in coded values: at half of
/// the codes between black and white stands a fifth of the light.
/// A mirror shows what is behind it along its own edge, compressed, so that many edges are reflections. They lie inside of the outline, never outside. Hence
/// in every sector the outermost edge counts that continues in its neighbours and lies near the outline; a circle (with a camera: the outline of a sphere) is
/// fitted to these with Tukey's weights, narrower inside than outside; equal ones where these find clearly more of an outline (noise).
/// What this cannot see: a rim that reflects its own background so well that nowhere and under no lamp it stands out. The outline is then too small there.
///
/// @param photographs  one or more of equal size, 8-bit values 0 to 255 as float, 1 or 3 channels.
/// @param corner       the place of their first pixel in the shot.
/// @param start        a rough outline in the shot's pixels; its centre and radius are right to a tenth of its radius. At least 8 px.
/// @param camera       where known: under perspective the outline is an ellipse. The result's circle is then that of least squares to it.
/// @return  covariance by leaving out each twelfth of the outline in turn, so that edges that go together do not count as many; `edge` has one point for
///          each sector that was used. TooFewPoints: no edge, or fewer than a third of the outline; RankDeficient: edges on one side only;
///          NotConverged: the circle found lies beyond a tenth of the radius from `start`; NotFinite; OutsideImage: no part of `start` lies in the image.
Outcome<RefinedOutline> refineBallOutline(std::span<const Image> photographs, const Eigen::Vector2d& corner,
                                          const BallOutline& start, const std::optional<OutlineCamera>& camera = {});

/// Which of two outlines counts.
struct OutlineChoice {
  RefinedOutline outline;
  std::string refused;  ///< why the one of the edges does not; empty = it does
  double withinPx =
      0;  ///< by how much it lies inside of the given one all around, where that is more than its standard deviation says; else 0
};

/// The outline of the edges where these tell it better than the one that is given is known. Where it lies inside of that all
/// around, it may be a reflection's edge within a rim that does not stand out: its radius is then uncertain by as much.
/// @param given  with its covariance
OutlineChoice chosenOutline(const Outcome<RefinedOutline>& found, const RefinedOutline& given);

}  // namespace glint

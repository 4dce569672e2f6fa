// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/app/ball_observation.h"
#include "core/base/image.h"
#include "core/base/outcome.h"

namespace glint {

/// The camera as the outline of a sphere needs it: a pinhole with square pixels, lens distortion removed.
struct OutlineCamera {
  double focalPx = 0;                                   ///< > 0
  Eigen::Vector2d principal = Eigen::Vector2d::Zero();  ///< px, in the shot
};

/// The outline of one ball from its photographs by one fixed camera, to a fraction of a pixel.
///
/// Edges are the steepest places of linear light across the outline, in 120 sectors of 3 degrees, in each photograph alone:
/// other lamps show other parts of the outline. Values count as sRGB, because a blurred edge lies elsewhere in coded values: half
/// of the codes between black and white is a fifth of the light.
/// A mirror compresses its background along its edge, so many edges are reflections, all inside of the outline. So
/// each sector's outermost edge near the outline that continues in its neighbours counts; a circle (with a camera: a sphere's
/// outline) is fitted with Tukey's weights, narrower inside than outside; with equal ones if these find clearly more outline
/// (noise). Blind spot: a rim that mirrors its background so well that it stands out under no lamp. The outline is then too small
/// there.
///
/// @param photographs  one or more of equal size, 8-bit values 0 to 255 as float, 1 or 3 channels.
/// @param corner       the place of their first pixel in the shot.
/// @param start        a rough outline in the shot's pixels, right to a tenth of its radius in centre and radius. At least 8 px.
/// @param camera       if known: under perspective the outline is an ellipse, and the result's circle its least-squares circle.
/// @return  covariance by leaving out each twelfth of the outline in turn, as neighbouring edges go together; `edge` has
///          one point per sector used. TooFewPoints: no edge, or below a third of the outline; RankDeficient: edges on one side
///          only; NotConverged: moved by over a tenth of the radius; NotFinite; OutsideImage: no part of `start` is in the image.
Outcome<RefinedOutline> refineBallOutline(std::span<const Image> photographs, const Eigen::Vector2d& corner,
                                          const BallOutline& start, const std::optional<OutlineCamera>& camera = {});

/// Which of two outlines counts.
struct OutlineChoice {
  RefinedOutline outline;
  std::string refused;  ///< why the outline of the edges does not count; empty = it does
  /// How far it lies inside of the given one all around, if more than its standard deviation; else 0.
  double withinPx = 0;
};

/// The outline of the edges, if they determine it better than the given one is known. If it lies inside of that all
/// around, it may be a reflection's edge within a rim that does not stand out: its radius is then uncertain by as much.
/// @param given  with its covariance
OutlineChoice chosenOutline(const Outcome<RefinedOutline>& found, const RefinedOutline& given);

/// The circle through three points of a ball's rim, px: its centre is the point at equal distances from them.
/// @return  RankDeficient if they lie on a line, or so nearly that the circle is a million times their distance; NotFinite
Outcome<BallOutline> circleThrough(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/progress.h"
#include "core/geometry/camera.h"
#include "core/geometry/ellipsoid.h"
#include "core/scene/light_frame.h"

namespace glint {

/// A highlight that was found and not used for a lamp.
struct DroppedSighting {
  std::string frame;                ///< id
  std::optional<std::size_t> ball;  ///< index; none in a scene
  Pixel place{0, 0};                ///< px, measured
  std::string reason;               ///< in words
  /// Unit, towards the lamp if this reflection is the lamp's after all; nothing if it cannot be.
  std::optional<Eigen::Vector3d> direction = {};
};

/// How large a reflection makes its lamp appear from the ball.
struct LampExtent {
  double longDeg = 0, shortDeg = 0;  ///< sides of the least rectangle around it
  double filled = 0;                 ///< share of that: pi / 4 of an ellipse, 1 of a window
};

/// How the directions to one lamp from the two balls that are farthest apart differ, degrees: along the line between the balls a
/// near lamp makes a difference, across it only errors do.
struct Parallax {
  std::size_t from = 0, to = 0;  ///< indices of the balls
  double alongDeg = 0, acrossDeg = 0;
};

/// What one ball says about a lamp on its own.
struct LampSighting {
  std::size_t ball = 0;
  Pixel peak{0, 0};                                       ///< px, measured
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  ///< along the mirrored ray, unit
  Eigen::Vector2d residualPx = Eigen::Vector2d::Zero();   ///< of the fit: seen less predicted
  bool clipped = false;
  std::optional<LampExtent> extent;  ///< nothing without a contour on the ball
  /// Predicted less seen from the other balls alone, outlines refined without this lamp, px; and the directions' difference.
  std::optional<Eigen::Vector2d> leftOutPx;
};

/// Where a lamp is, or why that is unknown. Directions are unit vectors from `from`; in the coordinates of `frame` (of balls: the
/// camera's).
struct LampAnswer {
  std::string id;
  std::vector<std::string> frames;            ///< ids
  std::optional<LightFrame> frame;            ///< in which the lamp of a scene stands still
  std::string frameReason;                    ///< why, in words
  std::optional<Failure> failure;             ///< then nothing below is known but `dropped`
  std::optional<Eigen::Vector3d> position;    ///< where the data determine a distance
  std::optional<Eigen::Matrix3d> covariance;  ///< of the position
  std::string withoutPosition;                ///< why there is no position, in words; "" with one
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();
  double directionSigma = 0;            ///< rad: root of the mean square of the angle between this direction and the true one
  std::optional<Eigen::Vector3d> from;  ///< middle of the object; none without a focal length
  double residualPx = 0;                ///< root mean square over the highlights; 0 where nothing is redundant
  double degreesOfFreedom = 0;          ///< behind the residual; 0 where nothing is redundant or nothing is known of it
  int highlights = 0;                   ///< used
  /// Photographs of balls: the share that this photograph's highlights add to all outlines; the edges add the rest, up to 1.
  std::optional<double> outlineShare;
  std::vector<DroppedSighting> dropped;
  std::vector<LampSighting> sightings;  ///< photographs of balls only
  std::optional<Parallax> parallax;
  std::string solver;                ///< of a scene: "pixels", "contours", "bundle", "triangulated", "mirror rays"
  std::vector<std::string> remarks;  ///< what makes the answer doubtful, in words
};

// Where a lamp is with a probability of 95 %, if its errors are normal and as large as its covariance says.

/// { x : (x - p)^T C^-1 (x - p) <= q }, q the 95 % quantile of chi squared with 3 degrees of freedom. World units.
/// @return  NotReached without a position; what Ellipsoid::fromCentreAndShape says of the covariance.
Outcome<Ellipsoid> positionRegion(const LampAnswer& lamp);

/// Radius of the cone that holds the true direction, rad: with two equal coordinates P(angle > t) = exp(-t^2 / sigma^2),
/// sigma the rms angle. @return  at most pi; 0 without a spread.
double directionRegion(const LampAnswer& lamp);

struct Inspection;
/// Where the lights of a scene are, from the highlights of its frames. The true lights that the scene may hold are not read.
///
/// For each light: drops by name views whose mirrored rays contradict others (least median of the angles over pairs of rays). The
/// rest goes through the fit of `evaluate`, the reflectance model of pixels or contours, which knows that a rough surface is not
/// brightest where it mirrors the light. If that fails, through the contours' bundle; else the mean of the mirrored rays gives a
/// direction. A position is given if the inverse distance is five standard deviations from 0, seen from the middle of the object.
/// @param inspection  of inspect() without models: evidence and views of all frames that count
/// @return  one answer for each light that a frame names or shows, in the order of the frames; `id` is the light's. World, m.
///          Failures of single lamps: NoHighlight, PeakOffSurface and what else became of its views. Throws Stopped.
std::vector<LampAnswer> lampsOfScene(const Inspection& inspection, const ProgressFn& progress = {});

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/geometry/camera.h"

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

/// Where a lamp is, or why that is unknown. Directions are unit vectors from `from`; world frame (of balls: the camera's).
struct LampAnswer {
  std::string id;
  std::vector<std::string> frames;            ///< ids
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

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"

// What photographs of mirror balls say about lamps. Pixels are Glint's: (0, 0) is the centre of the first pixel, y points down;
// where a photograph is a cut-out of a shot, all places are those of the shot.
namespace glint {

/// The outline of a ball in a photograph, as a circle. Under perspective it is an ellipse: `ball_outline.h` has both.
struct BallOutline {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< px
  double radius = 0;                                 ///< px, > 0
};

/// A point that was seen on the edge of a ball, with the standard deviation along the outline's normal.
struct EdgePoint {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< px
  double sigmaPx = 0;
};

/// The outline of one ball, measured in one photograph or in all photographs of one fixed camera.
struct RefinedOutline {
  BallOutline outline;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (centre x, centre y, radius), px^2
  std::vector<EdgePoint> edge;                           ///< the points that were used
  double residualPx = 0;                                 ///< rms along the normal
  int degreesOfFreedom = 0;                              ///< points used less parameters
};

/// Something bright on a ball that is not the lamp's reflection, or not surely so.
struct DroppedHighlight {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< px
  std::string reason;                               ///< in words: "smaller than the brightest", "reflection of the other ball"
  bool onlySmaller = false;  ///< nothing but its size speaks against it: only motion tells a lamp from a window that is larger
};

/// Where one lamp is reflected by one known object in one photograph.
struct LampObservation {
  std::string frame;                                     ///< name of the photograph
  std::size_t object = 0;                                ///< index of the ball
  Eigen::Vector2d peak = Eigen::Vector2d::Zero();        ///< px
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the peak, px^2
  std::vector<Eigen::Vector2d> contour;                  ///< px, at the level that the peak was taken from; may be empty
  bool clipped = false;
  std::vector<DroppedHighlight> dropped;
};

}  // namespace glint

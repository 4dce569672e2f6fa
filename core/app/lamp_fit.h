// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/app/ball_observation.h"
#include "core/app/lamp_answer.h"
#include "core/app/mirror_ball.h"

namespace glint {

/// What photographs of mirror balls by one fixed camera show. Places are measured pixels; the fit takes a camera's lens off.
struct BallPhotographs {
  std::optional<Camera> camera;       ///< at the origin; none: distant, rays parallel to z
  bool focalAlone = false;            ///< of the camera only the focal length is known, and that roughly: then directions only
  std::optional<double> ballRadius;   ///< m, of every ball; none: lengths are in radii
  std::vector<RefinedOutline> balls;  ///< without `edge` where an outline was taken as given
  std::vector<LampObservation> seen;  ///< at most one for each photograph and ball; every photograph has one lamp
};

/// A ball as the fit leaves it.
struct FittedBall {
  Eigen::Vector3d parameters = Eigen::Vector3d::Zero();  ///< see ballOf()
  Eigen::Vector3d sigmaPx = Eigen::Vector3d::Zero();
  Eigen::Vector3d shiftPx = Eigen::Vector3d::Zero();  ///< from what the photographs' edges say
  std::optional<Eigen::Vector3d> centre;              ///< with a camera; m or radii
  std::vector<Pixel> outline;                         ///< once around, as the photographs show it: measured px
  double edgeResidualPx = 0;     ///< rms of the edge's points along the outline's normal; 0 where the outline was taken as given
  int edgeDegreesOfFreedom = 0;  ///< of those
  int highlights = 0;            ///< on this ball that were used
  double highlightResidualPx = 0;  ///< their rms: seen less predicted
  /// What the fit leaves free of their coordinates: the sum over them of 1 less the leverage, so that those of all balls, and of
  /// the outlines, add up to those of the fit.
  double highlightDegreesOfFreedom = 0;
};

struct BallLamps {
  /// One for each photograph that shows something, in the order of `seen`; the caller sets the id.
  std::vector<LampAnswer> lamps;
  std::vector<FittedBall> balls;
  double noiseFactor = 1;  ///< the residuals over what their covariances promise, at least 1; all covariances contain its square
  int degreesOfFreedom = 0;  ///< of that
};

/// All lamps and outlines in one fit: minimises sum |W (u - u(L_i, B_k))|^2 + |z|^2 over the lamps L_i (direction and inverse
/// distance, which may be 0) and the outlines B_k = B_k0 + root(covariance) z_k by Gauss-Newton; a QR per lamp eliminates its
/// unknowns, so that the effort grows linearly with lamps. u(L, B) is the mirror point. With one ball, lamps count as distant.
///
/// Drops a peak that contradicts the others if three or more balls tell which one; with two balls another bright place seen on
/// one of them may agree, else the lamp has no answer. A distance is given if its inverse is five standard deviations from 0.
/// @param refineOutlines  false: outlines stay, but their uncertainty counts
/// @return  TooFewPoints without balls or highlights; failures of ballParameters(). Single lamps: PeakOffSurface, NotConverged.
Outcome<BallLamps> fitBallLamps(const BallPhotographs& photographs, bool refineOutlines = true);

}  // namespace glint

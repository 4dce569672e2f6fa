// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/lamps/lamp_answer.h"
#include "core/lamps/mirror_ball.h"
#include "core/lamps/observation.h"

namespace glint {

/// What photographs of mirror balls by one fixed camera show. Places are measured pixels; with a camera that has a lens they are freed of it here.
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
  std::vector<LampAnswer>
      lamps;  ///< one for each photograph that something was seen in, in the order of `seen`; the id is left to the caller
  std::vector<FittedBall> balls;
  double noiseFactor = 1;  ///< the residuals over what their covariances promise, at least 1; all covariances contain its square
  int degreesOfFreedom = 0;  ///< of that
};

/// All lamps and all outlines in one fit: minimises sum |W (u - u(L_i, B_k))|^2 + |z|^2 over the lamps L_i (direction and inverse distance, so that a lamp may
/// lie at infinity) and the outlines B_k = B_k0 + root(covariance) z_k by Gauss and Newton; a QR for each lamp eliminates its unknowns, so the effort grows in proportion to the lamps.
/// u(L, B) is the mirror point. One ball alone leaves the distance of a lamp open: it is then taken as distant.
///
/// A peak that contradicts the others is dropped where three balls or more tell which one it is; of two balls another bright place that was
/// seen on one of them may agree, else the lamp has no answer. A distance is given where its inverse is five standard deviations from 0.
/// @param refineOutlines  false: outlines stay, their uncertainty counts all the same
/// @return  TooFewPoints without balls or highlights; what ballParameters() says. Lamps fail one by one: PeakOffSurface, NotConverged.
Outcome<BallLamps> fitBallLamps(const BallPhotographs& photographs, bool refineOutlines = true);

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/app: the least squares behind fitBallLamps().

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/app/mirror_ball.h"

namespace glint {

/// One peak that counts for a lamp.
struct WeightedPeak {
  std::size_t ball = 0;
  Pixel peak{0, 0};                                    ///< ideal px
  Eigen::Matrix2d root = Eigen::Matrix2d::Identity();  ///< W: W^T W is the inverse of the peak's covariance
};

/// A lamp and its peaks. Unknowns: two of the direction in its tangent plane and, if free, the inverse distance times the scale.
struct LampUnknowns {
  AimedLamp lamp;
  bool distanceFree = false;
  std::vector<WeightedPeak> peaks;
  Eigen::Index count() const { return distanceFree ? 3 : 2; }
};

class LampProblem {
 public:
  /// @param scale  length by which inverse distances become numbers of about 1 or less
  LampProblem(BallProjection view, std::vector<BallParameters> balls, double scale);

  const BallProjection& view() const { return view_; }
  double scale() const { return scale_; }
  /// Outlines: value + root(covariance) z.
  const Eigen::VectorXd& outlines() const { return z_; }
  void setOutlines(const Eigen::VectorXd& z) { z_ = z; }
  Eigen::Vector3d parametersOf(std::size_t ball) const;
  Eigen::Vector3d shiftOf(std::size_t ball) const { return roots_[ball] * z_.segment<3>(3 * static_cast<Eigen::Index>(ball)); }
  const Eigen::Matrix3d& rootOf(std::size_t ball) const { return roots_[ball]; }
  MirrorBall ball(std::size_t k) const { return ballOf(view_, parametersOf(k)); }

  /// Seen less predicted, px, whitened; two rows a peak. Nothing if a ball does not show the lamp.
  std::optional<Eigen::VectorXd> residuals(const LampUnknowns& lamp) const;

  /// The equations of one lamp, rotated so that the first rows alone hold its unknowns: [R T | t; 0 E | e] (dl, dz) = residuals.
  struct Eliminated {
    Eigen::MatrixXd own, outlinesOwn, outlinesRest;  ///< R, T, E
    Eigen::VectorXd right, rest;                     ///< t, e
    Eigen::MatrixXd redundant;  ///< residuals x redundant equations: e = redundant^T residuals, columns of length 1
  };
  std::optional<Eliminated> eliminated(const LampUnknowns& lamp) const;
  /// Whether two balls with peaks stand apart. If cut-outs have no places in the shot, all balls are in one place.
  bool standApart(const LampUnknowns& lamp) const;
  /// Whether the peaks say anything about the lamp's distance, beyond round-off.
  bool tellsDistance(const LampUnknowns& lamp) const;

  /// Moves the lamps and, if asked, the outlines to the least sum of squares. False if it does not converge.
  bool solve(std::vector<LampUnknowns>& lamps, bool outlinesToo);

  /// Covariance of z, (I + sum E^T E)^-1, and the step to the least sum of squares, for all lamps but `without`.
  struct OutlineSystem {
    Eigen::MatrixXd covariance;
    Eigen::VectorXd step;
  };
  OutlineSystem outlineSystem(const std::vector<Eliminated>& lamps, std::optional<std::size_t> without = {}) const;

  static void move(LampUnknowns& lamp, const Eigen::VectorXd& by, double scale);

 private:
  double costOf(const std::vector<LampUnknowns>& lamps) const;
  BallProjection view_;
  std::vector<BallParameters> balls_;
  std::vector<Eigen::Matrix3d> roots_;
  double scale_;
  Eigen::VectorXd z_;
};

}  // namespace glint

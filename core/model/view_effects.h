// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/camera.h"

namespace glint {

/// Smooth shapes by which the contour of a whole view may be off, as orthonormal columns over its points: an offset (1), shifts (2) and
/// stretches (2) by the direction of the normal, then harmonics of the arc length. Groups of columns count as one size of error each.
struct ContourShapes {
  static constexpr int kGroups = 5;
  static constexpr int kCount = 19;  ///< columns at most; fewer where a contour has few points
  Eigen::MatrixXd columns;           ///< points x shapes, orthonormal
  std::vector<int> group;            ///< of each column, 0 .. kGroups - 1
};
/// @param normals  unit, outwards. @param arc  arc length at each point, as a share of the whole, in [0, 1); increasing, starting anywhere.
ContourShapes contourShapes(const std::vector<Pixel>& normals, const std::vector<double>& arc);

/// One training view: signed distances of measured points from the predicted contour (px, outwards), how that contour moves with the
/// parameters (points x parameters, px), and the shapes of its error.
struct ViewResiduals {
  Eigen::VectorXd residual;
  Eigen::MatrixXd byParameter;
  ContourShapes shapes;
};

/// What the residuals of a fit say about noise of single points and about errors that whole views have in common: poses, bumps of the
/// surface, a model that does not quite fit. Residuals are r = J d + sum_g S_g u_g + e: parameters d, an error u_g of every view in each group of
/// shapes (independent between views up to `shared`, variance tau_g^2 per shape) and noise e. The variances are the moment estimates
/// (Henderson's third method): the expected squares of the residuals in every group, after the parameters took their share, equal
/// the ones seen. Groups in which noise alone explains the squares (F test, 5 %) count as none.
/// @see Searle, Casella, McCulloch, Variance Components, 1992, chapter 5; Satterthwaite, Biometrics 2, 1946, for the degrees of freedom.
class ViewEffects {
 public:
  /// @param robustPx  scale of the fit's Huber loss, px. Needs one view with residuals, all of equally many parameters.
  ViewEffects(const std::vector<ViewResiduals>& views, double robustPx);

  double noisePx() const { return noise_; }     ///< standard deviation of one point
  double viewPx() const;                        ///< RMS over the contour of what a whole view is off by
  double freedom(int group) const { return freedom_[group]; }
  double variance(int group) const { return variance_[group]; }  ///< tau^2, px^2: mean square over the contour per shape
  double shared() const { return shared_; }     ///< 0 .. 1: how far the views' errors are one and the same

  /// Variance of a predicted contour at its points, px^2, with the degrees of freedom of that estimate: of the parameters and of the
  /// view's own error. @param byParameter  points x parameters. @param shapes  of this contour.
  struct Variance {
    std::vector<double> px2, freedom;
  };
  Variance at(const Eigen::MatrixXd& byParameter, const ContourShapes& shapes) const;

 private:
  double noise_ = 0, noiseFreedom_ = 1, shared_ = 0;
  double variance_[ContourShapes::kGroups] = {}, freedom_[ContourShapes::kGroups] = {};
  Eigen::MatrixXd byNoise_;                          ///< covariance of the parameters for unit noise
  Eigen::MatrixXd byGroup_[ContourShapes::kGroups];  ///< and for unit tau^2
};

}  // namespace glint

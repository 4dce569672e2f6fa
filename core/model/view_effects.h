// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/camera.h"
#include "core/model/view_correlation.h"

namespace glint {

/// Smooth shapes by which the contour of a whole view may be off, as orthonormal columns over its points: an offset (1), shifts
/// (2) and stretches (2) by the direction of the normal, then harmonics of the arc length. Groups of columns count as one size of
/// error each.
struct ContourShapes {
  static constexpr int kGroups = 5;
  static constexpr int kCount = 19;  ///< columns at most; fewer where a contour has few points
  Eigen::MatrixXd columns;           ///< points x shapes, orthonormal
  std::vector<int> group;            ///< of each column, 0 .. kGroups - 1
};
/// @param normals  unit, outwards. @param arc  arc length at each point, as a share of the whole, in [0, 1); increasing,
///                 starting anywhere.
ContourShapes contourShapes(const std::vector<Pixel>& normals, const std::vector<double>& arc);

/// One training view: signed distances of measured points from the predicted contour (px, outwards), how that contour moves with
/// the parameters (points x parameters, px), and the shapes of its error.
struct ViewResiduals {
  Eigen::VectorXd residual;
  Eigen::MatrixXd byParameter;
  ContourShapes shapes;
  Eigen::VectorXd where;  ///< place of the view, in any unit, which tells neighbours; empty: all are independent
};

/// What the residuals of a fit say about noise of single points and about errors that whole views have in common: poses, bumps of
/// the surface, a model that does not quite fit. Residuals are r = J d + sum_g S_g u_g + e: parameters d, an error u_g of every
/// view in each group of shapes (variance tau_g^2 per shape) and noise e. The variances are the moment estimates (Henderson's
/// third method) for errors that are independent between views: the expected squares of the residuals in every group, after the
/// parameters took their share, equal the ones seen. Groups in which noise alone explains the squares (F test, 5 %) count as
/// zero. Offset, shift and stretch may be correlated in neighbouring views, as bumps of a surface make them: the parameters then
/// take most of the error, and a prediction far from the training views is off by more than their residuals show.
/// view_correlation.h tells over which distances; all of them count by their share of the evidence.
/// @see Searle, Casella, McCulloch, Variance Components, 1992, chapter 5; Satterthwaite, Biometrics 2, 1946, for the degrees of
///   freedom.
class ViewEffects {
 public:
  /// @param robustPx  scale of the fit's Huber loss, px. Needs one view with residuals, all of equally many parameters.
  ViewEffects(const std::vector<ViewResiduals>& views, double robustPx);

  double noisePx() const { return noise_; }  ///< standard deviation of one point
  double viewPx() const;                     ///< RMS over the contour of a whole view's error
  double freedom(int group) const;           ///< of the estimate of its variance
  double variance(int group) const;          ///< tau^2, px^2: mean square over the contour per shape

  /// Standard deviation of a predicted contour at its points, px, in the sense that 1.96 of it hold 95 %: noise and errors of
  /// views count with Student's factor for their degrees of freedom, the lengths over which errors are correlated as a mixture.
  /// @param byParameter  points x parameters
  /// @param shapes       of this contour
  /// @param where        place of the view, as for the training views
  std::vector<double> sigmaPx(const Eigen::MatrixXd& byParameter, const ContourShapes& shapes,
                              const Eigen::VectorXd& where) const;

 private:
  /// All that holds if errors are correlated over one length.
  struct Case {
    double length = 0, weight = 1;
    double variance[ContourShapes::kGroups] = {}, freedom[ContourShapes::kGroups] = {};
    Eigen::MatrixXd byGroup[ContourShapes::kGroups];  ///< covariance of the parameters for unit tau^2
  };
  static void borrow(Case& c);
  static double likeness(const Case& c, const Eigen::VectorXd& a, const Eigen::VectorXd& b);
  void addPlaces(const std::vector<ViewCoefficients>& views);
  void addCases(const std::vector<ViewCoefficients>& views, const Case& independent, double noise2);
  void addParameters(Case& c) const;
  double mean(double (*of)(const Case&, int), int group) const;

  double noise_ = 0, noiseFreedom_ = 1;
  Eigen::MatrixXd byNoise_;  ///< covariance of the parameters for unit noise
  std::vector<Case> cases_;
  std::vector<Eigen::VectorXd> where_;    ///< of the training views
  std::vector<Eigen::MatrixXd> movedBy_;  ///< per shape: the parameters' error by that shape's error, parameters x views
  std::vector<int> groupOfShape_;
};

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace glint {

/// Correlation of the errors of two views at this distance: Matern's kernel of order 3/2.
/// @param length  0: views are independent; infinite: all have one and the same error
double viewCorrelation(double distance, double length);

/// One training view in the shapes of its contour's error.
struct ViewCoefficients {
  Eigen::VectorXd value;        ///< of the residuals along each (orthonormal) shape, px
  Eigen::MatrixXd byParameter;  ///< shapes x parameters
  std::vector<int> group;       ///< of each shape
  double points = 0;            ///< of the contour
  Eigen::VectorXd where;        ///< place of the view, in any unit
};

/// What the residuals say if the errors of views are correlated over `length`.
struct CorrelatedEffects {
  double length = 0;
  double weight = 1;         ///< share of the evidence; of all lengths together 1
  Eigen::VectorXd variance;  ///< of each group asked for, tau^2, px^2
  Eigen::VectorXd freedom;   ///< degrees of freedom of each
};

/// Variances of the groups, and the weight of the lengths, by restricted maximum likelihood: z = J d + u + e with d free, u of
/// covariance tau_g^2 N K(length) within a group's shape across views, e noise of known variance. The lengths tried are 0, from
/// the distance of neighbouring views to four times the extent of all, and infinity. Only the length 0, with the variances as
/// given, for fewer than four views or views at one place.
/// @param groups  which to estimate; the others have no error. @param start  positive, one for each.
/// @see Patterson, Thompson, Biometrika 58, 1971 (the likelihood); Zhou, Hu, Zhou, Lange, MM algorithms for variance components,
///   2019 (the iteration); Rasmussen, Williams, Gaussian Processes for Machine Learning, 2006, 4.17 (the kernel).
std::vector<CorrelatedEffects> correlatedEffects(const std::vector<ViewCoefficients>& views, const std::vector<int>& groups,
                                                 const Eigen::VectorXd& start, double noiseVariance);

}  // namespace glint

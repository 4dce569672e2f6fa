// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

namespace glint {

/// First-order uncertainty of estimated parameters: from the Jacobian at the solution (by QR, never by normal equations), scaled
/// by the noise that the residuals show. It knows the noise only, not what a model gets wrong about the world.
struct ParameterUncertainty {
  Eigen::MatrixXd root;         ///< parameters x k; covariance = root root^T. Each column is a change of one standard deviation
  double noisePx = 0;           ///< standard deviation of one contour point across the contour, estimated from the residuals
  double degreesOfFreedom = 0;  ///< of that estimate
};

/// Neighbouring parameters with a name: which rows of a root, or entries of a change, are theirs.
struct ParameterBlock {
  int first = 0, size = 0;
  template <class Matrix>
  auto of(Matrix& m) const {
    return m.middleRows(first, size);
  }
  template <class Matrix>
  bool isIn(const Matrix& m) const {
    return m.rows() >= first + size;
  }
};

/// The uncertainty of u = y / |y| and further parameters, from that of y: d(y / |y|) = (I - u u^T) dy / |y|.
/// @param y  not zero. @param dy  4 x k and @param others  rows x k: columns of the root as in ParameterUncertainty.
/// @return root of 4 + rows parameters; nothing if it is not finite.
std::optional<ParameterUncertainty> uncertaintyOfUnit(const Eigen::Vector4d& y, const Eigen::MatrixXd& dy,
                                                      const Eigen::MatrixXd& others, double noisePx, double degreesOfFreedom);

/// Half width, in standard deviations, of the interval that holds `coverage` of a Student distribution: 1.96 for 95 % and many
/// degrees of freedom, more where few residuals tell the noise. std::invalid_argument unless 0 < coverage < 1 and dof > 0.
double studentFactor(double coverage, double degreesOfFreedom);

}  // namespace glint

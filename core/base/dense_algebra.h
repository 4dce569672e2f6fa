// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <Eigen/SVD>

/// Decompositions of dense matrices of any size, compiled once in dense_algebra.cpp. Eigen's are templates: every fixed size from
/// about 6 x 6 on would compile all of it again, 10 s each, and at these sizes runs no faster. 2 x 2 and 3 x 3 stay fixed.
/// Jacobi's singular value decomposition gives small singular values to their own relative accuracy.
extern template class Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::ColPivHouseholderQRPreconditioner>;
extern template class Eigen::HouseholderQR<Eigen::MatrixXd>;

namespace glint {

/// R of rows = Q R by Householder's reflections, columns x columns, upper triangular: what a least-squares problem needs of its
/// rows, without the normal equations. @param rows  at least as many rows as columns (throws std::invalid_argument)
Eigen::MatrixXd triangularFactor(const Eigen::MatrixXd& rows);

}  // namespace glint

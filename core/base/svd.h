// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SVD>

/// Jacobi's singular value decomposition (small singular values to their own relative accuracy) is compiled once, in svd.cpp. Matrices from 6 x 6
/// on use this size-free one: every fixed size would compile all of it again, 10 s each. 2 x 2 and 3 x 3 stay fixed.
extern template class Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::ColPivHouseholderQRPreconditioner>;

// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/svd.h"

template class Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::ColPivHouseholderQRPreconditioner>;

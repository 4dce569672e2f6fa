// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/dense_algebra.h"

#include "core/base/outcome.h"

template class Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::ColPivHouseholderQRPreconditioner>;
template class Eigen::HouseholderQR<Eigen::MatrixXd>;

namespace glint {

Eigen::MatrixXd triangularFactor(const Eigen::MatrixXd& rows) {
  require(rows.rows() >= rows.cols(), "triangularFactor: fewer rows than columns");
  return Eigen::HouseholderQR<Eigen::MatrixXd>(rows).matrixQR().topRows(rows.cols()).triangularView<Eigen::Upper>();
}

}  // namespace glint

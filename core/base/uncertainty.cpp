// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/uncertainty.h"

#include <Eigen/Geometry>
#include <boost/math/distributions/students_t.hpp>
#include <utility>

#include "core/base/outcome.h"

namespace glint {

std::optional<ParameterUncertainty> uncertaintyOfUnit(const Eigen::Vector4d& y, const Eigen::MatrixXd& dy,
                                                      const Eigen::MatrixXd& others, double noisePx, double degreesOfFreedom) {
  require(dy.rows() == 4 && dy.cols() == others.cols(), "uncertaintyOfUnit: sizes");
  const Eigen::Vector4d u = y.normalized();
  ParameterUncertainty result;
  result.root.resize(4 + others.rows(), others.cols());
  result.root.topRows<4>() = (dy - u * (u.transpose() * dy)) / y.norm();
  result.root.bottomRows(others.rows()) = others;
  result.noisePx = noisePx;
  result.degreesOfFreedom = degreesOfFreedom;
  return result.root.allFinite() ? std::optional(std::move(result)) : std::nullopt;
}

double studentFactor(double coverage, double degreesOfFreedom) {
  require(coverage > 0 && coverage < 1 && degreesOfFreedom > 0, "studentFactor: coverage in (0, 1), dof > 0");
  return boost::math::quantile(boost::math::complement(boost::math::students_t(degreesOfFreedom), 0.5 * (1 - coverage)));
}

}  // namespace glint

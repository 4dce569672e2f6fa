// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/uncertainty.h"

#include <boost/math/distributions/students_t.hpp>

#include "core/base/outcome.h"

namespace glint {

double studentFactor(double coverage, double degreesOfFreedom) {
  require(coverage > 0 && coverage < 1 && degreesOfFreedom > 0, "studentFactor: coverage in (0, 1), dof > 0");
  return boost::math::quantile(boost::math::complement(boost::math::students_t(degreesOfFreedom), 0.5 * (1 - coverage)));
}

}  // namespace glint

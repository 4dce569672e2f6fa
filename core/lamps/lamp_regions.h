// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/outcome.h"
#include "core/geometry/ellipsoid.h"
#include "core/lamps/lamp_answer.h"

// Where a lamp is with a probability of 95 %, if its errors are normal and as large as its covariance says.
namespace glint {

/// { x : (x - p)^T C^-1 (x - p) <= q }, q the 95 % quantile of chi squared with 3 degrees of freedom. World units.
/// @return  NotReached without a position; what Ellipsoid::fromCentreAndShape says of the covariance.
Outcome<Ellipsoid> positionRegion(const LampAnswer& lamp);

/// Radius of the cone that holds the true direction, rad: with two equal coordinates P(angle > t) = exp(-t^2 / sigma^2),
/// sigma the rms angle. @return  at most pi; 0 without a spread.
double directionRegion(const LampAnswer& lamp);

}  // namespace glint

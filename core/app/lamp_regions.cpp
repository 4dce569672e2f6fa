// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/app/lamp_answer.h"

namespace glint {

namespace {
constexpr double kOutside = 0.05;  // a region of 95 %, as everywhere in the program
constexpr double kChiSquared =
    7.814727903251179;  // 95 % quantile with 3 degrees of freedom (tables of chi squared; scipy agrees)
}  // namespace

Outcome<Ellipsoid> positionRegion(const LampAnswer& lamp) {
  if (lamp.failure || !lamp.position || !lamp.covariance) return Failure{Reason::NotReached, "the lamp has no position"};
  return Ellipsoid::fromCentreAndShape(*lamp.position, kChiSquared * *lamp.covariance);
}

double directionRegion(const LampAnswer& lamp) {
  const double angle = lamp.directionSigma * std::sqrt(-std::log(kOutside));
  return std::isfinite(angle) ? std::clamp(angle, 0.0, std::numbers::pi) : std::numbers::pi;
}

}  // namespace glint

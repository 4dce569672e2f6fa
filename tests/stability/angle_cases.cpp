// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numbers>

#include "core/geometry/light.h"
#include "tests/stability/cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/real.h"

namespace glint::stability {
namespace {

/// alpha at a surface point whose normal is turned by `alpha` (exact sines and cosines) out of the plane of reflection.
Outcome<Measured> angleCase(double alpha, double grazing, const Light& light, const Eigen::Vector3d& point, double tolerance) {
  (void)tolerance;
  const double theta = grazing * std::numbers::pi / 180;
  const Eigen::Vector3d toLight = light.directionFrom(point);
  // A normal at `theta` from the light, then the mirrored eye; the normal is then turned by alpha about the light's plane.
  const Eigen::Vector3d side = toLight.unitOrthogonal();
  const Eigen::Vector3d mirror = (std::cos(theta) * toLight + std::sin(theta) * side).normalized();
  const Eigen::Vector3d toEye = (2 * mirror.dot(toLight) * mirror - toLight).normalized();
  const Eigen::Vector3d normal = (std::cos(alpha) * mirror + std::sin(alpha) * toLight.cross(side)).normalized();
  const Lamp<Real> lamp{exactly<Real>(light.homogeneous().head<3>()), Real(light.homogeneous().w())};
  const Real reference = halfAngle(exactly<Real>(normal), lamp.from(exactly<Real>(point)), exactly<Real>(toEye));
  const double value = incidentAngle(normal, toLight, toEye);
  const double condition = 1 / alpha / std::cos(theta);
  return Measured{static_cast<double>(abs(Real(value) - reference) / reference), condition};
}

}  // namespace

void addAngleCases(Cases& cases) {
  const Light near = Light::at({0.4, -0.3, 2});
  const auto add = [&](const std::string& name, double parameter, double alpha, double grazing, const Light& light,
                       const Eigen::Vector3d& point) {
    Case c;
    c.stage = "incident angle";
    c.name = name;
    c.parameter = parameter;
    // The unit vectors are doubles: alpha itself is known to round-off of 1, and L + V to that over its length.
    c.tolerance = std::max(1e-9, 8 * kRound / alpha / std::cos(grazing * std::numbers::pi / 180));
    if (c.tolerance > 1e-9) c.note = "8 units of round-off of the unit vectors, over alpha; acos would lose half the digits";
    c.run = [=] { return angleCase(alpha, grazing, light, point, 0); };
    cases.push_back(c);
  };
  add("alpha 1e-3 rad", 1e-3, 1e-3, 20, near, {0, 0, 0});
  add("alpha 1e-8 rad, where acos gives 0", 1e-8, 1e-8, 20, near, {0, 0, 0});
  add("grazing 80 degrees", 80, 0.1, 80, near, {0, 0, 0});
  add("grazing 85 degrees", 85, 0.1, 85, near, {0, 0, 0});
  add("grazing 89.9 degrees", 89.9, 0.1, 89.9, near, {0, 0, 0});
  add("light at 1e-2 m", 1e-2, 0.1, 20, Light::at({0.004, -0.003, 0.009}), {0, 0, 0});
  add("light at 1e9 m", 1e9, 0.1, 20, Light::at({4e8, -3e8, 9e8}), {0.3, 0.2, 0.1});
  add("light at infinity (w = 0)", 0, 0.1, 20, Light::towards({0.4, -0.3, 2}), {0.3, 0.2, 0.1});
}

}  // namespace glint::stability

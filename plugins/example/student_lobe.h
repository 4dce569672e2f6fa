// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include "core/reflectance/added_lobe.h"

namespace glint::example {

/// Student's t of slopes: D = (gamma - 1)^gamma m^(2 gamma - 2) / (pi cos^4 theta ((gamma - 1) m^2 + tan^2 theta)^gamma),
/// which is GGX for gamma = 2 and Beckmann's for gamma -> infinity. No masking: Lambda has no closed form for every gamma.
/// @see Ribardiere, Bringier, Meneveaux, Simonot: STD: Student's t-distribution of slopes for microfacet based BSDFs, CGF 2017.
class StudentLobe final : public LobeProfile {
 public:
  explicit StudentLobe(double gamma = 4, std::string name = "student-t") : gamma_(gamma), name_(std::move(name)) {}
  std::string name() const override { return name_; }
  ProfileValue logDistribution(double m, double t) const override {
    const double base = (gamma_ - 1) * m * m + t;
    ProfileValue out;
    out.value = gamma_ * std::log((gamma_ - 1) / base) + (2 * gamma_ - 2) * std::log(m) - std::log(M_PI) + 2 * std::log1p(t);
    out.byRoughness = (2 * gamma_ - 2) / m - 2 * gamma_ * (gamma_ - 1) * m / base;
    out.byTanSquared = 2 / (1 + t) - gamma_ / base;
    return out;
  }

 private:
  double gamma_;
  std::string name_;
};

}  // namespace glint::example

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "core/reflectance/lobe.h"

namespace glint {

/// A function of the roughness m and of t = tan^2 theta, with its derivatives.
struct ProfileValue {
  double value = 0, byRoughness = 0, byTanSquared = 0;
};

/// Up to this roughness a profile is checked when it is added; beyond it nothing relies on the check.
inline constexpr double kCheckedRoughness = 0.8;

/// A lobe beyond the four of lobe.h: a distribution of normals about N. log I = log D(m, t_h) and, for a microfacet lobe, the
/// masking -log(1 + Lambda(L) + Lambda(V)) and the cosines -log(4 cos theta_V), as in LogRadiance. Functions are called from
/// several threads.
class LobeProfile {
 public:
  virtual ~LobeProfile() = default;
  virtual std::string name() const = 0;  ///< as `fit.lobe` takes it: "student-t"
  /// log D; for m <= kCheckedRoughness it may not rise with t, so that its value in the mirror direction is the largest. Any
  /// constant factor of D that does not depend on m or t may be left out.
  virtual ProfileValue logDistribution(double roughness, double tanSquared) const = 0;
  virtual bool isMicrofacet() const { return true; }
  /// Its roughness depends on the direction: t is then stretched by the two widths (lobe.h), of log D and of Lambda, and log D
  /// leaves out the factor 1 / cos^4 theta_h, which goes with the angle as it is.
  virtual bool hasTwoWidths() const { return false; }
  virtual ProfileValue lambda(double, double) const { return {}; }  ///< Smith's Lambda, >= 0
};

/// std::invalid_argument for a name that is taken or empty, and for a profile that rises, is not finite or whose derivatives
/// differ from its differences (at a grid of m and t).
void checkLobe(const LobeProfile& profile);
/// One more lobe, known to `fit.lobe` and to rendering; `fit.lobe=auto` tries it after the others. Not thread-safe: call it
/// before anything asks for lobes. std::invalid_argument as checkLobe().
Lobe addLobe(std::unique_ptr<const LobeProfile> profile);
/// Null for the four of lobe.h.
const LobeProfile* profileOf(Lobe lobe);
const char* addedLobeName(Lobe lobe);  ///< "" for the four of lobe.h
/// All lobes in the order in which `fit.lobe=auto` tries them.
const std::vector<Lobe>& allLobes();

namespace lobe {

template <class T>
double plain(const T& x) {
  if constexpr (std::is_floating_point_v<T>)
    return double(x);
  else
    return plain(x.a);
}
/// A profile's function for a double or for a dual number, which it gives its derivatives by the chain rule.
template <class T>
T chained(const ProfileValue& f, const T& roughness, const T& tanSquared) {
  if constexpr (std::is_floating_point_v<T>)
    return T(f.value);
  else
    return T(f.value) + f.byRoughness * (roughness - T(plain(roughness))) + f.byTanSquared * (tanSquared - T(plain(tanSquared)));
}
template <class T>
T addedDistribution(const LobeProfile& p, const T& roughness, const T& tanSquared) {
  return chained(p.logDistribution(plain(roughness), plain(tanSquared)), roughness, tanSquared);
}
template <class T>
T addedLambda(const LobeProfile& p, const T& roughness, const T& tanSquared) {
  return chained(p.lambda(plain(roughness), plain(tanSquared)), roughness, tanSquared);
}

}  // namespace lobe
}  // namespace glint

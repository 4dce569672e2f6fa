// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/added_lobe.h"

#include <algorithm>
#include <array>
#include <deque>

#include "core/base/number_text.h"
#include "core/base/outcome.h"
#include "core/base/settings.h"
#include "core/reflectance/lobe_terms.h"

namespace glint {
namespace {

struct AddedLobe {
  std::unique_ptr<const LobeProfile> profile;
  std::string name;
};

std::deque<AddedLobe>& added() {  // a deque: pointers to its names stay valid
  static std::deque<AddedLobe> profiles;
  return profiles;
}

constexpr std::array kOwn{Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong};
constexpr int kOwnLobes = static_cast<int>(kOwn.size());

std::vector<Lobe>& known() {
  static std::vector<Lobe> lobes(kOwn.begin(), kOwn.end());
  return lobes;
}

/// By how much a central difference may differ from a derivative, as a share of the function's steepness. Its own error is 1e-6.
constexpr double kDerivativeError = 1e-3;
constexpr double kStep = 1e-5;  // of a central difference, relative to m and t

/// Why a function of (m, t) cannot be used; empty if it can.
template <class Function>
std::string faultOf(const Function& f, const char* what) {
  for (const double m : {0.02, 0.1, 0.3, kCheckedRoughness})  // from polished metal to satin, where fits look
    for (const double ratio : {0.05, 0.5, 1.0, 3.0}) {
      const double t = ratio * m * m;
      const ProfileValue at = f(m, t);
      if (!std::isfinite(at.value) || !std::isfinite(at.byRoughness) || !std::isfinite(at.byTanSquared))
        return formatted("%s is not finite at m = %g, t = %g", what, m, t);
      const double byM = (f(m * (1 + kStep), t).value - f(m * (1 - kStep), t).value) / (2 * kStep * m);
      const double byT = (f(m, t * (1 + kStep)).value - f(m, t * (1 - kStep)).value) / (2 * kStep * t);
      const double steepness = std::max({std::abs(m * byM), std::abs(t * byT), 1e-3});  // below, a difference is round-off
      if (std::abs(m * (at.byRoughness - byM)) > kDerivativeError * steepness)
        return formatted("the derivative of %s by m is %g, and differences give %g at m = %g, t = %g", what, at.byRoughness, byM,
                         m, t);
      if (std::abs(t * (at.byTanSquared - byT)) > kDerivativeError * steepness)
        return formatted("the derivative of %s by t is %g, and differences give %g at m = %g, t = %g", what, at.byTanSquared, byT,
                         m, t);
    }
  return {};
}

std::string faultOf(const LobeProfile& p) {
  const std::string fault = faultOf([&](double m, double t) { return p.logDistribution(m, t); }, "log D");
  if (!fault.empty()) return fault;
  for (const double m : {0.02, 0.1, 0.3, kCheckedRoughness}) {
    double last = p.logDistribution(m, 0).value;
    if (!std::isfinite(last)) return formatted("log D is not finite in the mirror direction at m = %g", m);
    for (double ratio = 0.01; ratio < 100; ratio *= 1.5) {  // to ten times the lobe's width
      const double next = p.logDistribution(m, ratio * m * m).value;
      if (!(next <= last)) return formatted("log D rises or is not a number at m = %g, t = %g", m, ratio * m * m);
      last = next;
    }
  }
  return p.isMicrofacet() ? faultOf([&](double m, double t) { return p.lambda(m, t); }, "Lambda") : std::string();
}

}  // namespace

void checkLobe(const LobeProfile& profile) {
  const std::string name = profile.name();
  require(!name.empty() && name != "auto" && !lobeOf(name), "lobe: the name '" + name + "' is taken or empty");
  const std::string fault = faultOf(profile);
  require(fault.empty(), "lobe " + name + ": " + fault);
}

Lobe addLobe(std::unique_ptr<const LobeProfile> profile) {
  require(profile != nullptr, "addLobe: no profile");
  checkLobe(*profile);
  const std::string name = profile->name();
  addChoice("fit.lobe", name);
  added().push_back({std::move(profile), name});
  known().push_back(static_cast<Lobe>(kOwnLobes + static_cast<int>(added().size()) - 1));
  return known().back();
}

const LobeProfile* profileOf(Lobe lobe) {
  const int index = static_cast<int>(lobe) - kOwnLobes;
  return index >= 0 && index < static_cast<int>(added().size()) ? added()[static_cast<std::size_t>(index)].profile.get()
                                                                : nullptr;
}

const char* addedLobeName(Lobe lobe) {
  const int index = static_cast<int>(lobe) - kOwnLobes;
  return profileOf(lobe) ? added()[static_cast<std::size_t>(index)].name.c_str() : "";
}

const std::vector<Lobe>& allLobes() { return known(); }

}  // namespace glint

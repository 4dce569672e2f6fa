// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/lobe.h"

#include <array>
#include <cmath>

#include "core/base/outcome.h"
#include "core/geometry/light.h"
#include "core/reflectance/added_lobe.h"
#include "core/reflectance/lobe_terms.h"

namespace glint {
namespace {

constexpr std::array<std::pair<Lobe, const char*>, 4> kNames{{{Lobe::Phong, lobe::PhongLobe::kName},
                                                              {Lobe::BlinnPhong, lobe::BlinnPhongLobe::kName},
                                                              {Lobe::TorranceSparrow, lobe::TorranceSparrowLobe::kName},
                                                              {Lobe::Ggx, lobe::GgxLobe::kName}}};

}  // namespace

std::optional<Lobe> lobeOf(const std::string& name) {
  for (const auto& [lobe, text] : kNames)
    if (name == text) return lobe;
  for (const Lobe lobe : allLobes())
    if (name == nameOf(lobe)) return lobe;
  return std::nullopt;
}

const char* nameOf(Lobe lobe) {
  for (const auto& [known, text] : kNames)
    if (lobe == known) return text;
  return addedLobeName(lobe);
}

double beckmannLambda(double roughness, double tanTheta) { return lobe::beckmannLambda(roughness, tanTheta * tanTheta); }

double ggxLambda(double roughness, double tanTheta) { return lobe::ggxLambda(roughness, tanTheta * tanTheta); }

std::optional<LogRadiance> logRadiance(Lobe lobe, double roughness, const Eigen::Vector3d& n, const Eigen::Vector3d& toLight,
                                       const Eigen::Vector3d& toCamera) {
  require(roughness > 0 && std::isfinite(roughness), "logRadiance: roughness must be positive");
  if (!(n.dot(toLight) > 0) || !(n.dot(toCamera) > 0)) return std::nullopt;
  if (!lobe::withLobe(lobe, [&](const auto& l) { return l.template reaches<double>(n, toLight, toCamera); })) return std::nullopt;
  const lobe::Terms<double> t = lobe::terms<double>(lobe, roughness, n, toLight, toCamera);
  return LogRadiance{t.lobe, t.masking, t.cosines};
}

}  // namespace glint

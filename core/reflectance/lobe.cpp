// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/lobe.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "core/base/outcome.h"
#include "core/light/light.h"

namespace glint {
namespace {

constexpr std::array<std::pair<Lobe, const char*>, 4> kNames{
    {{Lobe::Phong, "phong"}, {Lobe::BlinnPhong, "blinn-phong"}, {Lobe::TorranceSparrow, "torrance-sparrow"}, {Lobe::Ggx, "ggx"}}};

/// Tangent of the angle to the normal, without the cancellation of sqrt(1 - cos^2).
double tangent(const Eigen::Vector3d& n, const Eigen::Vector3d& v) { return n.cross(v).norm() / n.dot(v); }

}  // namespace

std::optional<Lobe> lobeOf(const std::string& name) {
  for (const auto& [lobe, text] : kNames)
    if (name == text) return lobe;
  return std::nullopt;
}

const char* nameOf(Lobe lobe) {
  for (const auto& [known, text] : kNames)
    if (lobe == known) return text;
  return "";
}

double beckmannLambda(double roughness, double tanTheta) {
  if (tanTheta <= 0) return 0;
  const double a = 1 / (roughness * tanTheta);
  // Beyond a = 6 both terms cancel to less than 1e-17 of the 1 they are added to.
  if (a > 6) return 0;
  return 0.5 * (std::exp(-a * a) / (a * std::sqrt(M_PI)) - std::erfc(a));
}

double ggxLambda(double roughness, double tanTheta) {
  const double s = roughness * tanTheta;
  return 0.5 * s * s / (std::sqrt(1 + s * s) + 1);  // (sqrt(1 + s^2) - 1) / 2 without cancellation
}

std::optional<LogRadiance> logRadiance(Lobe lobe, double roughness, const Eigen::Vector3d& n, const Eigen::Vector3d& toLight,
                                       const Eigen::Vector3d& toCamera) {
  require(roughness > 0 && std::isfinite(roughness), "logRadiance: roughness must be positive");
  const double cosL = n.dot(toLight), cosV = n.dot(toCamera);
  if (!(cosL > 0) || !(cosV > 0)) return std::nullopt;
  LogRadiance log;
  const double m2 = roughness * roughness;
  if (lobe == Lobe::Phong) {
    const Eigen::Vector3d mirrored = reflect(toLight, n);
    const double angle = std::atan2(mirrored.cross(toCamera).norm(), mirrored.dot(toCamera));
    if (angle >= M_PI / 2) return std::nullopt;
    // log cos through tan keeps the digits near the peak, where cos is 1 to round-off.
    log.lobe = -0.5 / (2 * m2) * std::log1p(std::tan(angle) * std::tan(angle));
    return log;
  }
  const Eigen::Vector3d h = (toLight + toCamera).normalized();
  const double tanH = tangent(n, h), tan2 = tanH * tanH;
  const double logCosH = -0.5 * std::log1p(tan2);
  if (lobe == Lobe::BlinnPhong) {
    log.lobe = 2 / m2 * logCosH;
    return log;
  }
  const double tanL = tangent(n, toLight), tanV = tangent(n, toCamera);
  if (lobe == Lobe::TorranceSparrow) {
    log.lobe = -tan2 / m2 - std::log(M_PI * m2) - 4 * logCosH;
    log.masking = -std::log1p(beckmannLambda(roughness, tanL) + beckmannLambda(roughness, tanV));
  } else {
    log.lobe = -2 * std::log1p(tan2 / m2) - std::log(M_PI * m2) - 4 * logCosH;
    log.masking = -std::log1p(ggxLambda(roughness, tanL) + ggxLambda(roughness, tanV));
  }
  log.cosines = -std::log(4 * cosV);
  return log;
}

}  // namespace glint

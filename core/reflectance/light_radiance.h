// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>

#include "core/reflectance/lobe_terms.h"

namespace glint::lobe {

/// log I of one lobe at a point seen from `toCamera` under a point light L = (l, w): lobe, masking, cosines and falloff, up to a
/// constant of the light. Nothing where light or camera are below the horizon.
template <class T>
std::optional<T> logOfPointLight(Lobe lobe, const T& roughness, const Eigen::Vector3d& position, const Eigen::Vector3d& n,
                                 const Eigen::Vector3d& toCamera, const Eigen::Matrix<T, 4, 1>& light) {
  using std::log;
  using std::sqrt;
  const Eigen::Matrix<T, 3, 1> p = position.cast<T>(), normal = n.cast<T>(), view = toCamera.cast<T>();
  const Eigen::Matrix<T, 3, 1> offset = light.template head<3>() - light(3) * p;
  const T squared = offset.squaredNorm();
  if (!(squared > T(0.0))) return std::nullopt;
  const Eigen::Matrix<T, 3, 1> toLight = offset / sqrt(squared);
  if (!(normal.dot(toLight) > T(0.0)) || !(normal.dot(view) > T(0.0))) return std::nullopt;
  if (lobe == Lobe::Phong && !(T(2.0) * normal.dot(toLight) * normal.dot(view) - toLight.dot(view) > T(0.0))) return std::nullopt;
  return terms<T>(lobe, roughness, n, toLight, toCamera).total() - log(squared);
}

/// The same for a spherical light of radius sqrt(radiusSquared), seen as a disc that faces the point: seven points of the disc
/// that integrate polynomials up to degree five exactly. Points below the horizon give nothing.
/// @see Stroud, Approximate calculation of multiple integrals, 1971, formula S2 5-1.
template <class T>
std::optional<T> logOfSphereLight(Lobe lobe, const T& roughness, const Eigen::Vector3d& position, const Eigen::Vector3d& n,
                                  const Eigen::Vector3d& toCamera, const Eigen::Matrix<T, 4, 1>& light, const T& radiusSquared) {
  using std::exp;
  using std::log;
  using std::sqrt;
  const std::optional<T> centre = logOfPointLight<T>(lobe, roughness, position, n, toCamera, light);
  if (!centre || !(radiusSquared > T(0.0))) return centre;
  const Eigen::Matrix<T, 3, 1> offset = light.template head<3>() - light(3) * position.cast<T>();
  // Around the axis, from another axis that is far from it: continuous in the light, so that its derivatives are those of the
  // disc.
  const Eigen::Vector3d other = Eigen::Vector3d::Unit([&] {
    int smallest = 0;
    for (int i = 1; i < 3; ++i)
      if ((offset(i) < T(0.0) ? -offset(i) : offset(i)) < (offset(smallest) < T(0.0) ? -offset(smallest) : offset(smallest)))
        smallest = i;
    return smallest;
  }());
  const Eigen::Matrix<T, 3, 1> across = other.cast<T>().cross(offset);
  const Eigen::Matrix<T, 3, 1> u = across / sqrt(across.squaredNorm());
  const Eigen::Matrix<T, 3, 1> upwards = offset.cross(u);
  const Eigen::Matrix<T, 3, 1> v = upwards / sqrt(upwards.squaredNorm());
  const T ring = sqrt(radiusSquared * T(2.0 / 3.0)) * light(3);
  T sum(0.25);  // relative to the centre
  for (int k = 0; k < 6; ++k) {
    const double angle = k * M_PI / 3;
    Eigen::Matrix<T, 4, 1> at = light;
    at.template head<3>() += ring * (T(std::cos(angle)) * u + T(std::sin(angle)) * v);
    if (const std::optional<T> value = logOfPointLight<T>(lobe, roughness, position, n, toCamera, at))
      sum += T(0.125) * exp(*value - *centre);
  }
  return *centre + log(sum);
}

}  // namespace glint::lobe

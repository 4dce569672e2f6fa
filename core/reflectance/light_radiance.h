// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>

#include "core/reflectance/disc_rule.h"
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

/// The same for a spherical light of radius sqrt(radiusSquared), seen as a disc that faces the point. Points of the disc below
/// the horizon give nothing.
template <class T>
std::optional<T> logOfSphereLight(Lobe lobe, const T& roughness, const Eigen::Vector3d& position, const Eigen::Vector3d& n,
                                  const Eigen::Vector3d& toCamera, const Eigen::Matrix<T, 4, 1>& light, const T& radiusSquared,
                                  const DiscRule& rule) {
  using std::exp;
  using std::log;
  using std::sqrt;
  if (!(radiusSquared > T(0.0))) return logOfPointLight<T>(lobe, roughness, position, n, toCamera, light);
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
  const T radius = sqrt(radiusSquared) * light(3);
  // Relative to the largest term so far: terms may differ by more than a double's range.
  std::optional<T> top;
  T sum(0.0);
  for (const DiscRule::Node& node : rule.nodes) {
    Eigen::Matrix<T, 4, 1> at = light;
    at.template head<3>() += radius * (T(node.x) * u + T(node.y) * v);
    const std::optional<T> value = logOfPointLight<T>(lobe, roughness, position, n, toCamera, at);
    if (!value) continue;
    if (!top) {
      top = value;
      sum = T(node.weight);
    } else if (*value > *top + T(20.0)) {
      sum = sum * exp(*top - *value) + T(node.weight);
      top = value;
    } else {
      sum += T(node.weight) * exp(*value - *top);
    }
  }
  if (!top) return std::nullopt;
  return *top + log(sum);
}

}  // namespace glint::lobe

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>

#include "core/reflectance/disc_rule.h"
#include "core/reflectance/lamp.h"
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

/// log of a sum of weighted exponentials, relative to the largest so far: terms may differ by more than a double's range.
template <class T>
class LogSum {
 public:
  void add(const T& weight, const T& log) {
    using std::exp;
    if (!top_) {
      top_ = log;
      sum_ = weight;
    } else if (log > *top_ + T(20.0)) {
      sum_ = sum_ * exp(*top_ - log) + weight;
      top_ = log;
    } else {
      sum_ += weight * exp(log - *top_);
    }
  }
  /// Nothing where nothing was added.
  std::optional<T> value() const {
    using std::log;
    return top_ ? std::optional<T>(*top_ + log(sum_)) : std::nullopt;
  }

 private:
  std::optional<T> top_;
  T sum_{0.0};
};

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
  LogSum<T> sum;
  for (const DiscRule::Node& node : rule.nodes) {
    Eigen::Matrix<T, 4, 1> at = light;
    at.template head<3>() += radius * (T(node.x) * u + T(node.y) * v);
    if (const std::optional<T> value = logOfPointLight<T>(lobe, roughness, position, n, toCamera, at)) sum.add(T(node.weight), *value);
  }
  return sum.value();
}

/// The same for a thin tube of uniform radiance with the ends l / w -+ halfAxis: the mean along it of a point light's radiance times
/// the sine of the angle between the axis and the direction to the point (method.md section 15). Points of the tube below the horizon
/// give nothing; a tube seen end on gives nothing at all.
template <class T>
std::optional<T> logOfSegmentLight(Lobe lobe, const T& roughness, const Eigen::Vector3d& position, const Eigen::Vector3d& n,
                                   const Eigen::Vector3d& toCamera, const Eigen::Matrix<T, 4, 1>& light,
                                   const Eigen::Matrix<T, 3, 1>& halfAxis, const std::vector<QuadratureNode>& along) {
  using std::log;
  const Eigen::Matrix<T, 3, 1> offset = light.template head<3>() - light(3) * position.cast<T>();
  // sine = |axis x offset| / (|axis| |offset|), and the cross product is the same all along the tube.
  const T across = halfAxis.cross(offset).squaredNorm() / halfAxis.squaredNorm();
  if (!(across > T(0.0))) return std::nullopt;
  LogSum<T> sum;
  for (const QuadratureNode& node : along) {
    Eigen::Matrix<T, 4, 1> at = light;
    at.template head<3>() += (T(node.x) * light(3)) * halfAxis;
    const std::optional<T> value = logOfPointLight<T>(lobe, roughness, position, n, toCamera, at);
    if (!value) continue;
    const Eigen::Matrix<T, 3, 1> to = at.template head<3>() - light(3) * position.cast<T>();
    sum.add(T(0.5 * node.weight), *value - T(0.5) * log(to.squaredNorm()));
  }
  const std::optional<T> total = sum.value();
  return total ? std::optional<T>(*total + T(0.5) * log(across)) : std::nullopt;
}

/// log I of one lobe under any lamp, up to a constant of the lamp: the one way to evaluate it, in fits, predictions and bands.
/// @param position,lamp  in the same coordinates. @param n,toCamera  unit vectors away from the surface, N on the camera's side.
/// @param rule  from lampRuleFor, for the lamp's shape; it must serve the lamp's size.
/// @return nothing where no part of the lamp lights the point, or where the camera is below the horizon.
template <class T>
std::optional<T> logOfLamp(Lobe lobe, const T& roughness, const Eigen::Vector3d& position, const Eigen::Vector3d& n,
                           const Eigen::Vector3d& toCamera, const LampIn<T>& lamp, const LampRule& rule) {
  switch (lamp.shape) {
    case LampShape::Point: return logOfPointLight<T>(lobe, roughness, position, n, toCamera, lamp.light);
    case LampShape::Sphere:
      return logOfSphereLight<T>(lobe, roughness, position, n, toCamera, lamp.light, lamp.radiusSquared, *rule.disc);
    case LampShape::Segment:
      return logOfSegmentLight<T>(lobe, roughness, position, n, toCamera, lamp.light, lamp.halfAxis, *rule.along);
  }
  return std::nullopt;
}

}  // namespace glint::lobe

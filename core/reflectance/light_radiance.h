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
/// constant of the light. Nothing where light or camera is below the horizon.
template <class T>
std::optional<T> logOfPointLight(Lobe lobe, const RoughnessOf<T>& roughness, const Eigen::Vector3d& position,
                                 const LobeAxes& axes, const Eigen::Vector3d& toCamera, const Eigen::Matrix<T, 4, 1>& light) {
  using std::log;
  using std::sqrt;
  const Eigen::Matrix<T, 3, 1> p = position.cast<T>(), normal = axes.normal.cast<T>(), view = toCamera.cast<T>();
  const Eigen::Matrix<T, 3, 1> offset = light.template head<3>() - light(3) * p;
  const T squared = offset.squaredNorm();
  if (!(squared > T(0.0))) return std::nullopt;
  const Eigen::Matrix<T, 3, 1> toLight = offset / sqrt(squared);
  if (!(normal.dot(toLight) > T(0.0)) || !(normal.dot(view) > T(0.0))) return std::nullopt;
  if (!withLobe(lobe, [&](const auto& l) { return l.template reaches<T>(normal, toLight, view); })) return std::nullopt;
  return terms<T>(lobe, roughness, axes, toLight, toCamera).total() - log(squared);
}

/// log of a sum of radiances of point lights, all of one lobe at one point; their exponents may differ by more than a double's
/// range.
template <class T>
class RadianceSum {
 public:
  RadianceSum(Lobe lobe, const RoughnessOf<T>& roughness, const LobeAxes& axes, const Eigen::Vector3d& toCamera)
      : normal_(axes.normal.cast<T>()), seen_(axes.normal.dot(toCamera) > 0) {
    if (seen_) at_.emplace(lobe, roughness, axes, toCamera);
  }

  /// @param offset  L - w P of a point of the lamp. @param power  of 1 / |offset| that it has: 2, or 3 along a tube.
  void add(double weight, const Eigen::Matrix<T, 3, 1>& offset, int power) {
    using std::exp;
    using std::sqrt;
    const T squared = offset.squaredNorm();
    if (!seen_ || !(squared > T(0.0)) || !(normal_.dot(offset) > T(0.0))) return;
    const T distance = sqrt(squared);
    const Eigen::Matrix<T, 3, 1> toLight = offset / distance;
    if (!at_->reaches(toLight)) return;
    const typename LobeAt<T>::Value value = at_->towards(toLight);
    const T term = T(weight) * value.over / (value.under * (power == 3 ? T(squared * distance) : squared));
    if (!any_) {
      any_ = true;
      top_ = value.exponent;
      sum_ = term;
    } else if (!at_->hasExponent()) {
      sum_ += term;
    } else if (value.exponent > top_ + T(20.0)) {
      sum_ = sum_ * exp(top_ - value.exponent) + term;
      top_ = value.exponent;
    } else {
      sum_ += term * exp(value.exponent - top_);
    }
  }
  /// Nothing where nothing lights the point.
  std::optional<T> log() const {
    using std::log;
    return any_ ? std::optional<T>(at_->constant() + top_ + log(sum_)) : std::nullopt;
  }

 private:
  Eigen::Matrix<T, 3, 1> normal_;
  bool seen_, any_ = false;
  std::optional<LobeAt<T>> at_;
  T top_{0.0}, sum_{0.0};
};

/// log I of one lobe under a lamp of this shape about L = (l, w), up to a constant of the lamp; parts of it below the horizon
/// give nothing.
template <class T>
std::optional<T> logOfShape(const PointShape<T>&, Lobe lobe, const RoughnessOf<T>& roughness, const Eigen::Vector3d& position,
                            const LobeAxes& axes, const Eigen::Vector3d& toCamera, const Eigen::Matrix<T, 4, 1>& light,
                            const LampRule&) {
  return logOfPointLight<T>(lobe, roughness, position, axes, toCamera, light);
}

/// A sphere is seen as a disc that faces the point.
template <class T>
std::optional<T> logOfShape(const SphereShape<T>& sphere, Lobe lobe, const RoughnessOf<T>& roughness,
                            const Eigen::Vector3d& position, const LobeAxes& axes, const Eigen::Vector3d& toCamera,
                            const Eigen::Matrix<T, 4, 1>& light, const LampRule& rule) {
  using std::sqrt;
  if (!(sphere.squaredRadius > T(0.0))) return logOfPointLight<T>(lobe, roughness, position, axes, toCamera, light);
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
  const T radius = sqrt(sphere.squaredRadius) * light(3);
  RadianceSum<T> sum(lobe, roughness, axes, toCamera);
  for (const DiscRule::Node& node : *rule.nodes) sum.add(node.weight, offset + radius * (T(node.x) * u + T(node.y) * v), 2);
  return sum.log();
}

/// A thin tube with the ends l / w -+ halfAxis: the mean along it of a point light's radiance times the sine of the angle between
/// the axis and the direction to the point (method.md section 15). Seen end on it gives nothing at all.
template <class T>
std::optional<T> logOfShape(const SegmentShape<T>& segment, Lobe lobe, const RoughnessOf<T>& roughness,
                            const Eigen::Vector3d& position, const LobeAxes& axes, const Eigen::Vector3d& toCamera,
                            const Eigen::Matrix<T, 4, 1>& light, const LampRule& rule) {
  using std::log;
  const Eigen::Matrix<T, 3, 1> offset = light.template head<3>() - light(3) * position.cast<T>();
  // sine = |axis x offset| / (|axis| |offset|), and the cross product is the same all along the tube.
  const T across = segment.halfAxis.cross(offset).squaredNorm() / segment.halfAxis.squaredNorm();
  if (!(across > T(0.0))) return std::nullopt;
  const Eigen::Matrix<T, 3, 1> half = light(3) * segment.halfAxis;
  RadianceSum<T> sum(lobe, roughness, axes, toCamera);
  for (const DiscRule::Node& node : *rule.nodes) sum.add(node.weight, offset + T(node.x) * half, 3);
  const std::optional<T> total = sum.log();
  return total ? std::optional<T>(*total + T(0.5) * log(across)) : std::nullopt;
}

/// log I of one lobe under any lamp, up to a constant of the lamp: the one way to evaluate it, in fits, predictions and bands.
/// @param position,lamp  in the same coordinates. @param axes,toCamera  unit vectors away from the surface, N on the camera's
/// side.
/// @param rule  from lampRuleFor, for the lamp's shape; it must serve the lamp's size.
/// @return nothing where no part of the lamp lights the point, or where the camera is below the horizon.
template <class T>
std::optional<T> logOfLamp(Lobe lobe, const RoughnessOf<T>& roughness, const Eigen::Vector3d& position, const LobeAxes& axes,
                           const Eigen::Vector3d& toCamera, const LampOf<T>& lamp, const LampRule& rule) {
  return std::visit(
      [&](const auto& shape) { return logOfShape<T>(shape, lobe, roughness, position, axes, toCamera, lamp.centre, rule); },
      lamp.shape);
}

}  // namespace glint::lobe

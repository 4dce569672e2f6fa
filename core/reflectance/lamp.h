// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/quadrature.h"
#include "core/geometry/light.h"
#include "core/reflectance/disc_rule.h"

namespace glint {

/// What shines in the reflectance model, in the world: a point (also at infinity), a sphere of uniform radiance, or a segment: a thin
/// straight tube of uniform radiance, whose intensity goes with the sine of the angle to its axis.
/// Invariant: radius >= 0; a lamp with a radius or a length has a finite centre, and not both.
struct Lamp {
  Light centre;
  double radius = 0;                  ///< m, of a sphere
  Eigen::Vector3d halfAxis{0, 0, 0};  ///< m, from the centre of a segment to one of its ends: unit axis times half length

  Lamp() = default;
  Lamp(const Light& point) : centre(point) {}  // NOLINT(google-explicit-constructor): a point is the plainest lamp
  /// std::invalid_argument for a negative radius, or a radius at infinity.
  static Lamp sphere(const Light& centre, double radius);
  /// std::invalid_argument where the ends coincide or are not finite.
  static Lamp segment(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  bool isSegment() const { return halfAxis.squaredNorm() > 0; }
  bool isPoint() const { return radius == 0 && !isSegment(); }
  /// Both ends of a segment, m; nothing for another lamp.
  std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> ends() const;
};

namespace lobe {

enum class LampShape { Point, Sphere, Segment };

/// A lamp for any scalar (double, or dual numbers) in the coordinates of the points that it lights. `radiusSquared` is read for a
/// sphere only, `halfAxis` for a segment only.
template <class T>
struct LampIn {
  LampShape shape = LampShape::Point;
  Eigen::Matrix<T, 4, 1> light;  ///< L = (l, w) of the centre, any scale
  T radiusSquared{0.0};
  Eigen::Matrix<T, 3, 1> halfAxis;
};

/// World coordinates.
LampIn<double> inWorld(const Lamp& lamp);

/// The quadrature over a lamp. One rule serves a whole picture or fit, so that its radiance stays smooth.
struct LampRule {
  const DiscRule* disc = nullptr;                      ///< of a sphere
  const std::vector<QuadratureNode>* along = nullptr;  ///< of a segment
};

/// Rules whose error in log I is below about 1e-5 down to the foot of the highlight, for lamps of at most `ratio` lobe widths: see
/// sizeRatio(). Segments: Gauss-Legendre, beyond a ratio of 12 the largest rule (96 nodes).
LampRule lampRuleFor(LampShape shape, double ratio);

/// Half the lamp's angular extent over the lobe's width at a point, as sizeRatio(); an upper bound for a segment, which may be seen
/// slantwise. 0 for a point.
double lampRatio(double roughness, const Eigen::Vector3d& position, const Eigen::Vector3d& toCamera, const LampIn<double>& lamp);

}  // namespace lobe
}  // namespace glint

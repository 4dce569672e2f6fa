// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/geometry/light.h"
#include "core/reflectance/disc_rule.h"
#include "core/reflectance/lobe.h"

namespace glint {

// The shapes of a lamp. A new one is a struct here, an entry of ShapeOf, its part of lamp.cpp (files, words, drawing,
// quadrature, where a search starts), its radiance in light_radiance.h, and its samples in core/synth/light_source.cpp. T is
// double, or a dual number with derivatives. Each says:
//   kName, kWords  as fit.light_size takes it, and for people
//   kUnknowns      numbers that a fit finds beside centre and lobe; unknowns() points to them
//   kLength        power of a length that the unknowns are
//   kMayVanish     whether a size of 0 is allowed; its unknowns then stay above kLeast (normalised coordinates)
//   kLeastStep     smallest difference by an unknown that pixels tell, normalised
//   kLargestRatio  reach in lobe widths up to which contours are fitted: beyond it they show the lamp and hardly the lobe
//   kRatioReserve  what it may grow by while a quadrature stays
//   kMostSteps     iterations of a fit to contours, after which it creeps along a valley
//   kSearched      whether fitExtended looks for it, from the shapes of startsOf()
//   times, over    the shape with all lengths times f, or divided by f
//   rotated        by a rotation about its centre
//   aliases        other unknowns of the same lamp
//   reach          largest distance from the centre

template <class T = double>
struct PointShape {
  static constexpr const char *kName = "point", *kWords = "a lamp without a size";
  static constexpr int kUnknowns = 0, kLength = 1, kMostSteps = std::numeric_limits<int>::max();
  static constexpr bool kMayVanish = true, kSearched = false;
  static constexpr double kLeast = 0, kLeastStep = 0, kRatioReserve = 1, kLargestRatio = std::numeric_limits<double>::infinity();
  T* unknowns() { return nullptr; }
  PointShape times(double) const { return {}; }
  PointShape over(double) const { return {}; }
  PointShape rotated(const Eigen::Matrix3d&) const { return {}; }
  std::vector<PointShape> aliases() const { return {}; }
  double reach() const { return 0; }
  bool operator==(const PointShape&) const = default;
};

/// A sphere of uniform radiance. The square of its radius is the unknown: smooth where it vanishes.
template <class T = double>
struct SphereShape {
  static constexpr const char *kName = "sphere", *kWords = "a lamp with a size";
  static constexpr int kUnknowns = 1, kLength = 2, kMostSteps = 25;
  static constexpr bool kMayVanish = true, kSearched = false;
  static constexpr double kLeast = 1e-10;                          // keeps the derivative of a square root finite
  static constexpr double kLeastStep = 1e-12;                      // keeps differences finite
  static constexpr double kRatioReserve = 1, kLargestRatio = 2.5;  // sums over a larger disc take minutes
  T squaredRadius{0.0};
  static SphereShape of(double radius) { return {radius * radius}; }
  T* unknowns() { return &squaredRadius; }
  SphereShape times(double f) const { return of(f * reach()); }
  SphereShape over(double f) const { return {squaredRadius / (f * f)}; }
  SphereShape rotated(const Eigen::Matrix3d&) const { return *this; }
  std::vector<SphereShape> aliases() const { return {}; }
  double reach() const { return std::sqrt(std::max(0.0, squaredRadius)); }
  bool operator==(const SphereShape&) const = default;
};

/// A straight tube of uniform radiance, whose intensity goes with the sine of the angle to its axis.
template <class T = double>
struct SegmentShape {
  static constexpr const char *kName = "segment", *kWords = "a lamp with a length";
  static constexpr int kUnknowns = 3, kLength = 1, kMostSteps = 60;
  static constexpr bool kMayVanish = false, kSearched = true;
  static constexpr double kLeast = 0, kRatioReserve = 1.3, kLargestRatio = 12;
  static constexpr double kLeastStep = 1e-7;                // of the distance: beyond round-off
  Eigen::Matrix<T, 3, 1> halfAxis{T(0.0), T(0.0), T(0.0)};  ///< from the centre to one end
  double radius = 0;                                        ///< of the tube, as a scene states it; fits are of a thin one
  T* unknowns() { return halfAxis.data(); }
  SegmentShape times(double f) const { return {f * halfAxis, f * radius}; }
  SegmentShape over(double f) const { return {halfAxis / f, radius / f}; }
  SegmentShape rotated(const Eigen::Matrix3d& r) const { return {r * halfAxis, radius}; }
  std::vector<SegmentShape> aliases() const { return {{-halfAxis, radius}}; }
  double reach() const { return halfAxis.norm(); }
  bool operator==(const SegmentShape&) const = default;
};

template <class T>
using ShapeOf = std::variant<PointShape<T>, SphereShape<T>, SegmentShape<T>>;
using LampShape = ShapeOf<double>;

/// A lamp: what fits find, scenes state, and everything draws. L = (l, w) is its centre, homogeneous, any scale; w = 0 puts it at
/// infinity, where a fitted lamp is a point. Coordinates are the world's unless a function says otherwise, lengths metres.
template <class T>
struct LampOf {
  Eigen::Matrix<T, 4, 1> centre{T(0.0), T(0.0), T(1.0), T(0.0)};
  ShapeOf<T> shape;

  LampOf() = default;
  LampOf(const Light& point)
      : centre(point.homogeneous().template cast<T>()) {}  // NOLINT(google-explicit-constructor): the plainest lamp
  LampOf(const Eigen::Matrix<T, 4, 1>& l, ShapeOf<T> s) : centre(l), shape(std::move(s)) {}

  bool isPoint() const { return std::holds_alternative<PointShape<T>>(shape); }
  bool atInfinity() const { return centre.w() == T(0.0); }
  /// The centre's position, l / w; not finite at infinity.
  Eigen::Matrix<T, 3, 1> position() const { return centre.template head<3>() / centre.w(); }
  bool operator==(const LampOf& other) const { return centre == other.centre && shape == other.shape; }
};
using Lamp = LampOf<double>;

/// L as a unit vector; the same digits where it is one already.
Light lightOf(const Lamp& lamp);
/// A point lamp, exactly where the scene states it.
Lamp lampAt(const Eigen::Vector3d& position);
/// @param fromScene  not zero
Lamp lampTowards(const Eigen::Vector3d& fromScene);
/// A point where the radius is 0. std::invalid_argument for a negative radius, or a radius at infinity.
Lamp sphereLamp(const Light& centre, double radius);
/// std::invalid_argument where the ends coincide or are not finite.
Lamp segmentLamp(const Eigen::Vector3d& from, const Eigen::Vector3d& to);
/// The lamp with this radius: a point becomes a sphere, a segment a tube; 0 takes it away. std::invalid_argument for a negative
/// one.
Lamp withRadius(Lamp lamp, double radius);
/// Radius of a sphere or a tube, m; else 0.
double radiusOf(const Lamp& lamp);
/// Both ends of a segment, m; nothing for another lamp.
std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> endsOf(const Lamp& lamp);
/// Largest distance of its points from the centre, in the units of the shape.
double reachOf(const LampShape& shape);
/// Points that a surface must all hide, with the centre, before it hides the lamp.
std::vector<Eigen::Vector3d> extremesOf(const Lamp& lamp);

/// The lamp shifted by a vector. At infinity its unit direction is shifted and brought to length 1 again.
Lamp moved(const Lamp& lamp, const Eigen::Vector3d& by);
/// The lamp moved by x -> rotation x * scale + shift of its points.
Lamp transformed(const Lamp& lamp, double scale, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& shift);
/// The lamp in coordinates (x - origin) / scale with |L| = 1, and back. std::invalid_argument for L = 0.
Lamp normalised(const Lamp& lamp, const Eigen::Vector3d& origin, double scale);
Lamp fromNormalised(const Lamp& lamp, const Eigen::Vector3d& origin, double scale);

/// Numbers that a fit finds of a shape, one behind the other; empty for a point.
std::span<double> unknownsOf(LampShape& shape);
int unknownCount(const LampShape& shape);
/// The largest such number of any shape.
inline constexpr int kMostShapeUnknowns = 3;

const char* nameOf(const LampShape& shape);
/// One lamp of each shape, from those with an extent to the point, for a search to try in turn.
std::vector<LampShape> allLampShapes();
/// What is known of a lamp's extent before it is fitted, in the units of its unknowns.
struct ExtentGuess {
  Eigen::Vector3d towards{0, 0, 1};                     ///< unit, from the scene to the lamp
  double distance = 1;                                  ///< along it
  std::optional<Eigen::Matrix<double, 3, 2>> halfAxes;  ///< across it, the longer one first: what residuals of a point promise
};
/// Shapes of this kind from which a search starts; empty unless its shape is kSearched.
std::vector<LampShape> startsOf(const LampShape& kind, const ExtentGuess& guess);
bool isSearched(const LampShape& kind);
/// Other unknowns of the same lamp, such as a segment's with its ends exchanged.
std::vector<LampShape> aliasesOf(const LampShape& shape);
/// Shapes beside a point that a search may take where the contours show them, by their place in LampShape.
using LampChoices = std::bitset<std::variant_size_v<LampShape>>;
/// `auto` means all of them. Empty for "point" and for a name that no shape has.
LampChoices lampChoices(const std::string& name);
template <class Shape>
bool admits(const LampChoices& choices) {
  return choices[LampShape(Shape{}).index()];
}

/// What files, Python and pages say of a lamp, by the keys of docs/formats.md: a number (1 x 1), a vector (1 x 3), or points (n x
/// 3). position, direction, or the points of a shape that has its place by them (segment); radius where it is not 0.
struct LampField {
  std::string name;
  Eigen::MatrixXd value;
};
std::vector<LampField> fieldsOf(const Lamp& lamp);
/// A shape whose points say its place too.
struct PlacedShape {
  std::string name;                                                       ///< key
  int points = 0;                                                         ///< number of them
  std::string wrongSize;                                                  ///< what to say of another number
  std::string (*faultOf)(const std::vector<Eigen::Vector3d>&) = nullptr;  ///< why they make no lamp; "" where they do
  Lamp (*make)(const std::vector<Eigen::Vector3d>&) = nullptr;
};
const std::vector<PlacedShape>& placedShapes();
/// Its size in words, for people: "radius" (1), "length" (1), "end" (3), m; nothing for a point.
struct LampFact {
  std::string name;
  Eigen::VectorXd value;
};
std::vector<LampFact> factsOf(const Lamp& lamp);
/// Chains of points to draw, m: a segment's axis is an open one, three great circles of a sphere are closed. Empty for a point
/// and at infinity.
std::vector<std::vector<Eigen::Vector3d>> outlineOf(const Lamp& lamp);

namespace lobe {

/// Where a search is, in normalised coordinates: |L| = 1.
struct State {
  Lamp lamp;
  double logRoughness = 0;
  double logRatio = 0;  ///< of a lobe with two widths; 0 for others

  Roughness roughness() const { return {std::exp(logRoughness), logRatio == 0 ? 1 : std::exp(logRatio)}; }
  bool atInfinity() const { return lamp.atInfinity(); }
  bool isFinite() const;
  /// Length at the lamp that makes `share` of a lobe's width, normalised. Not finite at infinity.
  double lengthOf(double share) const { return share * roughness().mean * lamp.centre.head<3>().norm() / lamp.centre.w(); }
  /// L (4), log m (1), then the shape's own: places are compared by it (the ratio of two widths hardly moves the lamp).
  Eigen::VectorXd place() const;
  bool operator==(const State&) const = default;
};

/// The quadrature over a lamp: on the unit disc of a sphere, from -1 to 1 along a segment (y = 0); the weights sum to 1. Null for
/// a point. One rule serves a whole picture or fit, so that its radiance stays smooth.
struct LampRule {
  const std::vector<DiscRule::Node>* nodes = nullptr;
  double count() const { return nodes ? double(nodes->size()) : 1; }
  bool operator==(const LampRule&) const = default;
};

/// Rules whose error in log I is below about 1e-5 down to the foot of the highlight, for lamps of at most `ratio` lobe widths:
/// see sizeRatio(). Segments: Gauss-Legendre, beyond a ratio of 12 the largest rule (96 nodes).
LampRule lampRuleFor(const LampShape& shape, double ratio);

/// Half the lamp's angular extent over the lobe's width at a point, as sizeRatio(); an upper bound for a segment, which may be
/// seen slantwise. 0 for a point.
double lampRatio(double roughness, const Eigen::Vector3d& position, const Eigen::Vector3d& toCamera, const Lamp& lamp);

/// The lamp's point that is nearest to a direction: the offset from `position` to it (its L - w P), and the angle, rad, by which
/// the lamp reaches around that direction.
struct Nearest {
  Eigen::Vector3d offset;
  double extent = 0;
};
Nearest nearestTo(const Lamp& lamp, const Eigen::Vector3d& position, const Eigen::Vector3d& direction);

}  // namespace lobe
}  // namespace glint

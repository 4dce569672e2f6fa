// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "core/surface/surface.h"

namespace glint {

/// Specular lobes. `roughness` is m: near the mirror direction every lobe falls as exp(-theta_h^2 / m^2). Plugins add further
/// values (added_lobe.h), so a switch over these four has a default.
enum class Lobe { Phong, BlinnPhong, TorranceSparrow, Ggx };

/// How rough a lobe is: m, and for a lobe with two widths how much wider it is across the surface's tangent than along it. m
/// is their geometric mean: along it is mean / sqrt(ratio), across it mean * sqrt(ratio). Other lobes do not read the ratio.
template <class T>
struct RoughnessOf {
  T mean{0.0};
  double ratio = 1;

  RoughnessOf() = default;
  RoughnessOf(const T& m, double acrossOverAlong = 1)
      : mean(m), ratio(acrossOverAlong) {}    // NOLINT(google-explicit-constructor): one width
  operator const T&() const { return mean; }  // NOLINT(google-explicit-constructor)
};
using Roughness = RoughnessOf<double>;

/// Unit directions that a lobe goes with: the surface's normal, and its tangent (Surface::tangentAt), which only a lobe with
/// two widths reads.
struct LobeAxes {
  Eigen::Vector3d normal, tangent;

  LobeAxes() = default;
  template <class Derived>
  LobeAxes(const Eigen::MatrixBase<Derived>& n, const Eigen::Vector3d& t = Eigen::Vector3d::Zero())
      : normal(n), tangent(t) {}  // NOLINT(google-explicit-constructor): one width
};

/// phong, blinn-phong, torrance-sparrow, ggx, and those of plugins (added_lobe.h); nothing for another name.
std::optional<Lobe> lobeOf(const std::string& name);
const char* nameOf(Lobe lobe);
/// It has masking and cosines; false for the cosine powers.
bool isMicrofacet(Lobe lobe);
/// Whether its roughness depends on the direction in the surface.
bool hasTwoWidths(Lobe lobe);
/// The axes of a lobe at a point of a surface; the tangent is asked for only if the lobe has two widths.
LobeAxes axesAt(Lobe lobe, const Surface& surface, const SurfacePoint& point);

/// Logarithm of the specular radiance towards the camera from a source of unit intensity at unit distance, term by term
/// (method.md section 7; the distance term -2 log r is the caller's).
struct LogRadiance {
  double lobe = 0;     ///< microfacet distribution D, or the cosine power
  double masking = 0;  ///< log G = -log(1 + Lambda(L) + Lambda(V)); 0 for Phong and Blinn-Phong
  double cosines = 0;  ///< -log(4 cos theta_V): brdf D G / (4 cos theta_L cos theta_V) times cos theta_L; 0 for the cosine powers
  double total() const { return lobe + masking + cosines; }
};

/// The radiance of one lobe; F = 1. With theta_h = angle(N, H):
///   torrance-sparrow  D = exp(-tan^2 theta_h / m^2) / (pi m^2 cos^4 theta_h),  Lambda of Beckmann slopes
///   ggx               D = m^2 / (pi cos^4 theta_h (m^2 + tan^2 theta_h)^2),    Lambda(v) = (sqrt(1 + m^2 tan^2 v) - 1) / 2
///   blinn-phong       cos(theta_h)^(2 / m^2)
///   phong             (R.V)^(1 / (2 m^2)), R the mirror direction of L
/// A lobe with two widths, axes T, B = N x T, ratio q: theta_h, m of D with tan^2 theta_h = (q (H.T)^2 + (H.B)^2 / q) /
/// (H.N)^2 (cos theta_h as it is), and of Lambda with tan^2 v = ((v.T)^2 / q + q (v.B)^2) / (v.N)^2.
/// @param axes,toLight,toCamera  unit vectors away from the surface, N on the camera's side.
/// @return nothing where the light or the camera is below the horizon, or where R.V <= 0 (phong).
/// @see Walter et al., Microfacet models for refraction through rough surfaces, EGSR 2007 (D, Lambda); Heitz, Understanding the
/// masking-shadowing function, JCGT 2014 (the height-correlated form of G); Torrance and Sparrow, 1967.
std::optional<LogRadiance> logRadiance(Lobe lobe, const Roughness& roughness, const LobeAxes& axes,
                                       const Eigen::Vector3d& toLight, const Eigen::Vector3d& toCamera);

/// Smith's Lambda for Beckmann slopes of width m: (erf(a) - 1) / 2 + exp(-a^2) / (2 a sqrt(pi)), a = 1 / (m tan theta).
double beckmannLambda(double roughness, double tanTheta);
/// Smith's Lambda for GGX.
double ggxLambda(double roughness, double tanTheta);

/// The angle theta_h, rad, at which the lobe itself (D, or the cosine power) has fallen to `level` of its value in the mirror
/// direction. At most 1.4, where a lobe never falls that far.
/// @param roughness  m > 0. @param level  in (0, 1). std::invalid_argument otherwise.
double widthOf(Lobe lobe, double roughness, double level);

/// The m with which a lobe has a width: the inverse of widthOf, in closed form. Lobes of one width look alike near the level;
/// their m may differ by half. @param width  rad, in (0, pi / 2); for Phong widths beyond pi / 4 count as just below it.
double roughnessOf(Lobe lobe, double width, double level);

namespace lobe {

/// A surface point seen by a camera.
struct Seen {
  Eigen::Vector3d position;
  LobeAxes axes;  ///< normal on the camera's side
  Eigen::Vector3d toCamera;
};
/// With the tangent, for any lobe. @param point  normal towards the eye.
Seen seenFrom(const Eigen::Vector3d& eye, const Surface& surface, const SurfacePoint& point);

}  // namespace lobe
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace glint {

/// Specular lobes. `roughness` is m: near the mirror direction every lobe falls as exp(-theta_h^2 / m^2). Plugins add further
/// values (added_lobe.h), so a switch over these four has a default.
enum class Lobe { Phong, BlinnPhong, TorranceSparrow, Ggx };

/// phong, blinn-phong, torrance-sparrow, ggx, and those of plugins (added_lobe.h); nothing for another name.
std::optional<Lobe> lobeOf(const std::string& name);
const char* nameOf(Lobe lobe);

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
/// @param n,toLight,toCamera  unit vectors away from the surface, N on the camera's side.
/// @return nothing where the light or the camera is below the horizon, or where R.V <= 0 (phong).
/// @see Walter et al., Microfacet models for refraction through rough surfaces, EGSR 2007 (D, Lambda); Heitz, Understanding the
/// masking-shadowing function, JCGT 2014 (the height-correlated form of G); Torrance and Sparrow, 1967.
std::optional<LogRadiance> logRadiance(Lobe lobe, double roughness, const Eigen::Vector3d& n, const Eigen::Vector3d& toLight,
                                       const Eigen::Vector3d& toCamera);

/// Smith's Lambda for Beckmann slopes of width m: (erf(a) - 1) / 2 + exp(-a^2) / (2 a sqrt(pi)), a = 1 / (m tan theta).
double beckmannLambda(double roughness, double tanTheta);
/// Smith's Lambda for GGX.
double ggxLambda(double roughness, double tanTheta);

}  // namespace glint

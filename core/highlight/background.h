// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/base/image.h"
#include "core/geometry/camera.h"

namespace glint {

/// Diffuse shading under and around one highlight: a quadratic in pixels, b(x, y).
struct Background {
  Eigen::Matrix<double, 6, 1> coefficients = Eigen::Matrix<double, 6, 1>::Zero();  ///< of 1, u, v, u^2, uv, v^2
  Pixel centre{0, 0};                                                              ///< u = (x - centre.x) / scale, v likewise
  double scale = 1;
  double spread = 0;  ///< robust standard deviation of the pixels used about the fit
  int pixels = 0;     ///< used by the fit; 0 = no fit, b is the constant given

  double at(double x, double y) const;
};

/// Where a highlight is, roughly: the second moments of the pixels above `level` of its peak.
struct Footprint {
  Pixel centre{0, 0};
  Eigen::Matrix2d shape = Eigen::Matrix2d::Identity();  ///< ellipse x^T shape^-1 x = 1 has the footprint's moments
  double level = 0.5;
};

/// How a lobe falls off beyond the contour, rho in units of the footprint: level^(rho^2) of a Gaussian lobe (Beckmann, and about
/// the cosine powers), or (1 + (level^-1/2 - 1) rho^2)^-2 of GGX.
enum class Tail { Gaussian, Ggx };

/// Fits the background to the usable pixels around a highlight, together with the lobe's own tail. With rho the distance from
/// the centre in units of the footprint, a Gaussian lobe is level^(rho^2); the model over rho in [inner, outer] is
///   I = b(x, y) + (a0 + a1 u + a2 v) level^(rho^2),
/// or with GGX's tail in the last factor, linear in its nine unknowns, solved with Tukey weights. Only pixels where the tail is
/// weak (rho >= inner) enter, so the lobe's true shape matters little.
/// @param image   one channel, linear.
/// @param usable  one per pixel, non-zero where the pixel may be used (glossy, finite).
/// @param fallback  constant returned when fewer than a few dozen pixels are usable.
Background fitBackground(const Image& image, const std::vector<char>& usable, const Footprint& footprint, double fallback,
                         Tail tail = Tail::Gaussian);

/// The same with a tail that is known: `fall` is the lobe over rho^2, as a share of any constant, finite.
Background fitBackground(const Image& image, const std::vector<char>& usable, const Footprint& footprint, double fallback,
                         const std::function<double(double rho2)>& fall);

/// How far a contour may be off because the lobe's tail is unknown: fits the background with both. If GGX's explains the
/// surroundings at least nearly as well, the difference at the highlight counts; none if a Gaussian fits clearly better.
/// @param footprint  of the highlight at its level. @param peakValue  above the background
/// @return change of the contour's radius, in percent of its diameter; 0 where the surroundings tell nothing (few pixels)
double backgroundUncertaintyPct(const Image& image, const std::vector<char>& usable, const Footprint& footprint,
                                double peakValue);

}  // namespace glint

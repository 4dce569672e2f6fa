// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/reflectance/lobe.h"
#include "core/scene/scene.h"
#include "core/surface/surface.h"

namespace glint {

/// What the surface is made of.
struct Material {
  Lobe lobe = Lobe::TorranceSparrow;
  Roughness roughness = 0.1;         ///< m
  double specular = 1;               ///< factor of the lobe (F, constant)
  Eigen::Vector3d diffuse{0, 0, 0};  ///< Lambert albedo per channel
};

/// Radiance leaving a surface point towards the camera, from one light of unit intensity (W/sr; for a light at infinity: unit
/// irradiance on a plane facing it).
struct Shading {
  double specular = 0;
  double diffuse = 0;  ///< for albedo 1
};

/// One direction that light comes from.
struct LightSample {
  Eigen::Vector3d direction;              ///< unit, from the point to the light
  double weight = 0;                      ///< irradiance on a plane facing it
  std::optional<Eigen::Vector3d> target;  ///< a world point towards which occlusion is tested; empty for a light at infinity
};

/// Deterministic quadrature of a light seen from a point:
/// a point or direction is one sample; a sphere of uniform radiance is the cone that it fills (Gauss-Legendre in the cosine,
/// equal steps around); a tube of uniform radiance is Gauss-Legendre along its axis and across its width, with the sine of the
/// angle to its axis. Total intensity is 1 in every case, so all agree as the radius goes to 0 (and the tube's length).
/// @param lobeWidth  rad, of the lobe that weighs the samples, as an angle of the light's direction: a sphere that is wide
///                   beside it takes more samples.
/// @return no samples where the point lies inside the light.
std::vector<LightSample> sampleLight(const Lamp& lamp, const Eigen::Vector3d& point, double lobeWidth = 1);

/// Both parts at a surface point, seen from `eye`; the normal is turned to the camera's side; samples that the surface hides
/// count 0.
Shading shade(const Surface& surface, const SurfacePoint& point, const Eigen::Vector3d& eye, const TrueLight& light,
              const Material& material);

/// log of the specular radiance at the first hit of an ideal pixel; nothing where there is no surface or no light. For a point
/// light it is the sum of the terms themselves, exact far below the smallest double.
std::optional<double> logSpecular(const Surface& surface, const Camera& camera, const Pixel& pixel, const TrueLight& light,
                                  const Material& material);

}  // namespace glint

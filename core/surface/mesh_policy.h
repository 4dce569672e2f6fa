// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/surface/surface.h"

namespace glint {

/// What the settings `surface.depth_...` ask for.
inline DepthPolicy depthPolicy(const Settings& settings) {
  const std::string& smoothing = settings.text("surface.depth_smoothing");
  DepthPolicy policy;
  policy.smoothing = smoothing == "fit"         ? DepthSmoothing::Fit
                     : smoothing == "bilateral" ? DepthSmoothing::Bilateral
                                                : DepthSmoothing::None;
  policy.normals = settings.text("surface.depth_normals") == "integral" ? DepthNormals::Integral : DepthNormals::Plane;
  policy.radius = settings.number("surface.depth_radius");
  policy.largestHolePx = settings.integer("surface.depth_fill");
  policy.fusedFrames = settings.integer("surface.depth_fuse");
  policy.noise = settings.number("surface.depth_noise");
  policy.seed = settings.integer("surface.depth_seed");
  return policy;
}

/// What `surface.normals` and `surface.rays` ask for.
inline MeshPolicy meshPolicy(const Settings& settings) {
  const std::string& normals = settings.text("surface.normals");
  return {normals == "facet"    ? NormalPolicy::Facet
          : normals == "curved" ? NormalPolicy::Curved
                                : NormalPolicy::Interpolated,
          settings.text("surface.rays") == "single" ? RayPrecision::Single : RayPrecision::Double, depthPolicy(settings)};
}

}  // namespace glint

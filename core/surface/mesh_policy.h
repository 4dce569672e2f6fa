// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/surface/surface.h"

namespace glint {

/// What `surface.normals` and `surface.rays` ask for.
inline MeshPolicy meshPolicy(const Settings& settings) {
  const std::string& normals = settings.text("surface.normals");
  return {normals == "facet"    ? NormalPolicy::Facet
          : normals == "curved" ? NormalPolicy::Curved
                                : NormalPolicy::Interpolated,
          settings.text("surface.rays") == "single" ? RayPrecision::Single : RayPrecision::Double};
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/surface/surface.h"

namespace glint {

/// A surface that answers many questions of occlusion together faster than one by one.
class ManyOcclusions {
 public:
  virtual ~ManyOcclusions() = default;
  /// Surface::occluded of every point towards the same one: 1 where it holds.
  virtual std::vector<char> occludedMany(const std::vector<SurfacePoint>& from, const Eigen::Vector3d& to) const = 0;
};

/// The same for any surface: in packets where it can, one by one elsewhere.
inline std::vector<char> occludedMany(const Surface& surface, const std::vector<SurfacePoint>& from, const Eigen::Vector3d& to) {
  if (const auto* many = dynamic_cast<const ManyOcclusions*>(&surface)) return many->occludedMany(from, to);
  std::vector<char> result(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) result[i] = surface.occluded(from[i], to);
  return result;
}

}  // namespace glint

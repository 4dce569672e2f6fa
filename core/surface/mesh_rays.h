// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/surface: rays against the triangles of a mesh, in single precision.

#include <functional>
#include <optional>
#include <vector>

#include "core/surface/surface.h"

struct RTCDeviceTy;  // of Embree
struct RTCSceneTy;

namespace glint {

/// The triangles of a mesh in Embree's tree, with the mesh's box moved to the origin and scaled to a diagonal of 2: single
/// precision is then good to 1e-7 of the size, wherever in the world the mesh is.
class MeshRays {
 public:
  /// @param alive  triangles with 0 are never met. @param bounds  of the vertices, not empty.
  /// std::runtime_error where Embree has no memory.
  MeshRays(const TriangleMesh& mesh, const std::vector<char>& alive, const Eigen::AlignedBox3d& bounds);
  ~MeshRays();
  MeshRays(const MeshRays&) = delete;
  MeshRays& operator=(const MeshRays&) = delete;

  /// Weights of a triangle's second and third corner, and the way from the ray's origin, world units.
  struct Hit {
    int triangle = -1;  ///< -1: none
    double u = 0, v = 0, t = 0;
  };

  /// The hits of one ray, one after another.
  class Search {
   public:
    /// @param start  near the mesh's box. @param d  unit. @param length  hits up to there; a few just beyond may come, too.
    Search(const MeshRays& rays, const Eigen::Vector3d& start, const Eigen::Vector3d& d, double length);
    /// The next hit; nothing at the end. A ray that meets nothing is asked once more, a little to the side: through the
    /// middle of a vertex it can slip between the triangles.
    std::optional<Hit> next();

   private:
    const MeshRays& rays_;
    Eigen::Vector3d direction_;
    Eigen::Vector3f origin_{0, 0, 0};  ///< in Embree's unit, as `near` and `far`
    float near_ = 0, far_ = 0;
    bool outside_ = false, shifted_ = false;
  };

  /// The first hit of every ray, without `t`. Rays may start far from the mesh.
  std::vector<Hit> hits(const std::vector<Ray>& rays) const;

  /// Calls `met(i, certain)` for every point i between which and `to` something lies, until it returns false. Certain: what lies
  /// there is farther from both ends than single precision is wrong.
  /// @param start  share of the mesh's size or of the way, whichever is shorter, from where on things count
  /// @param asks   2: a ray that meets nothing is asked once more, as in Search
  void obstacles(const std::vector<SurfacePoint>& from, const Eigen::Vector3d& to, double start, int asks,
                 const std::function<bool(std::size_t, bool)>& met) const;

 private:
  Eigen::Vector3d centre_;
  double size_, scale_;  ///< the box's diagonal, and to Embree's unit
  RTCDeviceTy* device_ = nullptr;
  RTCSceneTy* scene_ = nullptr;
};

}  // namespace glint

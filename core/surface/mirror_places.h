// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/surface: where on a surface the reflection law can hold, without a ray.

#include <array>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/surface/mesh_topology.h"
#include "core/surface/part_bounds.h"
#include "core/surface/surface.h"

namespace glint {

/// A surface that can rule out most of itself as a place of mirror reflection.
class MirrorPlaces {
 public:
  virtual ~MirrorPlaces() = default;
  /// One surface point from every part inside the view in which N may be parallel to H = unit(L + V), on either side; elsewhere
  /// it is proven that N is not. Nothing where the surface has no continuous normals, or is so rough that most parts remain.
  virtual std::optional<std::vector<SurfacePoint>> mirrorPlaces(const MirrorQuery& query) const = 0;
};

/// An octree over a mesh: balls around parts of it and cones around their normals. Float, with margins above its round-off: a
/// part is only ruled out when it is safe to.
class NormalTree {
 public:
  /// @param edgePoint  middle control point of a curved edge between two vertices; empty for flat triangles.
  NormalTree(const TriangleMesh& mesh, const MeshTopology& topology, const Eigen::AlignedBox3d& bounds,
             const std::function<Eigen::Vector3d(int, int)>& edgePoint);

  /// A triangle from every part in which N may be parallel to H. Nothing when they are more than `most`.
  std::optional<std::vector<int>> candidates(const MirrorQuery& query, std::size_t most) const;
  /// The same for the test of BoundedParts::partsThatMay, with the radii of the parts' balls, world units.
  /// @param fromOutside  parts are left out in which every normal points away from the eye by more than this angle (rad) beyond a
  ///   right one: outwardDeviation, for an eye outside of the box.
  std::optional<std::vector<std::pair<int, double>>> partsThatMay(const MirrorQuery& query, double lightReach,
                                                                  const PartTest& test, std::size_t most,
                                                                  std::optional<double> fromOutside) const;
  /// Every part is one triangle.
  bool finest() const { return finest_; }

 private:
  class Builder;
  /// Up to eight siblings: balls (centre, radius) in the box scaled to [-1, 1], and cones (axis, cosine and sine of the half
  /// angle).
  struct Block {
    Eight x, y, z, radius, axisX, axisY, axisZ, cosine, sine;
    std::array<int, 8> next;  ///< block of its children; of a part: -1 - triangle
    int count = 0;
  };

  /// A query in the tree's scaled coordinates.
  struct View {
    Eigen::Vector3f eye, light;
    float w;
    double lightUnit;  ///< |l - w P| in world units is this times its scaled length
    std::array<Eigen::Vector4f, 4> sides;
  };
  /// H over the balls of a block: the direction at their centres, and how far it turns within them.
  struct Halfway {
    Eight toEye, toLight, sum;  ///< lengths of V, L (scaled, not unit) and of unit(L) + unit(V), at the centres
    Eight viewAlong, between;   ///< V.axis and H.axis, at the centres
    Eight sine, cosine;         ///< of the half angle of the cone around H
    Eight viewChord;            ///< of the half angle of the cone around V
  };
  View viewOf(const MirrorQuery& query) const;
  static Halfway halfwayOf(const Block& b, const View& view, float lightReach);
  static Eight insideOf(const Block& b, const View& view);

  Eigen::Vector3d centre_;
  double scale_ = 1;
  bool finest_ = false;
  std::vector<Block> blocks_;  ///< the first one is the root's
};

}  // namespace glint

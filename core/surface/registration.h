// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/progress.h"
#include "core/geometry/transforms.h"
#include "core/surface/surface.h"

namespace glint {

/// A sparse point that a camera saw: nothing stands between the two.
struct SeenPoint {
  Eigen::Vector3d point, eye;                ///< in one frame and unit, that of the cameras
  std::vector<Eigen::Vector3d> orEyes = {};  ///< of other cameras, where it is not known which of them saw it
};

/// Where a mesh of another frame and unit lies among points of its surface and of other things. Lengths in the points' unit.
struct Registration {
  Similarity pointsFromMesh;
  std::size_t points = 0;     ///< that were given
  std::size_t explained = 0;  ///< of them, those on the mesh: within `tolerance` of it
  double rms = 0;             ///< distance of the explained ones from the mesh
  double tolerance = 0;       ///< 2.5 standard deviations of the explained ones' distances
  double size = 0;            ///< of the mesh: diagonal of its box
  double spacing = 0;         ///< median distance of an explained point to the nearest other one
  std::size_t hidden = 0;     ///< points that the mesh hides from the camera that saw them, or from all that may have
  std::size_t second = 0;     ///< points that the best solution with the mesh elsewhere explains
  int alike = 0;              ///< other solutions that put the same surface in the same place: the shape is symmetric
  double sigma = 0;           ///< standard deviation of the mesh's least certain corner
  std::string text() const;   ///< one line
};

/// The similarity that lays a mesh onto the points that show it: many starts over all rotations and over the sizes of the parts
/// of the cloud around what the cameras look at, each improved by trimmed iterated closest points with scale; the best ones by
/// robust least squares of the distances to the triangles. Solutions are compared by the likelihood of the points if those on the
/// mesh scatter about it evenly over its area and the others lie anywhere in the cloud's box: a mesh that is too large or too
/// small explains less.
///
/// The mesh may be a part of the object: points whose nearest place is its border lie on what it does not show, and do not pull
/// it. Points off the object do no harm as long as 20 points, and a tenth, lie on the mesh. The answer does not depend on any
/// order and is the same at every call.
///
/// @return TooFewPoints: fewer than 20, given or explained. NotConverged: no place explains the points, or the mesh would hide
///         them from their cameras. RankDeficient, "ambiguous ...": another place explains nearly as many, or the points let the
///         mesh slide or turn (a sphere, a cylinder, a plane). NotFinite. Stopped.
/// @see Umeyama, Least-squares estimation of transformation parameters between two point patterns, IEEE TPAMI 13(4), 1991.
///      Chetverikov et al., Robust Euclidean alignment of 3D point sets: the trimmed iterative closest point algorithm, IVC
///      23(3), 2005. Turk and Levoy, Zippered polygon meshes from range images, SIGGRAPH 1994, sec. 4 (points beside the border).
///      Gelfand et al., Geometrically stable sampling for the ICP algorithm, 3DIM 2003 (directions in which a shape slides).
Outcome<Registration> registerMesh(const TriangleMesh& mesh, const std::vector<SeenPoint>& points,
                                   const ProgressFn& progress = {});

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/mesh_placement.h"

#include <algorithm>

#include "core/base/number_text.h"

namespace glint {
namespace {

/// Frames with a vertex of a sample inside of their image.
int framesThatSee(const Scene& scene, const TriangleMesh& mesh) {
  constexpr std::size_t kSample = 1000;  // vertices: a mesh in view shows many of them
  const std::size_t step = std::max<std::size_t>(1, mesh.vertices.size() / kSample);
  int seeing = 0;
  for (const Frame& f : scene.frames) {
    bool sees = false;
    for (std::size_t i = 0; i < mesh.vertices.size() && !sees; i += step) {
      const std::optional<Pixel> ideal = f.camera.project(mesh.vertices[i]);
      const Pixel q = ideal ? f.camera.distorted(*ideal) : Pixel(-1, -1);
      sees = ideal && q.x() >= 0 && q.y() >= 0 && q.x() <= f.camera.width - 1 && q.y() <= f.camera.height - 1;
    }
    seeing += sees;
  }
  return seeing;
}

}  // namespace

MeshPlacement placementOf(const Scene& scene, const TriangleMesh& mesh, const std::vector<SeenPoint>& points,
                          const ProgressFn& progress) {
  if (scene.surfaces.size() != 1 || scene.surfaces.begin()->second.points) return {"", {}};
  const Outcome<Registration> found = registerMesh(mesh, points, progress);
  if (!found)
    return {
        "the place of the mesh among the sparse points was not found: " + found.failure().message() +
            " (a scan of a small part of the object, or a shape that turns onto itself, has to be laid onto the points by hand, "
            "for example in MeshLab or CloudCompare)",
        {}};
  const Correction correction = meshSimilarityCorrection(found->pointsFromMesh);
  try {
    const Scene moved = corrected(scene, correction.fix);
    const int seeing = framesThatSee(moved, mesh), all = static_cast<int>(moved.frames.size());
    if (2 * seeing < all)  // cameras that look elsewhere are no harm, but most are there for the object
      return {formatted("the sparse points put the mesh where %d of %d cameras see it", seeing, all), {}};
    return {formatted("moved to where the sparse points show it, the mesh is %.4g times as large and %d of %d cameras see it: ",
                      found->pointsFromMesh.scale, seeing, all) +
                found->text(),
            correction};
  } catch (const InputError& e) {  // depth maps or normals that would have to move, too
    return {std::string("the place of the mesh was found, but the scene cannot be moved to it: ") + e.what(), {}};
  }
}

}  // namespace glint

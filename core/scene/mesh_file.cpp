// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/mesh_file.h"

#include "io/mesh_reader.h"

namespace glint {
namespace {

TriangleMesh meshOf(MeshContent content) {
  return {std::move(content.vertices), std::move(content.normals), std::move(content.triangles)};
}

}  // namespace

TriangleMesh readMesh(const std::filesystem::path& file) { return meshOf(readMeshContent(file)); }

TriangleMesh readMesh(const SurfaceSource& source) {
  require(source.mesh.has_value(), "readMesh: the surface has no mesh");
  TriangleMesh mesh = readMesh(*source.mesh);
  if (source.metresPerUnit != 1)
    for (Eigen::Vector3d& v : mesh.vertices) v *= source.metresPerUnit;
  return mesh;
}

TriangleMesh meshOf(std::string_view bytes, const std::filesystem::path& file) { return meshOf(parseMesh(bytes, file)); }

}  // namespace glint

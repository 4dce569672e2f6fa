// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/mesh_file.h"

#include "io/mesh_reader.h"

namespace glint {

TriangleMesh readMesh(const std::filesystem::path& file) {
  MeshContent content = readMeshContent(file);
  return {std::move(content.vertices), std::move(content.normals), std::move(content.triangles)};
}

}  // namespace glint

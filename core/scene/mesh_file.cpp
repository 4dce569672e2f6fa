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

TriangleMesh meshOf(std::string_view bytes, const std::filesystem::path& file) { return meshOf(parseMesh(bytes, file)); }

}  // namespace glint

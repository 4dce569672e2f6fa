// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>

#include "core/scene/scene.h"
#include "core/surface/surface.h"

namespace glint {

/// Reads a PLY, OBJ, STL or glTF mesh, recognised by content, in the precision of the file (io/mesh_reader.h says what is understood).
/// Polygons are split into triangles. Normals are the file's (brought to length 1) when every vertex of a triangle has one, else
/// empty.
/// @throw InputError (file, place) when the file is missing, empty, not one of the four formats, truncated or longer than its
///        header promises, has no triangle, a coordinate that is not finite, or a face with a vertex that does not exist.
TriangleMesh readMesh(const std::filesystem::path& file);
/// The same of a surface, in metres. @pre it has a mesh
TriangleMesh readMesh(const SurfaceSource& source);
/// The same of a file's content; `file` is what messages name.
TriangleMesh meshOf(std::string_view bytes, const std::filesystem::path& file);

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "core/surface/surface.h"

namespace glint {

/// Reads a PLY, OBJ or STL mesh, recognised by content. Polygons are split into triangles. Vertices are float32 in the
/// reading library. Normals are the file's (normalised) when every vertex has a non-zero one, else empty.
/// @throw InputError (file, place) when the file is missing, empty, not one of the three formats, truncated (fewer bytes or
///        lines than its header promises), has no triangle, a non-finite vertex, or a face with a vertex that does not exist.
TriangleMesh readMesh(const std::filesystem::path& file);

}  // namespace glint

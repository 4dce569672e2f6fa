// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/scene/scene.h"
#include "core/surface/point_surface.h"

namespace glint {

/// Reads a PLY, OBJ, STL or glTF mesh, recognised by content, in the precision of the file (io/mesh_reader.h says what is understood).
/// Polygons are split into triangles. Normals are the file's (brought to length 1) when every vertex of a triangle has one, else
/// empty.
/// @throw InputError (file, place) when the file is missing, empty, not one of the four formats, truncated or longer than its
///        header promises, has no triangle, a coordinate that is not finite, or a face with a vertex that does not exist.
TriangleMesh readMesh(const std::filesystem::path& file);
/// The same of a surface, in metres; of points the surface that is made from them. @pre it has a mesh
/// @param findings  gets a line where facets of the file have a corner without a place and are left out
/// @throw InputError also where no surface can be made of the points, with the named reason
TriangleMesh readMesh(const SurfaceSource& source, std::vector<std::string>* findings = nullptr);
/// The points of a surface that is made of points (`isCloud` or `points`), in metres. InputError.
PointCloud readCloud(const SurfaceSource& source);
/// The surface of these points, with what was found about them. As surfaceOfPoints; InputError for the file.
Outcome<PointSurface> readPointSurface(const SurfaceSource& source, const ProgressFn& progress = {});
/// Whether a file holds points without triangles (PLY without faces, PCD), by its first bytes.
bool isCloudFile(const std::filesystem::path& file);
/// The same of a file's content; `file` is what messages name.
TriangleMesh meshOf(std::string_view bytes, const std::filesystem::path& file);

}  // namespace glint

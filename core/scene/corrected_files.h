// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/correction.h"
#include "core/scene/scene.h"

namespace glint {

/// "Turn the sides of the mesh": facets and normals point outwards, in a new mesh beside the corrected scene.
Correction flipFacesCorrection();

/// The mesh with its sides right: the facets of a closed mesh look outwards, most of the eyes see those of an open mesh from
/// their front, and normals are on the side of their facets. @param eyes  of the cameras, in the mesh's frame and unit
TriangleMesh withSidesRight(TriangleMesh mesh, const std::vector<Eigen::Vector3d>& eyes);

/// The scene with these corrections, in this order, for a scene file that will be `output`. What a scene file cannot say is
/// written beside it, as NAME.SURFACE.ply: meshes for "flip-faces", in doubles and in the unit of the file that they replace.
/// @throw InputError as `corrected`; where no mesh has its sides reversed; where such a file exists that this function did not
///   write. Files that it had written are then removed.
Scene correctedFor(Scene scene, const std::vector<std::string>& fixes, const std::filesystem::path& output);

}  // namespace glint

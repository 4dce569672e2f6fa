// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/transforms.h"
#include "core/scene/scene.h"

namespace glint {

/// A change that undoes a likely mistake of the program that wrote a scene: what the convention report proposes, `glint convert
/// --fix` makes and the inspector has a button for.
struct Correction {
  std::string fix;    ///< as --fix takes it: "invert-poses", "depth-scale=0.001"
  std::string words;  ///< for a button: "Invert the poses"
};

/// How poses, or the mesh's unit, may have been meant.
struct GeometryCorrection {
  const char* fix;
  const char* words;
  double meshScale, poseScale;  ///< factors of the mesh's coordinates and of the camera's translation
  bool inverse, turned;         ///< poses were stored as camera to world; with OpenGL's axes (y up, z backwards)
  Eigen::Isometry3d camFromWorld(const Eigen::Isometry3d& asRead) const;
};
const std::vector<GeometryCorrection>& geometryCorrections();

/// "Add +0.5 px to cx and cy": the principal point was stored with the other origin of pixels. @param px  0.5 or -0.5
Correction principalPointCorrection(double px);
/// @param factor  > 0, of fx and fy
Correction focalLengthCorrection(double factor);
/// @param metresPerUnit  > 0, of integer depth maps (scene.json's depth_scale)
Correction depthScaleCorrection(double metresPerUnit);

/// "Turn the cameras by 90 degrees, as the photographs are": poses and intrinsics belong to pictures that were turned since.
/// @param degrees  clockwise: 90, 180 or 270
Correction turnCamerasCorrection(int degrees);
/// "Move the cameras into the frame of the mesh": the mesh stays as it is, poses take over its frame and its unit.
/// @param camerasFromMesh  from the mesh to the world of the cameras, both in metres as they were read
Correction meshSimilarityCorrection(const Similarity& camerasFromMesh);

/// The scene with the correction made; images, meshes and measured highlights stay as they are.
/// @throws InputError("--fix", ...)  where there is no such correction, its value is out of range, or the scene has what it
///   cannot change
Scene corrected(Scene scene, std::string_view fix);
/// "invert-poses, turn-axes, ..., depth-scale=VALUE": for messages and help.
std::string correctionNames();

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

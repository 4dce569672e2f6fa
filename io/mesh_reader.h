// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "io/mesh_content.h"

namespace glint {

/// Reads a PLY, OBJ, STL or glTF mesh, recognised by content. Every count, index and length is checked against the file before it
/// is used, nothing is allocated for what the file does not hold, and numbers are read the same in every locale.
/// Polygons become fans of triangles around their first corner; where the fan would leave the polygon, it is cut inside itself.
/// Vertices that no face uses may be NaN and are left out. A million triangles take about a second. Our own readers: those of PCL
/// and VTK bring VTK into core, and do not name the place of a fault.
/// @throw InputError (file; line in text, byte in binary files, and the element) if the file is missing, empty, none of the
///        four formats, truncated, longer than its header promises, or contradicts itself; when a face has fewer than three
///        corners or names a vertex, normal or texture coordinate that does not exist; when a coordinate of a face is not a
///        number below 1e30 in size; when concave polygons are so large that their cut would take minutes; when there is no face.
MeshContent readMeshContent(const std::filesystem::path& file);

/// The same for bytes in memory. @param file  for messages; its extension tells a damaged STL from other binary files, and the
/// buffers of a glTF lie in its folder.
MeshContent parseMesh(std::string_view bytes, const std::filesystem::path& file);

/// One format each; `parseMesh` chooses. PLY: ascii and binary of both byte orders, any scalar types, further properties and
/// elements are skipped. Faces are the element "face", or "tristrips", -1 between strips. @see Turk, The PLY File Format, 1994.
MeshContent parsePly(std::string_view bytes, const std::string& file);
/// OBJ: v, vn, vt and f are read (also negative indices, v//n, mixed corners, lines that go on after a backslash), other
/// statements are skipped. A vertex with two different normals becomes two. @see Wavefront, Object Files (.obj), Appendix B1.
MeshContent parseObj(std::string_view bytes, const std::string& file);
/// STL: corners at the same place become one vertex; the facets' normals are not read (the winding says the same). Facets with a
/// corner that is not finite are left out and counted.
MeshContent parseStlText(std::string_view bytes, const std::string& file);
MeshContent parseStlBinary(std::string_view bytes, const std::string& file);
/// glTF 2.0, as text (.gltf) or in a container (.glb): triangles, strips and fans of the default scene's meshes, each at the
/// place of its node. Other scenes, points, lines, looks, cameras and animations are skipped: the shape is that at rest.
/// Coordinates are taken as they are; the format says right-handed, y up, metres. A node that mirrors turns its triangles
/// around, so that their outer side stays outside. Primitives with the same positions share their vertices; those of a
/// primitive without them are zero. Buffers are in the file, or are files in its folder or below: no other file is ever opened.
/// @throw InputError also if the nodes are no trees, for skins and morph targets in use, for meshes repeated so often that
///        memory would no longer go with the file's size, and, by name, for extensions without which the file cannot be
///        understood (Draco, meshopt). KHR_mesh_quantization is read.
/// @see Khronos Group, glTF 2.0 Specification, 2021.
MeshContent parseGltf(std::string_view bytes, const std::filesystem::path& file);

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

/// What a file of points without triangles holds, as it was written.
/// Invariant: points are finite and there is at least one.
struct CloudContent {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;  ///< one per point, unit; empty unless every point has one
  std::size_t without = 0;               ///< points of the file without a place: NaN where a sensor saw nothing (PCD)
};

/// Whether a file with this start is a cloud: a PCD file, or a PLY file whose header, all of it within `start`, names no faces.
bool looksLikeCloud(std::string_view start);
inline constexpr std::size_t kCloudHeader = 4096;  // bytes that tell; a longer header is that of a mesh with many properties

/// Reads PLY without faces, or PCD, recognised by content. Checked as meshes are (io/mesh_reader.h).
/// @throw InputError (file; line in text, byte in binary files) if the file is missing, empty, neither of the two, truncated,
///        longer than its header promises, or contradicts itself; when it has faces; when there is no point.
CloudContent readCloudContent(const std::filesystem::path& file);
/// The same for bytes in memory. @param file  for messages
CloudContent parseCloud(std::string_view bytes, const std::filesystem::path& file);

CloudContent parsePlyCloud(std::string_view bytes, const std::string& file);
/// PCD 0.6 and 0.7: ascii, binary and binary_compressed (LZF); the fields x y z, and normal_x normal_y normal_z; others are
/// skipped. The VIEWPOINT is not applied: coordinates are taken as they are, as PCL does. @see PCL, The PCD file format.
CloudContent parsePcd(std::string_view bytes, const std::string& file);

}  // namespace glint

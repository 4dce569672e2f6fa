// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/base/found_file.h"
#include "core/base/safe_text.h"
#include "core/scene/correction.h"
#include "core/scene/geometry_check.h"
#include "core/scene/scene_reader.h"

namespace glint {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFlipFaces = "flip-faces";
constexpr const char* kOwnMesh = "comment written by Glint: sides turned";  // tells it from a file of somebody else
constexpr std::size_t kHeaderBytes = 200;                                   // in which the comment stands

template <class T>
void append(std::string& bytes, T value) {
  auto bits = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bits.begin(), bits.end());
  bytes.append(bits.data(), bits.size());
}

std::string plyOf(const TriangleMesh& mesh) {
  const bool normals = !mesh.normals.empty();
  std::string ply = std::string("ply\nformat binary_little_endian 1.0\n") + kOwnMesh + "\nelement vertex " +
                    std::to_string(mesh.vertices.size()) + "\n";
  for (const char* name : {"x", "y", "z"}) ply += std::string("property double ") + name + "\n";
  if (normals)
    for (const char* name : {"nx", "ny", "nz"}) ply += std::string("property double ") + name + "\n";
  ply += "element face " + std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (int k = 0; k < 3; ++k) append(ply, mesh.vertices[i][k]);
    if (normals)
      for (int k = 0; k < 3; ++k) append(ply, mesh.normals[i][k]);
  }
  for (const Eigen::Vector3i& t : mesh.triangles) {
    append(ply, std::uint8_t{3});
    for (int k = 0; k < 3; ++k) append(ply, std::int32_t{t[k]});
  }
  return ply;
}

/// Area that the eyes see from its front, minus the area seen from behind. Occlusion is ignored: an open mesh hides little of
/// itself.
double areaFacing(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& eyes) {
  double facing = 0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[std::size_t(t[0])], &b = mesh.vertices[std::size_t(t[1])],
                          &c = mesh.vertices[std::size_t(t[2])];
    const Eigen::Vector3d area = (b - a).cross(c - a);
    for (const Eigen::Vector3d& eye : eyes) facing += area.dot((eye - a).normalized());
  }
  return facing;
}

/// Writes one mesh; a file that is not one of these stays. @return whether the file is new
bool writeMesh(const fs::path& file, const TriangleMesh& mesh) {
  std::error_code ignored;  // a file that cannot be looked at counts as missing; writing fails then
  const bool there = fs::exists(file, ignored);
  if (there && firstBytes(file, kHeaderBytes).find(kOwnMesh) == std::string::npos)
    throw InputError(file.string(), "", "exists, and is no mesh that --fix flip-faces wrote; choose another output");
  atomicWrite(file, plyOf(mesh));
  return !there;
}

void flipFaces(Scene& scene, const fs::path& output, std::vector<fs::path>& written) {
  bool any = false;
  for (auto& [id, source] : scene.surfaces) {
    MeshFile* const given = std::get_if<MeshFile>(&source);
    if (!given) continue;
    TriangleMesh mesh = readMesh(given->file);
    if (sidesOf(mesh).empty()) continue;
    any = true;
    std::vector<Eigen::Vector3d> eyes;
    for (const Frame& f : scene.frames)
      if (f.surface == id) eyes.push_back(f.camera.centreInWorld() / given->metresPerUnit);
    const fs::path file = output.parent_path() / (output.stem().string() + "." + fileNameOf(id) + ".ply");
    std::error_code ignored;  // a path that cannot be looked at counts as another file
    if (fs::equivalent(file, given->file, ignored))
      throw InputError(file.string(), "--fix flip-faces", "is an input file; choose another output");
    if (writeMesh(file, withSidesRight(std::move(mesh), eyes))) written.push_back(file);
    given->file = fs::absolute(file).lexically_normal();
    given->named.clear();
  }
  if (!any) throw InputError("--fix", kFlipFaces, "no mesh has its sides reversed");
}

}  // namespace

Correction flipFacesCorrection() { return {kFlipFaces, "Turn the sides of the mesh"}; }

TriangleMesh withSidesRight(TriangleMesh mesh, const std::vector<Eigen::Vector3d>& eyes) {
  if ((isClosed(mesh) ? signedVolume(mesh) : areaFacing(mesh, eyes)) < 0)
    for (Eigen::Vector3i& t : mesh.triangles) std::swap(t[1], t[2]);
  if (normalsAgainstFacets(mesh))
    for (Eigen::Vector3d& n : mesh.normals) n = -n;
  return mesh;
}

Scene correctedFor(Scene scene, const std::vector<std::string>& fixes, const fs::path& output) {
  std::vector<fs::path> written;
  try {
    for (const std::string& fix : fixes) {
      if (fix == kFlipFaces)
        flipFaces(scene, output, written);
      else
        scene = corrected(std::move(scene), fix);
    }
  } catch (...) {
    std::error_code ignored;  // the first failure counts
    for (const fs::path& file : written) fs::remove(file, ignored);
    throw;
  }
  return scene;
}

}  // namespace glint

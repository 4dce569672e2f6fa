// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh_builder.h"

#include "core/base/outcome.h"

namespace glint::io {

void fail(const std::string& file, const std::string& place, const std::string& reason) { throw InputError(file, place, reason); }

std::string lineNo(std::size_t line) { return "line " + std::to_string(line); }
std::string byteNo(std::size_t byte) { return "byte " + std::to_string(byte); }

const char* badCoordinate(const Eigen::Vector3d& v) {
  constexpr double kFarthest = 1e30;  // metres; a product of six lengths stays within double
  if (!v.allFinite()) return "is not finite";
  return v.cwiseAbs().maxCoeff() > kFarthest ? "is farther than 1e30 from the origin" : nullptr;
}

namespace {
constexpr double kUnset = 1e-6;  // normals have length 1, whatever the scene's unit

/// False where there is none to bring to length 1.
bool madeUnit(Eigen::Vector3d& n) {
  const double length = n.norm();
  if (!(length > kUnset) || !std::isfinite(length)) return false;
  n /= length;
  return true;
}
}  // namespace

CloudContent finished(CloudContent cloud, const std::string& file) {
  if (cloud.points.empty()) fail(file, "", "the cloud has no points");
  for (Eigen::Vector3d& n : cloud.normals)
    if (!madeUnit(n)) {
      cloud.normals.clear();
      break;
    }
  return cloud;
}

MeshContent finished(MeshContent mesh, const std::string& file) {
  if (mesh.triangles.empty()) fail(file, "", "the mesh has no faces");
  if (mesh.normals.empty()) return mesh;
  std::vector<char> lacking(mesh.vertices.size(), 0);
  bool any = false;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    Eigen::Vector3d& n = mesh.normals[i];
    if (madeUnit(n)) continue;
    lacking[i] = 1;
    any = true;
    n = Eigen::Vector3d::UnitZ();  // of a vertex that no triangle has: never asked
  }
  if (any)
    for (const Eigen::Vector3i& t : mesh.triangles)
      if (lacking[std::size_t(t.x())] || lacking[std::size_t(t.y())] || lacking[std::size_t(t.z())]) {
        mesh.normals.clear();
        break;
      }
  return mesh;
}

}  // namespace glint::io

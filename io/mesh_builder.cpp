// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh_builder.h"

#include <algorithm>

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

/// False if its length is zero or not finite.
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
  for (Eigen::Vector3d& n : mesh.normals)
    if (!madeUnit(n)) n.setZero();
  const auto has = [&](int vertex) { return !mesh.normals[std::size_t(vertex)].isZero(); };
  if (!mesh.normals.empty() && std::none_of(mesh.triangles.begin(), mesh.triangles.end(),
                                            [&](const Eigen::Vector3i& t) { return has(t.x()) || has(t.y()) || has(t.z()); }))
    mesh.normals.clear();
  return mesh;
}

void BadVertices::remove(MeshContent& mesh, const std::string& file,
                         const std::function<std::string(std::size_t, std::size_t)>& placeOf) const {
  if (found_.empty()) return;
  constexpr int kGone = -1;
  std::vector<int> number(mesh.vertices.size());
  std::size_t kept = 0, bad = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    const bool gone = bad < found_.size() && found_[bad].vertex == i;
    number[i] = gone ? kGone - int(bad++) : int(kept++);
  }
  for (Eigen::Vector3i& t : mesh.triangles)
    for (int& corner : t) {
      const int now = number[std::size_t(corner)];
      if (now <= kGone) {
        const Bad& used = found_[std::size_t(kGone - now)];
        fail(file, placeOf(used.vertex, used.place), badCoordinate(mesh.vertices[used.vertex]));
      }
      corner = now;
    }
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] <= kGone) continue;
    mesh.vertices[std::size_t(number[i])] = mesh.vertices[i];
    if (!mesh.normals.empty()) mesh.normals[std::size_t(number[i])] = mesh.normals[i];
  }
  mesh.vertices.resize(kept);
  if (!mesh.normals.empty()) mesh.normals.resize(kept);
}

}  // namespace glint::io

// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/mesh_file.h"

#include "core/base/number_text.h"
#include "core/scene/scene_reader.h"
#include "io/cloud_reader.h"
#include "io/mesh_reader.h"

namespace glint {
namespace {

TriangleMesh meshOf(MeshContent content) {
  return {std::move(content.vertices), std::move(content.normals), std::move(content.triangles)};
}

}  // namespace

TriangleMesh readMesh(const std::filesystem::path& file) { return meshOf(readMeshContent(file)); }

TriangleMesh readMesh(const SurfaceSource& source, std::vector<std::string>* findings) {
  require(source.mesh.has_value(), "readMesh: the surface has no mesh");
  if (source.isCloud || source.points) {
    Outcome<PointSurface> made = readPointSurface(source);
    if (!made) throw InputError(source.mesh->string(), "", "no surface can be made of its points: " + made.failure().message());
    return std::move(made->mesh);
  }
  MeshContent content = readMeshContent(*source.mesh);
  if (findings && content.leftOut > 0)
    findings->push_back(formatted("%s lacks %zu of its %zu facets: a corner of each has no place", source.mesh->string().c_str(),
                                  content.leftOut, content.triangles.size() + content.leftOut));
  TriangleMesh mesh = meshOf(std::move(content));
  if (source.metresPerUnit != 1)
    for (Eigen::Vector3d& v : mesh.vertices) v *= source.metresPerUnit;
  return mesh;
}

PointCloud readCloud(const SurfaceSource& source) {
  require(source.mesh && (source.isCloud || source.points), "readCloud: the surface is not made of points");
  if (source.points) return *source.points;
  CloudContent content = readCloudContent(*source.mesh);
  PointCloud cloud{std::move(content.points), std::move(content.normals)};
  for (Eigen::Vector3d& p : cloud.points) p *= source.metresPerUnit;
  return cloud;
}

Outcome<PointSurface> readPointSurface(const SurfaceSource& source, const ProgressFn& progress) {
  return surfaceOfPoints(readCloud(source), {}, progress);
}

bool isCloudFile(const std::filesystem::path& file) { return looksLikeCloud(firstBytes(file, kCloudHeader)); }

TriangleMesh meshOf(std::string_view bytes, const std::filesystem::path& file) { return meshOf(parseMesh(bytes, file)); }

}  // namespace glint

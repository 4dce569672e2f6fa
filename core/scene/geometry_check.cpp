// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/geometry_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace glint {
namespace {

constexpr std::size_t kSightSample = 300;  // vertices: shares to a few percent

/// The words for each of geometryCorrections(), in their order.
constexpr std::array<const char*, 6> kMistakeWords{
    "poses are camera to world: invert them",
    "camera axes are OpenGL's, y up and z backwards: turn the y and z axes",
    "poses are camera to world with OpenGL's axes, y up and z backwards: invert them and turn the y and z axes",
    "the mesh is in millimetres and the poses are in metres: give its unit (surfaces.ID.units, --surface-units mm)",
    "the mesh is in centimetres and the poses are in metres: give its unit (surfaces.ID.units, --surface-units cm)",
    "the poses are in millimetres and the mesh is in metres: divide translations by 1000 (--units mm --surface-units m)",
};

Camera withMistakeUndone(Camera camera, const GeometryCorrection& correction) {
  camera.camFromWorld = correction.camFromWorld(camera.camFromWorld);
  return camera;
}

bool sees(const Camera& camera, const std::vector<Eigen::Vector3d>& points, double scale) {
  std::size_t inside = 0;
  for (const Eigen::Vector3d& p : points) {
    const std::optional<Pixel> ideal = camera.project(scale * p);
    if (!ideal) continue;
    const Pixel q = camera.distorted(*ideal);
    inside += q.x() >= -0.5 && q.y() >= -0.5 && q.x() < camera.width - 0.5 && q.y() < camera.height - 0.5;
  }
  return 2 * inside >= points.size();
}

std::vector<Eigen::Vector3d> sampleOf(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> points;
  const std::size_t step = std::max<std::size_t>(1, mesh.vertices.size() / kSightSample);
  for (std::size_t i = 0; i < mesh.vertices.size(); i += step) points.push_back(mesh.vertices[i]);
  return points;
}

}  // namespace

const SightHypothesis* SightCheck::explanation() const {
  if (undone.empty() || frames == 0 || 2 * seeing >= frames) return nullptr;
  const SightHypothesis& best = undone.front();
  if (10 * best.seeing < 9 * frames) return nullptr;
  return undone.size() > 1 && undone[1].seeing == best.seeing ? nullptr : &best;
}

SightCheck checkSight(const Scene& scene, const std::function<const TriangleMesh&(const std::string&)>& trianglesOf) {
  SightCheck check;
  std::map<std::string, std::vector<Eigen::Vector3d>> samples;
  for (const auto& [id, source] : scene.surfaces) samples[id] = sampleOf(trianglesOf(id));
  const std::vector<GeometryCorrection>& undoing = geometryCorrections();
  require(undoing.size() == kMistakeWords.size(), "checkSight: a correction without words");
  for (std::size_t i = 0; i < undoing.size(); ++i)
    check.undone.push_back({kMistakeWords[i], {undoing[i].fix, undoing[i].words}, 0});
  for (const Frame& frame : scene.frames) {
    const auto points = samples.find(frame.surface);
    if (points == samples.end() || points->second.empty()) continue;
    ++check.frames;
    check.seeing += sees(frame.camera, points->second, 1);
    for (std::size_t i = 0; i < undoing.size(); ++i)
      check.undone[i].seeing += sees(withMistakeUndone(frame.camera, undoing[i]), points->second, undoing[i].meshScale);
  }
  std::stable_sort(check.undone.begin(), check.undone.end(),
                   [](const SightHypothesis& a, const SightHypothesis& b) { return a.seeing > b.seeing; });
  return check;
}

bool isClosed(const TriangleMesh& mesh) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Eigen::Vector3i& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  return std::all_of(edges.begin(), edges.end(),
                     [&](const auto& e) { return std::binary_search(edges.begin(), edges.end(), std::pair(e.second, e.first)); });
}

double signedVolume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[std::size_t(t[0])], &b = mesh.vertices[std::size_t(t[1])],
                          &c = mesh.vertices[std::size_t(t[2])];
    volume += (a - mesh.vertices.front()).dot((b - mesh.vertices.front()).cross(c - mesh.vertices.front()));
  }
  return volume;
}

bool normalsAgainstFacets(const TriangleMesh& mesh) {
  if (mesh.normals.empty()) return false;
  std::size_t against = 0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[std::size_t(t[0])], &b = mesh.vertices[std::size_t(t[1])],
                          &c = mesh.vertices[std::size_t(t[2])];
    const Eigen::Vector3d mean =
        mesh.normals[std::size_t(t[0])] + mesh.normals[std::size_t(t[1])] + mesh.normals[std::size_t(t[2])];
    against += (b - a).cross(c - a).dot(mean) < 0;
  }
  return 2 * against > mesh.triangles.size();
}

std::string sidesOf(const TriangleMesh& mesh) {
  if (normalsAgainstFacets(mesh)) return "the normals of its vertices point against its facets";
  if (signedVolume(mesh) < 0 && isClosed(mesh)) return "it is closed, and its facets and normals point inwards";
  return "";
}

}  // namespace glint

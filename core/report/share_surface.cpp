// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <unordered_map>

#include "core/base/bytes.h"
#include "core/draw/on_surface.h"
#include "core/report/share_parts.h"
#include "core/surface/mesh_policy.h"

namespace glint::share {
namespace {

constexpr std::size_t kMostTriangles = 120000;          ///< of all surfaces: 2.6 MB, and smooth without a graphics card
constexpr std::size_t kFewestTriangles = 2000;          ///< of one: a surface stays one
constexpr int kFinestCells = 128, kCoarsestCells = 24;  ///< a side of an analytic surface

bool isUsable(const TriangleMesh& mesh, const Eigen::Vector3i& t) {
  if (t.minCoeff() < 0 || t.maxCoeff() >= static_cast<int>(mesh.vertices.size())) return false;
  for (int k = 0; k < 3; ++k)
    if (!mesh.vertices[static_cast<std::size_t>(t[k])].allFinite()) return false;
  return true;
}

/// Only the triangles that can be drawn, and the vertices that they use.
TriangleMesh drawable(const TriangleMesh& mesh) {
  TriangleMesh out;
  const bool normals = mesh.normals.size() == mesh.vertices.size();
  std::vector<int> place(mesh.vertices.size(), -1);
  for (const Eigen::Vector3i& t : mesh.triangles) {
    if (!isUsable(mesh, t)) continue;
    Eigen::Vector3i moved;
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(t[k]);
      if (place[v] < 0) {
        place[v] = static_cast<int>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[v]);
        if (normals) out.normals.push_back(mesh.normals[v]);
      }
      moved[k] = place[v];
    }
    out.triangles.push_back(moved);
  }
  return out;
}

Eigen::AlignedBox3d boxOf(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : mesh.vertices) box.extend(v);
  return box;
}

/// One vertex for each cell of a grid with so many cells along the longest side. @param mesh  drawable, not empty
TriangleMesh clustered(const TriangleMesh& mesh, int cells) {
  const Eigen::AlignedBox3d box = boxOf(mesh);
  const double cell = std::max(box.sizes().maxCoeff(), std::numeric_limits<double>::min()) / cells;
  TriangleMesh out;
  const bool normals = !mesh.normals.empty();
  std::unordered_map<long long, int> known;
  std::vector<int> place(mesh.vertices.size()), members;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Eigen::Vector3d at = (mesh.vertices[v] - box.min()) / cell;
    long long key = 0;
    for (int k = 0; k < 3; ++k) key = key * (cells + 2LL) + std::clamp<long long>(std::llround(std::floor(at[k])), 0, cells);
    const auto [found, isNew] = known.emplace(key, static_cast<int>(out.vertices.size()));
    place[v] = found->second;
    if (isNew) {
      out.vertices.push_back(Eigen::Vector3d::Zero());
      if (normals) out.normals.push_back(Eigen::Vector3d::Zero());
      members.push_back(0);
    }
    const auto to = static_cast<std::size_t>(place[v]);
    out.vertices[to] += mesh.vertices[v];
    if (normals) out.normals[to] += mesh.normals[v];
    ++members[to];
  }
  for (std::size_t v = 0; v < out.vertices.size(); ++v) out.vertices[v] /= members[v];
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto at = [&](int k) { return place[static_cast<std::size_t>(t[k])]; };
    if (at(0) != at(1) && at(1) != at(2) && at(2) != at(0)) out.triangles.emplace_back(at(0), at(1), at(2));
  }
  return out;
}

void append16(std::vector<unsigned char>& bytes, unsigned value) {
  bytes.push_back(static_cast<unsigned char>(value & 255));
  bytes.push_back(static_cast<unsigned char>(value >> 8));
}

}  // namespace

TriangleMesh simplified(const TriangleMesh& given, std::size_t most) {
  const TriangleMesh mesh = drawable(given);
  if (mesh.triangles.size() <= most) return mesh;
  // A closed surface of n cells along a side has some 4 pi (n/2)^2 cells with two triangles each.
  double cells = std::sqrt(static_cast<double>(most) / (2 * std::numbers::pi)) * 1.6;
  for (;;) {
    const TriangleMesh coarse = clustered(mesh, std::max(1, static_cast<int>(cells)));
    if (coarse.triangles.size() <= most || cells < 1) return drawable(coarse);
    cells *= std::min(0.9, std::sqrt(static_cast<double>(most) / static_cast<double>(coarse.triangles.size())));
  }
}

std::string packed(const TriangleMesh& mesh, std::size_t of) {
  constexpr double kSteps = 65535, kUnit = 127;
  const Eigen::AlignedBox3d box = mesh.vertices.empty() ? Eigen::AlignedBox3d(Eigen::Vector3d::Zero()) : boxOf(mesh);
  const Eigen::Vector3d step = box.sizes() / kSteps;
  std::vector<unsigned char> positions, normals, indices;
  for (const Eigen::Vector3d& v : mesh.vertices)
    for (int k = 0; k < 3; ++k)
      append16(positions,
               step[k] > 0 ? static_cast<unsigned>(std::clamp(std::round((v[k] - box.min()[k]) / step[k]), 0.0, kSteps)) : 0U);
  for (const Eigen::Vector3d& n : mesh.normals) {
    const double length = n.norm();
    for (int k = 0; k < 3; ++k) {
      const double value = length > 0 && std::isfinite(length) ? n[k] / length : 0;
      normals.push_back(static_cast<unsigned char>(static_cast<signed char>(std::lround(kUnit * std::clamp(value, -1.0, 1.0)))));
    }
  }
  for (const Eigen::Vector3i& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      append16(indices, static_cast<unsigned>(t[k]) & 0xffff);
      append16(indices, static_cast<unsigned>(t[k]) >> 16);
    }
  const auto vector = [](const Eigen::Vector3d& v) {
    return "[" + exactly(v.x()) + "," + exactly(v.y()) + "," + exactly(v.z()) + "]";
  };
  return "\"triangles\":" + std::to_string(mesh.triangles.size()) + ",\"of\":" + std::to_string(of) +
         ",\"origin\":" + vector(box.min()) + ",\"step\":" + vector(step) + ",\"positions\":\"" + base64(positions) +
         "\",\"normals\":\"" + base64(normals) + "\",\"indices\":\"" + base64(indices) + "\"";
}

namespace {

/// @param most  triangles of this surface
std::string surfaceJson(const Inspection& inspection, const std::string& key, int frame, const std::vector<int>& frames,
                        std::size_t most, Eigen::AlignedBox3d& box) {
  const auto surface = inspection.surfaces->surfaceOf(frame, meshPolicy(inspection.request.settings));
  if (!surface) return "{\"key\":" + quoted(key) + ",\"problem\":" + quoted(surface.failure().message()) + "}";
  const Eigen::AlignedBox3d region = draw::shownRegion(inspection, **surface, frames);
  if (region.isEmpty()) return "{\"key\":" + quoted(key) + ",\"problem\":\"no camera sees the surface\"}";
  const int cells = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(most) / 2)), kCoarsestCells, kFinestCells);
  const TriangleMesh all = (*surface)->tessellate(region, cells);
  const TriangleMesh mesh = simplified(all, most);
  box = mesh.vertices.empty() ? region : boxOf(mesh);
  return "{\"key\":" + quoted(key) + ",\"problem\":\"\"," + packed(mesh, all.triangles.size()) + "}";
}

}  // namespace

SharedSurfaces surfacesOf(const Inspection& inspection, const std::vector<int>& frames, const ProgressFn& progress) {
  SharedSurfaces out;
  std::map<std::string, int> index;
  std::vector<std::pair<std::string, int>> first;  // as fits name it, frame
  for (const int frame : frames) {
    const std::string key = inspection.surfaces ? inspection.surfaces->placedKeyOf(frame) : "";
    const auto [found, isNew] = index.emplace(key, static_cast<int>(first.size()));
    if (isNew) first.emplace_back(inspection.surfaces ? inspection.surfaces->keyOf(frame) : "", frame);
    out.ofFrame.push_back(inspection.surfaces ? found->second : -1);
  }
  const std::size_t most = std::max(kFewestTriangles, kMostTriangles / std::max<std::size_t>(1, first.size()));
  for (std::size_t i = 0; inspection.surfaces && i < first.size(); ++i) {
    if (!report(progress, {"surface", static_cast<int>(i), static_cast<int>(first.size())})) throw Stopped{};
    Eigen::AlignedBox3d box;
    out.json += (i ? "," : "") + surfaceJson(inspection, first[i].first, first[i].second, frames, most, box);
    if (!box.isEmpty()) out.box.extend(box);
  }
  out.json = "[" + out.json + "]";
  return out;
}

}  // namespace glint::share

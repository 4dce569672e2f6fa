// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/mesh_topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace glint {

using Eigen::Vector3d;
using Eigen::Vector3i;

namespace {

/// The same number for vertices with equal coordinates.
std::vector<int> weld(const std::vector<Vector3d>& vertices) {
  std::vector<int> order(vertices.size()), welded(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto less = [&](int a, int b) {
    const Vector3d &p = vertices[a], &q = vertices[b];
    return p.x() != q.x() ? p.x() < q.x() : p.y() != q.y() ? p.y() < q.y() : p.z() < q.z();
  };
  std::sort(order.begin(), order.end(), less);
  for (std::size_t i = 0; i < order.size(); ++i)
    welded[order[i]] = i > 0 && vertices[order[i]] == vertices[order[i - 1]] ? welded[order[i - 1]] : order[i];
  return welded;
}

/// Angle at a corner of a triangle.
double cornerAngle(const Vector3d& at, const Vector3d& b, const Vector3d& c) {
  const Vector3d u = b - at, v = c - at;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

Vector3d faceVector(const TriangleMesh& mesh, const Vector3i& t) {
  return (mesh.vertices[t.y()] - mesh.vertices[t.x()]).cross(mesh.vertices[t.z()] - mesh.vertices[t.x()]);
}

/// Drops triangles without a normal, and those that repeat another one.
void dropBadTriangles(const TriangleMesh& mesh, const std::vector<int>& welded, MeshTopology& topology) {
  const int count = static_cast<int>(mesh.triangles.size());
  std::vector<std::pair<std::array<int, 3>, int>> keys(count);
  for (int i = 0; i < count; ++i) {
    const Vector3i& t = mesh.triangles[i];
    std::array<int, 3> key{welded[t.x()], welded[t.y()], welded[t.z()]};
    std::sort(key.begin(), key.end());
    keys[i] = {key, i};
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]]).squaredNorm());
    // Thinner than 1e-12 of its length: the normal would be round-off.
    if (key[0] == key[1] || key[1] == key[2] || !(faceVector(mesh, t).norm() > 1e-12 * longest)) topology.alive[i] = 0;
  }
  std::sort(keys.begin(), keys.end());
  for (int i = 1; i < count; ++i)
    if (keys[i].first == keys[i - 1].first) topology.alive[keys[i].second] = 0;
}

/// For each side of a triangle whether its neighbour winds the other way.
using Opposed = std::vector<std::array<char, 3>>;

/// Joins triangles over edges that two of them share.
Opposed joinNeighbours(const TriangleMesh& mesh, const std::vector<int>& welded, MeshTopology& topology) {
  struct HalfEdge {
    std::uint64_t key;
    int triangle;
    std::int8_t corner, forward;
  };
  const int count = static_cast<int>(mesh.triangles.size());
  std::vector<HalfEdge> edges;
  edges.reserve(3 * static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    if (!topology.alive[i]) continue;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = welded[mesh.triangles[i][k]], b = welded[mesh.triangles[i][(k + 1) % 3]];
      edges.push_back({static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b), i, static_cast<std::int8_t>(k),
                       static_cast<std::int8_t>(a < b)});
    }
  }
  std::sort(edges.begin(), edges.end(),
            [](const HalfEdge& a, const HalfEdge& b) { return a.key != b.key ? a.key < b.key : a.triangle < b.triangle; });
  Opposed opposed(count, {0, 0, 0});
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].key == edges[i].key) ++end;
    if (end - i == 2) {
      const HalfEdge &a = edges[i], &b = edges[i + 1];
      topology.neighbours[a.triangle][a.corner] = b.triangle;
      topology.neighbours[b.triangle][b.corner] = a.triangle;
      opposed[a.triangle][a.corner] = opposed[b.triangle][b.corner] = a.forward == b.forward;
    }
    i = end;
  }
  return opposed;
}

/// Turns each part to one side, the one that most of its triangles have.
void turnParts(const Opposed& opposed, MeshTopology& topology) {
  std::vector<char> seen(opposed.size(), 0);
  std::vector<int> part;
  for (std::size_t start = 0; start < opposed.size(); ++start) {
    if (seen[start] || !topology.alive[start]) continue;
    part.assign(1, static_cast<int>(start));
    seen[start] = 1;
    std::size_t turned = 0;
    for (std::size_t head = 0; head < part.size(); ++head) {
      const int t = part[head];
      turned += topology.turned[t];
      for (int k = 0; k < 3; ++k) {
        const int n = topology.neighbours[t][k];
        if (n < 0 || seen[n]) continue;
        seen[n] = 1;
        topology.turned[n] = topology.turned[t] ^ opposed[t][k];
        part.push_back(n);
      }
    }
    if (2 * turned > part.size())
      for (const int t : part) topology.turned[t] ^= 1;
  }
}

}  // namespace

MeshTopology topologyOf(const TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  const std::vector<int> welded = weld(mesh.vertices);
  MeshTopology topology;
  topology.alive.assign(count, 1);
  topology.turned.assign(count, 0);
  topology.neighbours.assign(count, Vector3i(-1, -1, -1));
  dropBadTriangles(mesh, welded, topology);
  turnParts(joinNeighbours(mesh, welded, topology), topology);
  return topology;
}

std::vector<Vector3d> vertexNormals(const TriangleMesh& mesh, const MeshTopology& topology) {
  std::vector<Vector3d> normals(mesh.vertices.size(), Vector3d::Zero());
  bool complete = !mesh.normals.empty();
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    if (mesh.normals[i].allFinite() && mesh.normals[i].norm() > 0)
      normals[i] = mesh.normals[i].normalized();
    else
      complete = false;
  }
  if (complete) return normals;

  const std::vector<int> welded = weld(mesh.vertices);
  std::vector<Vector3d> sums(mesh.vertices.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!topology.alive[i]) continue;
    const Vector3i& t = mesh.triangles[i];
    const Vector3d n = faceVector(mesh, t).normalized() * (topology.turned[i] ? -1 : 1);
    for (int k = 0; k < 3; ++k)
      sums[welded[t[k]]] += n * cornerAngle(mesh.vertices[t[k]], mesh.vertices[t[(k + 1) % 3]], mesh.vertices[t[(k + 2) % 3]]);
  }
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (normals[i].isZero() && sums[welded[i]].norm() > 0) normals[i] = sums[welded[i]].normalized();
  return normals;
}

std::optional<double> outwardDeviation(const TriangleMesh& mesh, const MeshTopology& topology,
                                       const std::vector<Vector3d>& normals) {
  const int count = static_cast<int>(mesh.triangles.size());
  std::vector<char> seen(count, 0);
  std::vector<int> part;
  double deviation = 0;
  for (int start = 0; start < count; ++start) {
    if (seen[start] || !topology.alive[start]) continue;
    part.assign(1, start);
    seen[start] = 1;
    const Vector3d& origin = mesh.vertices[mesh.triangles[start].x()];
    const auto area = [&](int t) -> Vector3d { return (topology.turned[t] ? -1 : 1) * faceVector(mesh, mesh.triangles[t]); };
    Vector3d sum(0, 0, 0);
    double total = 0, volume = 0, extent = 0;
    for (std::size_t head = 0; head < part.size(); ++head) {
      const int t = part[head];
      const Vector3d a = area(t), from = mesh.vertices[mesh.triangles[t].x()] - origin;
      sum += a;
      total += a.norm();
      volume += a.dot(from);
      extent = std::max(extent, from.norm());
      for (int k = 0; k < 3; ++k) {
        const int n = topology.neighbours[t][k];
        if (n < 0) return std::nullopt;
        if (!seen[n]) seen[n] = 1, part.push_back(n);
      }
    }
    // The areas of a closed, oriented part cancel. Without an orientation, or with hardly a volume, nothing says what is outward.
    constexpr double kClosed = 1e-6, kFlat = 1e-6;  // shares of the area, and of area times extent
    if (!(sum.norm() <= kClosed * total) || !(std::abs(volume) > kFlat * total * extent)) return std::nullopt;
    for (const int t : part) {
      const Vector3d out = volume > 0 ? area(t) : Vector3d(-area(t));
      for (int k = 0; k < 3; ++k) {
        const Vector3d& n = normals[mesh.triangles[t][k]];
        deviation = std::max(deviation, std::atan2(out.cross(n).norm(), out.dot(n)));
      }
    }
  }
  return deviation;
}

}  // namespace glint

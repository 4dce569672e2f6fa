// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/smooth_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <unordered_map>

#include "core/base/numeric.h"
#include "core/base/progress.h"
#include "core/geometry/plane.h"
#include "core/surface/height_quadric.h"

namespace glint {
namespace {
using Eigen::Vector3d;

constexpr int kCellsPerRadius = 10;   // a mean of vertices lies off the surface by less than 1 % of what the radius bends away
constexpr int kFewestCells = 12;      // twice the unknowns of a quadric
constexpr double kSteadySlope = 4;    // leverage: a dozen neighbours all around have 0.5 to 1
constexpr double kOwnSide = 1.0 / 3;  // of the radius: vertices so near tell which side of a thin sheet a vertex is on
constexpr int kVertexChunk = 256;     // vertices of one piece of parallel work
constexpr double kSigmaOverMedian = 1.4826;  // standard deviation of a normal distribution over its median absolute deviation

/// Vertices of a small cube, as one.
struct Cell {
  Vector3d mean = Vector3d::Zero(), area = Vector3d::Zero();
  double count = 0;
};

/// Cells, and where those of a large cube are.
class Cells {
 public:
  Cells(const TriangleMesh& mesh, const std::vector<Vector3d>& areas, const Vector3d& corner, double radius)
      : corner_(corner), radius_(radius) {
    std::vector<std::tuple<std::uint64_t, std::uint64_t, int>> order;  // large cube, small cube, vertex
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      if (!areas[i].isZero())
        order.emplace_back(keyOf(mesh.vertices[i], radius), keyOf(mesh.vertices[i], radius / kCellsPerRadius), int(i));
    std::sort(order.begin(), order.end());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto& [large, small, v] = order[i];
      const bool newLarge = i == 0 || large != std::get<0>(order[i - 1]);
      if (newLarge) first_[large] = cells_.size();
      if (newLarge || small != std::get<1>(order[i - 1])) cells_.emplace_back(), large_.push_back(large);
      cells_.back().mean += mesh.vertices[std::size_t(v)];
      cells_.back().area += areas[std::size_t(v)];
      ++cells_.back().count;
    }
    for (Cell& c : cells_) c.mean /= c.count;
  }

  /// Those nearer than the radius.
  void near(const Vector3d& p, std::vector<const Cell*>& found) const {
    found.clear();
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const std::uint64_t key = keyOf(p + radius_ * Vector3d(x, y, z), radius_);
          const auto start = first_.find(key);
          if (start == first_.end()) continue;
          for (std::size_t i = start->second; i < cells_.size() && large_[i] == key; ++i)
            if ((cells_[i].mean - p).squaredNorm() < radius_ * radius_) found.push_back(&cells_[i]);
        }
  }

 private:
  /// 21 bits for each axis. Cubes outside of the mesh's box share keys with others; they are empty or too far away.
  std::uint64_t keyOf(const Vector3d& p, double side) const {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k)
      key = key << 21 |
            (static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor((p[k] - corner_[k]) / side)) + 2) & 0x1fffff);
    return key;
  }

  Vector3d corner_;
  double radius_;
  std::vector<Cell> cells_;
  std::vector<std::uint64_t> large_;
  std::unordered_map<std::uint64_t, std::size_t> first_;
};

/// What becomes of one vertex.
struct Moved {
  bool fitted = false;
  Vector3d place, normal;
  double off = 0, leverage = 0;
};

/// The mean normal of the cells on the same side as those next to p, zero where they cancel.
Vector3d meanNormal(const Vector3d& p, const Vector3d& own, const std::vector<const Cell*>& near, double radius) {
  Vector3d side = own, sum = Vector3d::Zero();
  for (const Cell* c : near)
    if ((c->mean - p).norm() < kOwnSide * radius) side += c->area;
  for (const Cell* c : near)
    if (c->area.dot(side) > 0) sum += (1 - (c->mean - p).squaredNorm() / (radius * radius)) * c->area;
  return sum.normalized();
}

Moved moved(const Vector3d& p, const Vector3d& own, const std::vector<const Cell*>& near, double radius) {
  Moved m;
  if (near.size() < kFewestCells) return m;
  const Vector3d normal = meanNormal(p, own, near, radius);
  if (!(normal.norm() > 0.5)) return m;  // unit, or zero
  Eigen::Matrix3d frame;
  frame << normal, tangentBasis(normal);
  HeightQuadric quadric(frame, radius);
  int count = 0;
  for (const Cell* c : near) {
    if (!(c->area.dot(normal) > 0)) continue;
    const Vector3d d = c->mean - p;
    const double q = 1 - d.squaredNorm() / (radius * radius);
    quadric.add(d, q * q, c->count);
    ++count;
  }
  if (count < kFewestCells) return m;
  const std::optional<HeightQuadric::Fitted> fitted = quadric.solve();
  if (!fitted || !(fitted->leverage < kSteadySlope)) return m;
  m.place = p + fitted->height * normal;
  m.normal = fitted->normal;
  m.off = std::abs(fitted->height) / std::sqrt(std::max(1 - fitted->leverageOfOrigin, 0.1));
  m.leverage = fitted->leverage;
  m.fitted = m.place.allFinite() && m.normal.allFinite();
  return m;
}

}  // namespace

MeshSmoother::MeshSmoother(TriangleMesh mesh) : mesh_(std::move(mesh)), areas_(mesh_.vertices.size(), Vector3d::Zero()) {
  std::vector<double> edges;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3i& t : mesh_.triangles) {
    const auto at = [&](int k) -> const Vector3d& { return mesh_.vertices[std::size_t(t[k % 3])]; };
    const Vector3d area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0));
    for (int k = 0; k < 3; ++k) {
      areas_[std::size_t(t[k])] += area;
      edges.push_back((at(k + 1) - at(k)).norm());
      box.extend(at(k));
    }
  }
  if (edges.empty()) return;
  spacing_ = upperMedian(std::move(edges));
  corner_ = box.min();
  size_ = box.diagonal().norm();
}

SmoothMesh MeshSmoother::at(double radius) const {
  require(radius > 0, "MeshSmoother: the radius must be positive");
  SmoothMesh smooth{mesh_, 0, 0};
  TriangleMesh& out = smooth.mesh;
  const int n = static_cast<int>(out.vertices.size());
  const bool given = out.normals.size() == out.vertices.size();
  if (!given) {
    out.normals.clear();
    for (const Vector3d& area : areas_) out.normals.push_back(area.normalized());
  }
  const Cells cells(mesh_, areas_, corner_, radius);
  std::vector<Moved> all(out.vertices.size());
  parallelFor((n + kVertexChunk - 1) / kVertexChunk,
              [&](int piece) {
                std::vector<const Cell*> near;
                for (int i = piece * kVertexChunk; i < std::min(n, (piece + 1) * kVertexChunk); ++i) {
                  const auto v = static_cast<std::size_t>(i);
                  if (areas_[v].isZero()) continue;  // a vertex of no triangle
                  cells.near(mesh_.vertices[v], near);
                  all[v] = moved(mesh_.vertices[v], areas_[v], near, radius);
                }
              },
              {}, "smooth mesh");
  // Given normals may point to the other side than the triangles' winding does.
  std::ptrdiff_t agree = 0;
  for (std::size_t v = 0; v < all.size(); ++v)
    if (all[v].fitted && given) agree += all[v].normal.dot(out.normals[v]) < 0 ? -1 : 1;
  std::vector<double> off, leverages;
  for (std::size_t v = 0; v < all.size(); ++v) {
    if (!all[v].fitted) continue;
    out.vertices[v] = all[v].place;
    out.normals[v] = agree < 0 ? Vector3d(-all[v].normal) : all[v].normal;
    off.push_back(all[v].off);
    leverages.push_back(all[v].leverage);
  }
  if (off.empty()) return smooth;
  smooth.noise = kSigmaOverMedian * upperMedian(std::move(off));
  smooth.normalNoise = smooth.noise * std::sqrt(upperMedian(std::move(leverages))) / radius;
  return smooth;
}

}  // namespace glint

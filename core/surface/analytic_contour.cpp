// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/surface/analytic_shape.h"

namespace glint {
namespace {

/// An edge of a cell: its lower corner, and its axis times 8. Corners are numbered by bits, x the lowest.
using CellEdge = unsigned char;

/// The triangles of a cell, by the edges on which their vertices lie.
using CellTriangles = std::vector<std::array<CellEdge, 3>>;

/// The triangles of a cell whose corners of the set bits are inside. Without a table of cases: the polygons are traced round the
/// cell's faces. On each face the inside is walked round as in two dimensions (iso_contour.cpp), so that two cells agree about
/// the face between them.
CellTriangles trianglesOf(unsigned inside) {
  constexpr CellEdge kNone = 0xff;
  const auto in = [&](unsigned corner) { return (inside >> corner & 1) != 0; };
  const auto edge = [](unsigned a, unsigned b) { return static_cast<CellEdge>((a ^ b) / 2 * 8 + std::min(a, b)); };
  std::array<CellEdge, 24> next;  // where the polygon goes on from the vertex on this edge
  next.fill(kNone);
  for (unsigned axis = 0; axis < 3; ++axis)
    for (unsigned side = 0; side < 2; ++side) {
      const unsigned u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3, base = side << axis;
      // Anticlockwise as seen from outside the cell.
      const std::array<unsigned, 4> face{base, base | (side ? u : v), base | u | v, base | (side ? v : u)};
      for (unsigned leave = 0; leave < 4; ++leave) {
        if (!in(face[leave]) || in(face[(leave + 1) % 4])) continue;
        unsigned enter = (leave + 3) % 4;
        while (in(face[enter])) enter = (enter + 3) % 4;
        next[edge(face[leave], face[(leave + 1) % 4])] = edge(face[enter], face[(enter + 1) % 4]);
      }
    }
  CellTriangles triangles;
  for (CellEdge first = 0; first < next.size(); ++first) {
    if (next[first] == kNone) continue;
    CellEdge second = std::exchange(next[first], kNone);
    while (next[second] != kNone) {
      const CellEdge third = std::exchange(next[second], kNone);
      if (third != first) triangles.push_back({first, third, second});
      second = third;
    }
  }
  return triangles;
}

/// Marching cubes on a grid over a box.
/// @see Lorensen and Cline, Marching cubes, SIGGRAPH 1987.
class MarchingCubes {
 public:
  MarchingCubes(const AnalyticShape& shape, const Eigen::AlignedBox3d& box, int resolution)
      : n_(static_cast<std::size_t>(resolution) + 1), stride_{1, n_, n_ * n_}, from_(box.min()), step_(box.sizes() / resolution) {
    values_.reserve(n_ * n_ * n_);
    for (std::size_t k = 0; k < n_; ++k)
      for (std::size_t j = 0; j < n_; ++j)
        for (std::size_t i = 0; i < n_; ++i) values_.push_back(shape.value(at(Eigen::Vector3d(double(i), double(j), double(k)))));
    inside_.reserve(values_.size());
    for (const double v : values_) inside_.push_back(v >= 0);
    for (unsigned c = 0; c < cases_.size(); ++c) cases_[c] = trianglesOf(c);
    placeVertices();
    for (std::size_t k = 0; k + 1 < n_; ++k)
      for (std::size_t j = 0; j + 1 < n_; ++j)
        for (std::size_t i = 0; i + 1 < n_; ++i) addTriangles(i + j * stride_[1] + k * stride_[2]);
  }

  TriangleMesh mesh() && { return std::move(mesh_); }

 private:
  Eigen::Vector3d at(const Eigen::Vector3d& node) const { return from_ + step_.cwiseProduct(node); }

  /// A vertex on every edge of the grid that crosses the surface, row by row.
  void placeVertices() {
    vertexOf_.assign(values_.size(), {-1, -1, -1});
    for (std::size_t k = 0; k < n_; ++k)
      for (std::size_t j = 0; j < n_; ++j)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          if ((axis == 1 && j + 1 == n_) || (axis == 2 && k + 1 == n_)) continue;
          const std::size_t row = j * stride_[1] + k * stride_[2], step = stride_[axis];
          for (std::size_t i = 0; i < (axis == 0 ? n_ - 1 : n_); ++i) {
            const std::size_t a = row + i, b = a + step;
            if (inside_[a] == inside_[b]) continue;
            Eigen::Vector3d p = {double(i), double(j), double(k)};
            p[static_cast<Eigen::Index>(axis)] += values_[a] / (values_[a] - values_[b]);
            vertexOf_[a][axis] = static_cast<int>(mesh_.vertices.size());
            mesh_.vertices.push_back(at(p));
          }
        }
  }

  void addTriangles(std::size_t cell) {
    const auto corner = [&](unsigned c) {
      return cell + (c & 1) * stride_[0] + (c >> 1 & 1) * stride_[1] + (c >> 2 & 1) * stride_[2];
    };
    unsigned inside = 0;
    for (unsigned c = 0; c < 8; ++c) inside |= unsigned(inside_[corner(c)]) << c;
    const auto vertex = [&](CellEdge e) { return vertexOf_[corner(e % 8)][e / 8]; };
    for (const auto& [a, b, c] : cases_[inside]) mesh_.triangles.emplace_back(vertex(a), vertex(b), vertex(c));
  }

  std::size_t n_;  ///< nodes of the grid along each axis
  std::array<std::size_t, 3> stride_;
  Eigen::Vector3d from_, step_;
  std::vector<double> values_;
  std::vector<char> inside_;
  std::array<CellTriangles, 256> cases_;      ///< by the corners that are inside
  std::vector<std::array<int, 3>> vertexOf_;  ///< on the edges from a node along x, y and z; -1: none
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh contourShape(const AnalyticShape& shape, const Eigen::AlignedBox3d& box, int resolution) {
  TriangleMesh mesh = MarchingCubes(shape, box, resolution).mesh();
  for (Eigen::Vector3d& p : mesh.vertices)
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3d g = shape.gradient(p);
      if (!(g.squaredNorm() > 0)) break;
      p -= shape.value(p) / g.squaredNorm() * g;
    }
  return mesh;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to io: what the readers of all formats share.

#include <functional>
#include <string>

#include "io/cloud_reader.h"
#include "io/mesh_content.h"

namespace glint::io {

/// @throw InputError always.
[[noreturn]] void fail(const std::string& file, const std::string& place, const std::string& reason);

/// "line 3" and "byte 80".
std::string lineNo(std::size_t line);
std::string byteNo(std::size_t byte);

/// Why a coordinate is refused, or nullptr. Beyond 1e30 squares of lengths leave the range of doubles in later sums.
const char* badCoordinate(const Eigen::Vector3d& v);

/// Collects the corners of one polygon after the other and appends fans of triangles. Vertices may come later in the file, so
/// `cut` makes other triangles of the polygons that are not convex when all are there.
class Fan {
 public:
  explicit Fan(std::vector<Eigen::Vector3i>& triangles) : triangles_(triangles) {}
  void begin() {
    corners_ = 0;
    start_ = triangles_.size();
  }
  void add(int vertex) {
    if (corners_ == 0)
      first_ = vertex;
    else if (corners_ >= 2)
      triangles_.emplace_back(first_, last_, vertex);
    last_ = vertex;
    ++corners_;
  }
  void end() {
    if (corners_ > 3) polygons_.push_back({start_, corners_ - 2});
  }
  std::size_t corners() const { return corners_; }

  /// Cuts each polygon whose fan leaves it along diagonals inside of it; the others keep their fan. Each keeps its place and its
  /// number of triangles. Corners of crossing outlines are used, too, each once.
  /// @param beside  other numbers of the corners in the same order, such as those of their normals; may be empty
  /// @throw InputError  concave polygons so large that the cut would take minutes
  void cut(const std::vector<Eigen::Vector3d>& vertices, std::vector<Eigen::Vector3i>& beside, const std::string& file) const;

 private:
  struct Polygon {
    std::size_t first, triangles;
  };
  std::vector<Eigen::Vector3i>& triangles_;
  std::vector<Polygon> polygons_;  ///< of more than three corners
  std::size_t corners_ = 0, start_ = 0;
  int first_ = 0, last_ = 0;
};

/// Unusable coordinates with their places: a fault only if a triangle uses them. Programs write NaN for what a sensor missed.
class BadVertices {
 public:
  void note(std::size_t vertex, std::size_t place) { found_.push_back({vertex, place}); }
  std::size_t count() const { return found_.size(); }
  /// Takes them out of the mesh, with their normals. @param placeOf  words for a vertex and its place
  /// @throw InputError  a triangle uses one
  void remove(MeshContent& mesh, const std::string& file,
              const std::function<std::string(std::size_t, std::size_t)>& placeOf) const;

 private:
  struct Bad {
    std::size_t vertex, place;
  };
  std::vector<Bad> found_;  ///< by rising vertex
};

/// Refuses a mesh without triangles, and brings normals to length 1. A normal that has no direction becomes zero. If no vertex of
/// a triangle has a normal, the mesh gets no normals.
MeshContent finished(MeshContent mesh, const std::string& file);

/// Refuses a cloud without points, brings normals to length 1, and drops them when a point has none.
CloudContent finished(CloudContent cloud, const std::string& file);

}  // namespace glint::io

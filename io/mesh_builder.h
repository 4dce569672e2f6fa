// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to io: what the readers of all formats share.

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

/// Collects the corners of one polygon after the other and appends fans of triangles.
class Fan {
 public:
  explicit Fan(std::vector<Eigen::Vector3i>& triangles) : triangles_(triangles) {}
  void begin() { corners_ = 0; }
  void add(int vertex) {
    if (corners_ == 0)
      first_ = vertex;
    else if (corners_ >= 2)
      triangles_.emplace_back(first_, last_, vertex);
    last_ = vertex;
    ++corners_;
  }
  std::size_t corners() const { return corners_; }

 private:
  std::vector<Eigen::Vector3i>& triangles_;
  std::size_t corners_ = 0;
  int first_ = 0, last_ = 0;
};

/// Refuses a mesh without triangles, brings normals to length 1, and drops them when a triangle's vertex has none.
/// (Vertices of no triangle may lack one: mesh editors write NaN there.)
MeshContent finished(MeshContent mesh, const std::string& file);

/// Refuses a cloud without points, brings normals to length 1, and drops them when a point has none.
CloudContent finished(CloudContent cloud, const std::string& file);

}  // namespace glint::io

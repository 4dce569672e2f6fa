// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/outcome.h"
#include "io/binary.h"
#include "io/mesh_builder.h"
#include "io/mesh_reader.h"
#include "io/stl_layout.h"
#include "io/text_scan.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Numbers of vertices, the same for the same coordinates, in the order of their first appearance.
class Welder {
 public:
  explicit Welder(std::vector<Vector3d>& vertices) : vertices_(vertices), slots_(1024, kEmpty) {}

  /// -1 if there are more vertices than an int counts.
  int numberOf(Vector3d v) {
    v += Vector3d::Zero();  // -0 becomes 0, which it equals
    if (2 * (vertices_.size() + 1) > slots_.size()) grow();
    std::uint32_t& slot = find(v);
    if (slot == kEmpty) {
      if (vertices_.size() >= std::size_t(std::numeric_limits<int>::max())) return -1;
      slot = static_cast<std::uint32_t>(vertices_.size());
      vertices_.push_back(v);
    }
    return static_cast<int>(slot);
  }

 private:
  static constexpr std::uint32_t kEmpty = ~std::uint32_t(0);

  std::uint32_t& find(const Vector3d& v) {
    std::uint64_t h = seed_;
    for (int k = 0; k < 3; ++k) {  // the finaliser of splitmix64, a full mix for each coordinate
      h += std::bit_cast<std::uint64_t>(v[k]) + 0x9e3779b97f4a7c15u;
      h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
      h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
      h ^= h >> 31;
    }
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = h & mask;
    while (slots_[at] != kEmpty && vertices_[slots_[at]] != v) at = (at + 1) & mask;
    return slots_[at];
  }
  void grow() {
    slots_.assign(2 * slots_.size(), kEmpty);
    for (std::size_t i = 0; i < vertices_.size(); ++i) find(vertices_[i]) = static_cast<std::uint32_t>(i);
  }

  std::vector<Vector3d>& vertices_;
  std::vector<std::uint32_t> slots_;
  // Another one in every run, so that no file can be made whose vertices all fall into one place of the table. The numbers do not
  // depend on it.
  std::uint64_t seed_ = static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
};

/// Leaves a facet out, and counts it, if a corner of it has no place. @param bad  takes the first such facet, for a file without
/// others
void addFacet(MeshContent& mesh, Welder& welder, const Vector3d (&corners)[3], const std::string& file, const std::string& place,
              std::optional<InputError>& bad) {
  for (const Vector3d& corner : corners)
    if (const char* reason = io::badCoordinate(corner)) {
      if (!bad) bad.emplace(file, place, std::string("a vertex ") + reason);
      ++mesh.leftOut;
      return;
    }
  int number[3];
  for (int k = 0; k < 3; ++k) {
    number[k] = welder.numberOf(corners[k]);
    if (number[k] < 0) io::fail(file, place, "more than 2147483647 vertices");
  }
  mesh.triangles.emplace_back(number[0], number[1], number[2]);
}

MeshContent finishedStl(MeshContent mesh, const std::string& file, const std::optional<InputError>& bad) {
  if (mesh.triangles.empty() && bad) throw InputError(*bad);
  return io::finished(std::move(mesh), file);
}

bool sameWord(std::string_view word, std::string_view lower) {
  return std::equal(word.begin(), word.end(), lower.begin(), lower.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? char(a + ('a' - 'A')) : a) == b; });
}

}  // namespace

bool io::beginsAsStlText(std::string_view bytes) {
  bytes = withoutMark(bytes);
  bytes.remove_prefix(std::min(bytes.find_first_not_of(" \t\r\n\v\f"), bytes.size()));
  constexpr std::string_view kFirst = "solid";
  return sameWord(bytes.substr(0, kFirst.size()), kFirst);
}

MeshContent parseStlBinary(std::string_view bytes, const std::string& file) {
  const std::size_t promised = io::stlBytesPromised(bytes);
  if (promised == 0)
    io::fail(file, io::byteNo(bytes.size()),
             "the STL is truncated: " + std::to_string(io::kStlHead) + " bytes come before the first facet");
  if (promised > bytes.size())
    io::fail(
        file, io::byteNo(bytes.size()) + ", facet " + std::to_string((bytes.size() - io::kStlHead) / io::kStlFacet),
        "the STL is truncated: its header declares " + std::to_string((promised - io::kStlHead) / io::kStlFacet) + " facets");
  for (std::size_t i = promised; i < bytes.size(); ++i)
    if (!io::isPadding(bytes[i]))
      io::fail(file, io::byteNo(i),
               "unexpected data after the " + std::to_string((promised - io::kStlHead) / io::kStlFacet) +
                   " facets that the header declares");
  MeshContent mesh;
  Welder welder(mesh.vertices);
  std::optional<InputError> bad;
  mesh.triangles.reserve((promised - io::kStlHead) / io::kStlFacet);
  for (std::size_t at = io::kStlHead; at < promised; at += io::kStlFacet) {
    Vector3d corners[3];
    for (int k = 0; k < 9; ++k)
      corners[k / 3][k % 3] = io::valueAt<float>(bytes.data() + at + io::kStlNormal + sizeof(float) * std::size_t(k), false);
    addFacet(mesh, welder, corners, file, io::byteNo(at) + ", facet " + std::to_string((at - io::kStlHead) / io::kStlFacet), bad);
  }
  return finishedStl(std::move(mesh), file, bad);
}

MeshContent parseStlText(std::string_view bytes, const std::string& file) {
  MeshContent mesh;
  Welder welder(mesh.vertices);
  io::Lines lines(bytes);
  // Statements as they may follow each other; each begins a line.
  enum class Inside { Nothing, Solid, Facet, Loop, LoopDone } inside = Inside::Nothing;
  Vector3d corners[3];
  std::optional<InputError> badFacet;
  int corner = 0;
  while (std::optional<std::string_view> line = lines.next()) {
    const std::string_view word = io::takeWord(*line);
    if (word.empty()) continue;
    const auto bad = [&](const std::string& reason) { io::fail(file, io::lineNo(lines.number()), reason); };
    const auto unexpected = [&](const char* expected) {
      bad("the STL has " + io::quoted(word) + " where " + expected + " is expected");
    };
    switch (inside) {
      case Inside::Nothing:
        if (!sameWord(word, "solid")) unexpected("solid");
        inside = Inside::Solid;
        break;
      case Inside::Solid:
        if (sameWord(word, "endsolid"))
          inside = Inside::Nothing;
        else if (sameWord(word, "facet"))
          inside = Inside::Facet;
        else
          unexpected("facet or endsolid");
        break;
      case Inside::Facet:
        if (!sameWord(word, "outer") || !sameWord(io::takeWord(*line), "loop")) unexpected("outer loop");
        inside = Inside::Loop;
        corner = 0;
        break;
      case Inside::Loop: {
        if (!sameWord(word, "vertex")) unexpected("vertex");
        for (int k = 0; k < 3; ++k) {
          const std::string_view text = io::takeWord(*line);
          const std::optional<double> value = io::numberOf(text);
          if (!value) bad(text.empty() ? "a vertex needs three numbers" : io::quoted(text) + " is not a number");
          corners[corner][k] = *value;
        }
        if (const std::string_view rest = io::takeWord(*line); !rest.empty())
          bad("unexpected " + io::quoted(rest) + " after a vertex");
        if (++corner < 3) break;
        inside = Inside::LoopDone;
        addFacet(mesh, welder, corners, file, io::lineNo(lines.number()), badFacet);
        break;
      }
      case Inside::LoopDone:
        if (sameWord(word, "endfacet")) {
          if (corner != 4) unexpected("endloop");
          inside = Inside::Solid;
        } else {
          if (!sameWord(word, "endloop") || corner != 3) unexpected(corner == 3 ? "endloop" : "endfacet");
          corner = 4;
        }
        break;
    }
  }
  if (inside != Inside::Nothing) io::fail(file, io::lineNo(lines.number()), "the STL is truncated: endsolid is missing");
  return finishedStl(std::move(mesh), file, badFacet);
}

}  // namespace glint

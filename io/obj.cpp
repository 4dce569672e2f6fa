// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <unordered_map>

#include "io/mesh_builder.h"
#include "io/mesh_reader.h"
#include "io/text_scan.h"

namespace glint {
namespace {

using Eigen::Vector3d;

class ObjReader {
 public:
  ObjReader(std::string_view bytes, const std::string& file) : file_(file), lines_(bytes), fan_(mesh_.triangles) {}

  MeshContent read() {
    while (std::optional<std::string_view> line = lines_.next()) statement(whole(*line));
    checkReferences();
    bad_.remove(mesh_, file_,
                [](std::size_t vertex, std::size_t line) { return io::lineNo(line) + ", vertex " + std::to_string(vertex); });
    fan_.cut(mesh_.vertices, cornerNormals_, file_);
    if (mesh_.triangles.empty()) io::fail(file_, "", "is not a mesh: neither PLY, STL nor glTF, and as OBJ it has no faces");
    takeNormals();
    return io::finished(std::move(mesh_), file_);
  }

 private:
  static constexpr int kNone = -1;

  /// What faces refer to, by kind. Faces may come before what they name, so the largest number is checked at the end.
  struct References {
    const char* kind;
    std::int64_t count = 0, largest = 0;
    std::size_t largestLine = 0;
  };

  [[noreturn]] void bad(const std::string& reason) const { io::fail(file_, io::lineNo(lines_.number()), reason); }

  /// A line with those that go on after a backslash.
  std::string_view whole(std::string_view line) {
    if (line.empty() || line.back() != '\\') return line;
    joined_.clear();
    while (!line.empty() && line.back() == '\\') {
      joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
      const std::optional<std::string_view> more = lines_.next();
      line = more ? *more : std::string_view();
    }
    joined_.append(line);
    return joined_;
  }

  void statement(std::string_view line) {
    const std::string_view word = io::takeWord(line);
    if (word != "v" && word != "vn" && word != "vt" && word != "f") return;
    for (std::size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1))
      if (at == 0 || line[at - 1] != '.') line = line.substr(0, at);  // "1.#QNAN" is a number
    if (word == "f") return face(line);
    constexpr std::int64_t kMost = std::numeric_limits<int>::max();
    if (word == "v") {
      if (++vertices_.count > kMost) bad("more than 2147483647 vertices");
      mesh_.vertices.push_back(three(line, "vertex"));
      if (io::badCoordinate(mesh_.vertices.back())) bad_.note(mesh_.vertices.size() - 1, lines_.number());
    } else if (word == "vn") {
      if (++normals_.count > kMost) bad("more than 2147483647 normals");
      normalValues_.push_back(three(line, "normal"));
    } else {
      ++textures_.count;
    }
  }

  /// The first three numbers; weights and colours may follow, which must be numbers too.
  Vector3d three(std::string_view line, const char* what) const {
    Vector3d v;
    for (int k = 0;; ++k) {
      const std::string_view word = io::takeWord(line);
      if (word.empty()) {
        if (k < 3) bad(std::string("a ") + what + " needs three numbers");
        return v;
      }
      const std::optional<double> value = io::numberOf(word);
      if (!value) bad(io::quoted(word) + " is not a number");
      if (k < 3) v[k] = *value;
    }
  }

  void face(std::string_view line) {
    fan_.begin();
    for (std::string_view word = io::takeWord(line); !word.empty(); word = io::takeWord(line)) corner(word);
    if (fan_.corners() < 3) bad("a face needs three vertices");
    fan_.end();
    // The fan has appended corners() - 2 triangles: their normals in the same order.
    for (std::size_t k = 2; k < fan_.corners(); ++k)
      cornerNormals_.emplace_back(faceNormals_[0], faceNormals_[k - 1], faceNormals_[k]);
    faceNormals_.clear();
  }

  /// v, v/vt, v//vn or v/vt/vn.
  void corner(std::string_view word) {
    std::string_view rest = word;
    const auto part = [&]() -> std::string_view {
      const std::size_t slash = rest.find('/');
      const std::string_view text = rest.substr(0, slash);
      rest = slash == std::string_view::npos ? std::string_view() : rest.substr(slash + 1);
      return text;
    };
    const std::string_view vertex = part(), texture = part(), normal = part();
    const int v = refer(vertices_, vertex, word);
    if (!texture.empty()) refer(textures_, texture, word);
    const int n = normal.empty() ? kNone : refer(normals_, normal, word);
    if (!rest.empty()) bad(io::quoted(word) + " is not a vertex number");
    fan_.add(v);
    faceNormals_.push_back(n);
  }

  /// Index from 0. A number that does not exist yet is checked at the end.
  int refer(References& to, std::string_view text, std::string_view word) const {
    const std::optional<std::int64_t> number = io::integerOf(text);
    if (!number) bad(io::quoted(word) + " is not a vertex number");
    const std::int64_t index = *number > 0 ? *number : to.count + 1 + *number;
    if (*number == 0 || index < 1 || index > std::numeric_limits<int>::max())
      bad(std::string("a face names ") + to.kind + " " + std::to_string(*number) + ", which does not exist");
    if (index > to.largest) {
      to.largest = index;
      to.largestLine = lines_.number();
    }
    return static_cast<int>(index - 1);
  }

  void checkReferences() const {
    for (const References* r : {&vertices_, &textures_, &normals_})
      if (r->largest > r->count)
        io::fail(file_, io::lineNo(r->largestLine),
                 std::string("a face names ") + r->kind + " " + std::to_string(r->largest) + "; the file has " +
                     std::to_string(r->count));
  }

  /// One normal per vertex. A vertex that meets a second, different normal (a crease) is doubled. A corner without a normal has
  /// that of its vertex elsewhere, or none.
  void takeNormals() {
    if (normals_.largest == 0) return;
    mesh_.normals.assign(mesh_.vertices.size(), Vector3d::Zero());
    std::vector<int> first(mesh_.vertices.size(), kNone);
    std::unordered_map<std::uint64_t, int> doubled;  // by vertex and normal
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        int& vertex = mesh_.triangles[i][k];
        const int n = cornerNormals_[i][k];
        if (n == kNone) continue;
        const Vector3d& value = normalValues_[std::size_t(n)];
        int& own = first[std::size_t(vertex)];
        if (own == kNone) {
          own = n;
          mesh_.normals[std::size_t(vertex)] = value;
        } else if (own != n && normalValues_[std::size_t(own)] != value) {
          const std::uint64_t key = std::uint64_t(vertex) << 32 | std::uint64_t(n);
          const auto [it, isNew] = doubled.emplace(key, static_cast<int>(mesh_.vertices.size()));
          if (isNew) {
            if (mesh_.vertices.size() >= std::size_t(std::numeric_limits<int>::max()))
              io::fail(file_, "", "more than 2147483647 vertices");
            mesh_.vertices.push_back(Vector3d(mesh_.vertices[std::size_t(vertex)]));
            mesh_.normals.push_back(value);
          }
          vertex = it->second;
        }
      }
  }

  const std::string& file_;
  io::Lines lines_;
  std::string joined_;
  MeshContent mesh_;
  io::Fan fan_;
  io::BadVertices bad_;
  std::vector<Vector3d> normalValues_;
  std::vector<int> faceNormals_;                ///< of the corners of the face at hand
  std::vector<Eigen::Vector3i> cornerNormals_;  ///< beside mesh_.triangles
  References vertices_{"vertex"}, textures_{"texture coordinate"}, normals_{"normal"};
};

}  // namespace

MeshContent parseObj(std::string_view bytes, const std::string& file) { return ObjReader(bytes, file).read(); }

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/outcome.h"
#include "io/gltf_data.h"
#include "io/mesh_builder.h"
#include "io/mesh_reader.h"
#include "io/text_scan.h"

namespace glint {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using io::GltfAccessor;
using io::GltfData;

enum class GltfMode { Triangles = 4, Strip = 5, Fan = 6 };

/// A primitive of a mesh that is made of triangles.
struct GltfPart {
  std::string place;
  GltfMode mode = GltfMode::Triangles;
  GltfAccessor positions;
  std::optional<GltfAccessor> normals, indices;

  std::size_t corners() const { return indices ? indices->count : positions.count; }
  std::size_t triangles() const { return mode == GltfMode::Triangles ? corners() / 3 : corners() - 2; }
};

/// A mesh at its place in the scene.
struct GltfInstance {
  Matrix4d worldFromMesh = Matrix4d::Identity();
  std::size_t mesh = 0;
  std::string place;  ///< of the node
};

// ---- Document

/// Extensions that a file may require although we do not know them: they are about looks, light and motion, not about the shape.
bool leavesTheShape(const std::string& extension) {
  constexpr std::string_view kHarmless[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_",
                                            "KHR_lights_",    "EXT_lights_",  "KHR_xmp",      "KHR_animation_"};
  return extension == "KHR_mesh_quantization" ||
         std::any_of(std::begin(kHarmless), std::end(kHarmless),
                     [&](std::string_view start) { return extension.starts_with(start); });
}

void checkHeader(const JsonNode& root) {
  const JsonNode version = root.at("asset").at("version");
  if (!version.text().starts_with("2.")) version.fail("glTF version " + io::quoted(version.text()) + "; only 2 is supported");
  const std::optional<JsonNode> required = root.find("extensionsRequired");
  for (std::size_t i = 0; required && i < required->size(); ++i) {
    const std::string name = required->at(i).text();
    if (!leavesTheShape(name))
      required->at(i).fail("the file needs the extension " + io::quoted(name) + ", which is not supported");
  }
}

std::vector<JsonNode> childrenOf(const JsonNode& node, const char* key) {
  std::vector<JsonNode> all;
  if (const std::optional<JsonNode> list = node.find(key))
    for (std::size_t i = 0; i < list->size(); ++i) all.push_back(list->at(i));
  return all;
}

// ---- Nodes

/// An array of exactly N numbers.
template <int N>
Eigen::Matrix<double, N, 1> gltfNumbers(const JsonNode& node) {
  const std::vector<double> values = node.numbers();
  if (values.size() != N) node.fail("must have " + std::to_string(N) + " numbers, has " + std::to_string(values.size()));
  return Eigen::Map<const Eigen::Matrix<double, N, 1>>(values.data());
}

/// A node in its parent: its matrix, column by column, or translation * rotation * scale.
Matrix4d parentFromNode(const JsonNode& node) {
  const std::optional<JsonNode> translation = node.find("translation"), rotation = node.find("rotation"),
                                scale = node.find("scale");
  if (const std::optional<JsonNode> matrix = node.find("matrix")) {
    if (translation || rotation || scale) matrix->fail("is beside a translation, rotation or scale: which one counts?");
    const Matrix4d m = gltfNumbers<16>(*matrix).reshaped(4, 4);
    constexpr double kRounding = 1e-6;  // of single precision
    if ((m.row(3).transpose() - Eigen::Vector4d::UnitW()).cwiseAbs().maxCoeff() > kRounding)
      matrix->fail("its last row (numbers 4, 8, 12 and 16) must be 0, 0, 0, 1");
    return m;
  }
  Matrix4d m = Matrix4d::Identity();
  if (rotation) {
    const Eigen::Vector4d xyzw = gltfNumbers<4>(*rotation);
    if (!(xyzw.stableNorm() > 0)) rotation->fail("is a quaternion of length 0");
    m.topLeftCorner<3, 3>() = Eigen::Quaterniond(xyzw.stableNormalized()).toRotationMatrix();
  }
  if (scale) m.topLeftCorner<3, 3>() *= gltfNumbers<3>(*scale).asDiagonal();
  if (translation) m.topRightCorner<3, 1>() = gltfNumbers<3>(*translation);
  return m;
}

/// Walks the nodes of a scene, without recursion, so that no depth of theirs ends the program.
class GltfWalk {
 public:
  explicit GltfWalk(const GltfData& data) : data_(data) {}

  std::vector<GltfInstance> instances() {
    const JsonNode& root = data_.root();
    const std::vector<JsonNode> scenes = childrenOf(root, "scenes");
    nodes_ = childrenOf(root, "nodes");
    visited_.assign(nodes_.size(), 0);
    const std::optional<JsonNode> chosen = root.find("scene");
    const std::size_t meshes = childrenOf(root, "meshes").size();
    if (chosen || !scenes.empty())
      for (const JsonNode& start : childrenOf(chosen ? data_.element("scenes", *chosen) : scenes[0], "nodes")) walk(start);
    else if (!nodes_.empty())
      everyNode();
    else
      for (std::size_t i = 0; i < meshes; ++i) found_.push_back({Matrix4d::Identity(), i, meshPlace(i)});
    return std::move(found_);
  }

 private:
  struct Step {
    std::size_t node;
    Matrix4d worldFromParent;
  };

  static std::string meshPlace(std::size_t mesh) { return "meshes[" + std::to_string(mesh) + "]"; }

  void everyNode() {
    std::vector<char> hasParent(nodes_.size(), 0);
    for (const JsonNode& node : nodes_)
      for (const JsonNode& child : childrenOf(node, "children")) hasParent[data_.numberIn("nodes", child)] = 1;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (!hasParent[i]) walk(i);
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (!visited_[i]) nodes_[i].fail("is its own ancestor, or lies below one that is");
  }

  void walk(const JsonNode& start) { walk(enter(start)); }
  void walk(std::size_t start) {
    visited_[start] = 1;
    std::vector<Step> steps{{start, Matrix4d::Identity()}};
    while (!steps.empty()) {
      const Step step = steps.back();
      steps.pop_back();
      const JsonNode& node = nodes_[step.node];
      const Matrix4d worldFromNode = step.worldFromParent * parentFromNode(node);
      if (!worldFromNode.allFinite()) node.fail("its place in the world is not finite");
      take(node, worldFromNode);
      const std::vector<JsonNode> children = childrenOf(node, "children");
      const std::size_t first = steps.size();
      for (const JsonNode& child : children) steps.push_back({enter(child), worldFromNode});
      std::reverse(steps.begin() + std::ptrdiff_t(first), steps.end());  // the first one next: the order of the file
    }
  }

  /// A node that none of those before has led to: nodes are trees, and every one is walked once.
  std::size_t enter(const JsonNode& index) {
    const std::size_t number = data_.numberIn("nodes", index);
    if (visited_[number])
      index.fail("names node " + std::to_string(number) + " a second time: it has another parent, or is its own ancestor");
    visited_[number] = 1;
    return number;
  }

  void take(const JsonNode& node, const Matrix4d& worldFromNode) {
    const std::optional<JsonNode> index = node.find("mesh");
    if (!index) return;
    if (const std::optional<JsonNode> skin = node.find("skin"))
      skin->fail("the joints of a skin give this mesh its shape; they are not supported");
    const JsonNode mesh = data_.element("meshes", *index);
    const std::optional<JsonNode> own = node.find("weights"), weights = own ? own : mesh.find("weights");
    for (std::size_t i = 0; weights && i < weights->size(); ++i)
      if (weights->at(i).number() != 0) weights->at(i).fail("a morph target gives this mesh its shape; they are not supported");
    found_.push_back({worldFromNode, data_.numberIn("meshes", *index), node.place()});
  }

  const GltfData& data_;
  std::vector<JsonNode> nodes_;
  std::vector<char> visited_;
  std::vector<GltfInstance> found_;
};

// ---- Meshes

/// Nothing for points, lines, and what has no positions.
std::optional<GltfPart> partOf(GltfData& data, const JsonNode& primitive) {
  const std::optional<JsonNode> mode = primitive.find("mode");
  const std::size_t number = mode ? io::gltfWhole(*mode) : std::size_t(GltfMode::Triangles);
  if (number > std::size_t(GltfMode::Fan)) mode->fail(std::to_string(number) + " is not a mode of primitives");
  const JsonNode attributes = primitive.at("attributes");
  const std::optional<JsonNode> positions = attributes.find("POSITION"), normals = attributes.find("NORMAL");
  if (number < std::size_t(GltfMode::Triangles) || !positions) return std::nullopt;
  constexpr const char* kDraco = "KHR_draco_mesh_compression";
  const std::optional<JsonNode> extensions = primitive.find("extensions");
  if (extensions && extensions->has(kDraco) && !data.element("accessors", *positions).has("bufferView"))
    extensions->at(kDraco).fail("the file holds these positions with this extension alone, which is not supported");
  GltfPart part;
  part.place = primitive.place();
  part.mode = static_cast<GltfMode>(number);
  part.positions = data.vectors(*positions);
  if (normals) {
    part.normals = data.vectors(*normals);
    if (part.normals->count != part.positions.count)
      normals->fail("has " + std::to_string(part.normals->count) + " normals for " + std::to_string(part.positions.count) +
                    " positions");
  }
  const std::optional<JsonNode> indices = primitive.find("indices");
  if (indices) part.indices = data.indices(*indices);
  if (part.corners() < 3 || (part.mode == GltfMode::Triangles && part.corners() % 3 != 0))
    (indices ? *indices : *positions).fail(std::to_string(part.corners()) + " corners do not make whole triangles");
  return part;
}

/// Normals go by the inverse transpose, up to a positive factor, and so stay at right angles to the surface where a node
/// stretches it, shears it or mirrors it. As cofactors it exists for nodes without thickness, too.
struct GltfTurn {
  Matrix3d normals;
  bool mirrored = false;

  explicit GltfTurn(const Matrix4d& worldFromMesh) {
    Matrix3d m = worldFromMesh.topLeftCorner<3, 3>();
    if (const double largest = m.cwiseAbs().maxCoeff(); largest > 0) m /= largest;  // products stay in range
    mirrored = m.determinant() < 0;
    for (int k = 0; k < 3; ++k) normals.col(k) = m.col((k + 1) % 3).cross(m.col((k + 2) % 3));
    if (mirrored) normals = -normals;
  }
};

class GltfReader {
 public:
  GltfReader(std::string_view bytes, const std::filesystem::path& file) : file_(file.string()), data_(bytes, file) {}

  MeshContent read() {
    checkHeader(data_.root());
    instances_ = GltfWalk(data_).instances();
    for (const GltfInstance& instance : instances_) readParts(instance.mesh);
    reserve();
    for (const GltfInstance& instance : instances_) add(instance);
    bad_.remove(mesh_, file_, [this](std::size_t vertex, std::size_t array) {
      return arrays_[array].first + ", element " + std::to_string(vertex - arrays_[array].second);
    });
    return io::finished(std::move(mesh_), file_);
  }

 private:
  /// Positions and normals that a mesh uses together: primitives with the same ones share their vertices.
  using Vertices = std::pair<std::size_t, std::size_t>;
  static constexpr std::size_t kNone = ~std::size_t(0);

  Vertices verticesOf(const GltfPart& part) const { return {part.positions.number, part.normals ? part.normals->number : kNone}; }

  void readParts(std::size_t mesh) {
    const auto [parts, isNew] = parts_.try_emplace(mesh);
    if (!isNew) return;
    const JsonNode primitives = data_.root().at("meshes").at(mesh).at("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i)
      if (std::optional<GltfPart> part = partOf(data_, primitives.at(i))) {
        normals_ = normals_ || part->normals;
        parts->second.push_back(std::move(*part));
      }
  }

  /// Memory for all. A mesh may be at many nodes, so a small file could ask for any size: refused before it is taken.
  void reserve() {
    // Bytes of ours for each of the file: 12 are possible for one that nothing repeats (strips of one-byte indices).
    constexpr std::size_t kPerByte = 64, kAlways = 256'000'000;
    const std::size_t most = kAlways + kPerByte * data_.bytes();
    std::size_t vertices = 0, triangles = 0;
    for (const GltfInstance& instance : instances_) {
      std::map<Vertices, bool> known;
      for (const GltfPart& part : parts_.at(instance.mesh)) {
        if (known.try_emplace(verticesOf(part)).second) vertices += part.positions.count;
        triangles += part.triangles();
        if (std::max(vertices, triangles) > std::size_t(std::numeric_limits<int>::max()))
          io::fail(file_, instance.place, "more than 2147483647 vertices or triangles");
        if (vertices * sizeof(Vector3d) * (normals_ ? 2 : 1) + triangles * sizeof(Eigen::Vector3i) > most)
          io::fail(file_, instance.place,
                   "its nodes repeat the file's meshes too often: up to here " + std::to_string(vertices) + " vertices and " +
                       std::to_string(triangles) + " triangles of a file of " + std::to_string(data_.bytes()) + " bytes");
      }
    }
    mesh_.vertices.reserve(vertices);
    if (normals_) mesh_.normals.reserve(vertices);
    mesh_.triangles.reserve(triangles);
  }

  void add(const GltfInstance& instance) {
    const GltfTurn turn(instance.worldFromMesh);
    std::map<Vertices, std::size_t> known;
    for (const GltfPart& part : parts_.at(instance.mesh)) {
      const auto [first, isNew] = known.try_emplace(verticesOf(part), mesh_.vertices.size());
      if (isNew) {
        addPositions(part.positions, instance);
        if (part.normals) addNormals(*part.normals, turn.normals);
        if (normals_) mesh_.normals.resize(mesh_.vertices.size(), Vector3d::Zero());  // zero: this part has none
      }
      addTriangles(part, int(first->second), turn.mirrored);
    }
  }

  void addPositions(const GltfAccessor& positions, const GltfInstance& instance) {
    const std::size_t first = mesh_.vertices.size();
    arrays_.emplace_back(positions.place, first);
    data_.append(positions, mesh_.vertices);
    for (std::size_t i = first; i < mesh_.vertices.size(); ++i) {
      Vector3d& v = mesh_.vertices[i];
      if (io::badCoordinate(v)) {
        bad_.note(i, arrays_.size() - 1);
        continue;
      }
      v = instance.worldFromMesh.topLeftCorner<3, 3>() * v + instance.worldFromMesh.topRightCorner<3, 1>();
      if (const char* reason = io::badCoordinate(v))
        io::fail(file_, instance.place + ", " + elementOf(positions, i - first), std::string("in the world, it ") + reason);
    }
  }

  void addNormals(const GltfAccessor& normals, const Matrix3d& worldFromMesh) {
    const std::size_t first = mesh_.normals.size();
    data_.append(normals, mesh_.normals);
    constexpr double kUnset = 1e-6;  // as in io::finished: shorter ones stay as they are, for it to see
    for (std::size_t i = first; i < mesh_.normals.size(); ++i)
      if (Vector3d& n = mesh_.normals[i]; n.norm() > kUnset) n = (worldFromMesh * n).stableNormalized();
  }

  void addTriangles(const GltfPart& part, int first, bool mirrored) {
    const std::vector<std::uint32_t> indices = part.indices ? data_.values(*part.indices) : std::vector<std::uint32_t>();
    for (std::size_t i = 0; i < indices.size(); ++i)
      if (indices[i] >= part.positions.count)
        io::fail(
            file_, elementOf(*part.indices, i),
            "names vertex " + std::to_string(indices[i]) + "; " + part.place + " has " + std::to_string(part.positions.count));
    const auto corner = [&](std::size_t i) { return first + int(part.indices ? indices[i] : i); };
    for (std::size_t i = 0; i < part.triangles(); ++i) {
      Eigen::Vector3i t;
      switch (part.mode) {
        case GltfMode::Triangles: t = {corner(3 * i), corner(3 * i + 1), corner(3 * i + 2)}; break;
        case GltfMode::Strip: t = {corner(i), corner(i + 1 + i % 2), corner(i + 2 - i % 2)}; break;  // every other one is turned
        case GltfMode::Fan: t = {corner(0), corner(i + 1), corner(i + 2)}; break;
      }
      // Strips have these where one part of them ends and the next begins.
      if (part.mode == GltfMode::Strip && (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])) continue;
      if (mirrored) std::swap(t[1], t[2]);
      mesh_.triangles.push_back(t);
    }
  }

  static std::string elementOf(const GltfAccessor& a, std::size_t i) { return a.place + ", element " + std::to_string(i); }

  std::string file_;
  GltfData data_;
  std::vector<GltfInstance> instances_;
  std::map<std::size_t, std::vector<GltfPart>> parts_;  ///< by the number of the mesh
  bool normals_ = false;                                ///< a part has them
  io::BadVertices bad_;
  std::vector<std::pair<std::string, std::size_t>> arrays_;  ///< of positions: their place, and the number of their first vertex
  MeshContent mesh_;
};

}  // namespace

MeshContent parseGltf(std::string_view bytes, const std::filesystem::path& file) { return GltfReader(bytes, file).read(); }

}  // namespace glint

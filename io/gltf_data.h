// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to io: what lies below the meshes of a glTF file, its container, buffers and accessors.

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/json_text.h"

namespace glint::io {

/// How a number is stored; the values are those of the format.
enum class GltfScalar { Int8 = 5120, Uint8 = 5121, Int16 = 5122, Uint16 = 5123, Uint32 = 5125, Float32 = 5126 };

/// Elements that lie one after the other in a buffer.
struct GltfRow {
  std::string_view bytes;  ///< from the first element on; empty = all are zero
  std::size_t stride = 0;
};

/// Elements that replace some others.
struct GltfSparse {
  std::size_t count = 0;
  GltfScalar scalar = GltfScalar::Uint32;  ///< of the numbers
  GltfRow numbers, values;
};

/// Elements of one kind. Invariant: what the rows name lies in their buffers.
struct GltfAccessor {
  std::string place;
  std::size_t number = 0;  ///< in the list of accessors
  std::size_t count = 0;
  GltfScalar scalar = GltfScalar::Float32;
  bool normalized = false;  ///< whole numbers stand for fractions of the largest
  GltfRow row;
  GltfSparse sparse;
};

/// The document of a .gltf or .glb file, and the bytes that it names. A buffer is read when a mesh uses it: those of pictures are
/// not. All functions throw InputError (file; a place such as `accessors[3].count`).
class GltfData {
 public:
  /// @param bytes  live longer than this
  GltfData(std::string_view bytes, const std::filesystem::path& file);

  const JsonNode& root() const { return *root_; }
  /// Size of the file and of the buffers that were read: memory is spent in proportion.
  std::size_t bytes() const { return total_; }

  /// Number in a list of the document, and the element itself: `index` is the place that names it.
  std::size_t numberIn(const char* list, const JsonNode& index) const;
  JsonNode element(const char* list, const JsonNode& index) const;

  /// Three numbers each, for a POSITION or NORMAL; floats, or the whole numbers of KHR_mesh_quantization.
  GltfAccessor vectors(const JsonNode& index);
  GltfAccessor indices(const JsonNode& index);

  /// Appends every element.
  void append(const GltfAccessor& accessor, std::vector<Eigen::Vector3d>& to) const;
  std::vector<std::uint32_t> values(const GltfAccessor& accessor) const;

 private:
  GltfAccessor accessor(const JsonNode& index, const char* type, std::size_t width, std::initializer_list<GltfScalar> allowed);
  GltfSparse sparseOf(const JsonNode& node, const GltfAccessor& a, std::size_t width);
  /// Calls `put` with the number of each sparse element and its place among them.
  template <class Put>
  void eachSparse(const GltfAccessor& accessor, const Put& put) const;
  /// `count` elements of `size` bytes of the view that `owner` names, from its byteOffset on.
  GltfRow row(const JsonNode& owner, std::size_t size, std::size_t count, const JsonNode& countNode);
  std::string_view buffer(const JsonNode& index);
  std::string contentOf(const JsonNode& uri) const;
  std::string fileBeside(const JsonNode& uri, const std::string& name) const;
  void readContainer(std::string_view bytes);

  std::filesystem::path folder_;
  std::string file_;
  std::optional<JsonNode> root_;
  std::optional<std::string_view> binary_;  ///< second chunk of a .glb file
  struct Buffer {
    std::string own;
    std::string_view bytes;
  };
  std::map<std::size_t, Buffer> buffers_;
  std::size_t total_ = 0;
};

/// A whole number from 0 on.
std::size_t gltfWhole(const JsonNode& node);

}  // namespace glint::io

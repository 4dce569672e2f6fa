// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/atomic_file.h"
#include "core/base/bytes.h"
#include "core/base/outcome.h"
#include "core/base/permitted.h"
#include "io/binary.h"
#include "io/mesh_builder.h"
#include "io/text_scan.h"

namespace glint::io {
namespace {

using Eigen::Vector3d;

std::size_t bytesOf(GltfScalar scalar) {
  switch (scalar) {
    case GltfScalar::Int8:
    case GltfScalar::Uint8: return 1;
    case GltfScalar::Int16:
    case GltfScalar::Uint16: return 2;
    case GltfScalar::Uint32:
    case GltfScalar::Float32: return 4;
  }
  return 0;
}

/// A normalised whole number is a fraction of the largest of its type; the lowest one, beyond -1, is -1.
double componentAt(const char* at, GltfScalar scalar, bool normalized) {
  const auto whole = [&](auto value) {
    return normalized ? std::max(double(value) / std::numeric_limits<decltype(value)>::max(), -1.0) : double(value);
  };
  switch (scalar) {
    case GltfScalar::Int8: return whole(valueAt<std::int8_t>(at, false));
    case GltfScalar::Uint8: return whole(valueAt<std::uint8_t>(at, false));
    case GltfScalar::Int16: return whole(valueAt<std::int16_t>(at, false));
    case GltfScalar::Uint16: return whole(valueAt<std::uint16_t>(at, false));
    case GltfScalar::Uint32: return whole(valueAt<std::uint32_t>(at, false));
    case GltfScalar::Float32: return valueAt<float>(at, false);
  }
  return 0;
}

Vector3d vectorAt(const GltfAccessor& a, const GltfRow& row, std::size_t i) {
  Vector3d v = Vector3d::Zero();
  if (row.bytes.empty()) return v;
  const char* at = row.bytes.data() + i * row.stride;
  for (int k = 0; k < 3; ++k) v[k] = componentAt(at + std::size_t(k) * bytesOf(a.scalar), a.scalar, a.normalized);
  return v;
}

std::uint32_t indexAt(GltfScalar scalar, const GltfRow& row, std::size_t i) {
  if (row.bytes.empty()) return 0;
  return static_cast<std::uint32_t>(componentAt(row.bytes.data() + i * row.stride, scalar, false));
}

GltfScalar scalarOf(const JsonNode& node, std::initializer_list<GltfScalar> allowed) {
  const std::size_t number = gltfWhole(node);
  for (const GltfScalar s : allowed)
    if (std::size_t(s) == number) return s;
  node.fail(std::to_string(number) + " is not a component type of these elements");
}

/// %20 and the like as the bytes that they stand for.
std::string unescaped(const std::string& uri) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0;
    out += escape ? static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2])) : uri[i];
    if (escape) i += 2;
  }
  return out;
}

/// "http:", "file:" and the like precede it.
bool hasScheme(const std::string& uri) {
  const std::size_t end = uri.find_first_of(":/?#");
  return end != std::string::npos && end > 0 && uri[end] == ':';
}

constexpr std::size_t kGlbHead = 12;      // magic number, version, length
constexpr std::size_t kGlbChunkHead = 8;  // length, type

}  // namespace

std::size_t gltfWhole(const JsonNode& node) {
  constexpr double kMost = 9007199254740992;  // 2^53: every whole number up to it is a double
  const double v = node.number();
  if (!(v >= 0 && v <= kMost) || v != std::floor(v)) node.fail("must be a whole number from 0 on");
  return static_cast<std::size_t>(v);
}

GltfData::GltfData(std::string_view bytes, const std::filesystem::path& file)
    : folder_(file.has_parent_path() ? file.parent_path() : "."), file_(file.string()), total_(bytes.size()) {
  if (bytes.starts_with("glTF"))
    readContainer(bytes);
  else
    root_ = JsonNode::parse(std::string(bytes), file_);
}

void GltfData::readContainer(std::string_view bytes) {
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  const auto number = [&](std::size_t at) { return valueAt<std::uint32_t>(bytes.data() + at, false); };
  if (bytes.size() < kGlbHead) fail(file_, byteNo(bytes.size()), "the glTF is truncated: its header has 12 bytes");
  if (number(4) != 2) fail(file_, byteNo(4), "glTF version " + std::to_string(number(4)) + "; only 2 is supported");
  const std::size_t length = number(8);
  if (length < kGlbHead) fail(file_, byteNo(8), "declares a length of " + std::to_string(length) + " bytes");
  if (length > bytes.size())
    fail(file_, byteNo(bytes.size()), "the glTF is truncated: its header declares " + std::to_string(length) + " bytes");
  for (std::size_t i = length; i < bytes.size(); ++i)
    if (!isPadding(bytes[i])) fail(file_, byteNo(i), "unexpected data after the bytes that the header declares");
  for (std::size_t at = kGlbHead; at < length;) {
    if (length - at < kGlbChunkHead) fail(file_, byteNo(at), "the glTF is truncated: a chunk begins with 8 bytes");
    const std::size_t size = number(at);
    const std::uint32_t type = number(at + 4);
    const std::size_t from = at + kGlbChunkHead;
    if (size > length - from)
      fail(file_, byteNo(at),
           "the glTF is truncated: a chunk of " + std::to_string(size) + " bytes; " + std::to_string(length - from) + " follow");
    const std::string_view chunk = bytes.substr(from, size);
    if (!root_) {
      if (type != kJson) fail(file_, byteNo(at), "the first chunk of the glTF is not its JSON text");
      root_ = JsonNode::parse(std::string(chunk), file_);
    } else if (type == kBinary && !binary_) {
      binary_ = chunk;
    }  // others belong to extensions
    at = from + size;
  }
  if (!root_) fail(file_, byteNo(kGlbHead), "the glTF has no JSON text");
}

std::size_t GltfData::numberIn(const char* list, const JsonNode& index) const {
  const std::size_t number = gltfWhole(index);
  const std::optional<JsonNode> all = root_->find(list);
  const std::size_t count = all ? all->size() : 0;
  if (number >= count)
    index.fail("names number " + std::to_string(number) + " of " + list + ", which has " + std::to_string(count));
  return number;
}

JsonNode GltfData::element(const char* list, const JsonNode& index) const {
  const std::size_t number = numberIn(list, index);
  return root_->at(list).at(number);
}

GltfAccessor GltfData::vectors(const JsonNode& index) {
  return accessor(index, "VEC3", 3,
                  {GltfScalar::Float32, GltfScalar::Int8, GltfScalar::Uint8, GltfScalar::Int16, GltfScalar::Uint16});
}

GltfAccessor GltfData::indices(const JsonNode& index) {
  return accessor(index, "SCALAR", 1, {GltfScalar::Uint8, GltfScalar::Uint16, GltfScalar::Uint32});
}

GltfAccessor GltfData::accessor(const JsonNode& index, const char* type, std::size_t width,
                                std::initializer_list<GltfScalar> allowed) {
  const JsonNode node = element("accessors", index);
  GltfAccessor a;
  a.place = node.place();
  a.number = numberIn("accessors", index);
  if (node.at("type").text() != type) node.at("type").fail(std::string("must be ") + type + " for " + index.place());
  a.scalar = scalarOf(node.at("componentType"), allowed);
  if (const std::optional<JsonNode> n = node.find("normalized")) a.normalized = n->boolean();
  const JsonNode count = node.at("count");
  a.count = gltfWhole(count);
  if (a.count == 0) count.fail("must be 1 or more");
  if (node.has("bufferView")) {
    a.row = row(node, width * bytesOf(a.scalar), a.count, count);
  } else if (a.count > total_) {  // zeros, which no byte stands for
    count.fail("is " + std::to_string(a.count) + ", without a bufferView and more than the file has bytes");
  }
  if (a.count > std::size_t(std::numeric_limits<int>::max()) && width == 3) count.fail("more than 2147483647 vertices");
  if (const std::optional<JsonNode> sparse = node.find("sparse")) a.sparse = sparseOf(*sparse, a, width);
  return a;
}

GltfSparse GltfData::sparseOf(const JsonNode& node, const GltfAccessor& a, std::size_t width) {
  const JsonNode count = node.at("count"), numbers = node.at("indices");
  GltfSparse s;
  s.count = gltfWhole(count);
  if (s.count == 0 || s.count > a.count) count.fail("must be 1 to the " + std::to_string(a.count) + " of the accessor");
  s.scalar = scalarOf(numbers.at("componentType"), {GltfScalar::Uint8, GltfScalar::Uint16, GltfScalar::Uint32});
  s.numbers = row(numbers, bytesOf(s.scalar), s.count, count);
  s.values = row(node.at("values"), width * bytesOf(a.scalar), s.count, count);
  return s;
}

GltfRow GltfData::row(const JsonNode& owner, std::size_t size, std::size_t count, const JsonNode& countNode) {
  const auto whole = [](const JsonNode& node, const char* key) {
    const std::optional<JsonNode> n = node.find(key);
    return n ? gltfWhole(*n) : 0;
  };
  const JsonNode view = element("bufferViews", owner.at("bufferView"));
  const std::string_view all = buffer(view.at("buffer"));
  const std::size_t from = whole(view, "byteOffset"), length = gltfWhole(view.at("byteLength"));
  if (from > all.size())
    view.at("byteOffset").fail("lies behind the end of its buffer of " + std::to_string(all.size()) + " bytes");
  if (length > all.size() - from)
    view.at("byteLength")
        .fail("is " + std::to_string(length) + "; its buffer has " + std::to_string(all.size() - from) + " bytes there");
  const std::size_t stride = view.has("byteStride") ? whole(view, "byteStride") : size;
  if (stride < size) view.at("byteStride").fail("is less than the " + std::to_string(size) + " bytes of an element");
  const std::size_t offset = whole(owner, "byteOffset");
  if (offset > length)
    owner.at("byteOffset").fail("lies behind the end of its buffer view of " + std::to_string(length) + " bytes");
  // No sum or product of numbers of the file: nothing overflows.
  const std::size_t left = length - offset, fit = left < size ? 0 : (left - size) / stride + 1;
  if (count > fit) countNode.fail("is " + std::to_string(count) + "; the buffer view has room for " + std::to_string(fit));
  return {all.substr(from + offset, (count - 1) * stride + size), stride};
}

std::string_view GltfData::buffer(const JsonNode& index) {
  const std::size_t number = numberIn("buffers", index);
  if (const auto known = buffers_.find(number); known != buffers_.end()) return known->second.bytes;
  const JsonNode node = element("buffers", index), length = node.at("byteLength");
  const std::optional<JsonNode> uri = node.find("uri");
  if (!uri && !(number == 0 && binary_)) node.fail("has no bytes: neither a uri nor a binary chunk");
  Buffer& b = buffers_[number];
  if (uri) {
    b.own = contentOf(*uri);
    total_ += b.own.size();
    constexpr double kMegabyte = 1e6;
    requireWithin(Limit::MeshMegabytes, double(total_) / kMegabyte, file_, uri->place());
  }
  const std::string_view content = uri ? std::string_view(b.own) : *binary_;
  if (gltfWhole(length) > content.size())
    length.fail("is " + std::to_string(gltfWhole(length)) + "; there are " + std::to_string(content.size()) + " bytes");
  return b.bytes = content.substr(0, gltfWhole(length));
}

std::string GltfData::contentOf(const JsonNode& uri) const {
  const std::string text = uri.text();
  if (!text.starts_with("data:")) {
    if (hasScheme(text)) uri.fail(io::quoted(text) + " is not a file beside this one; files elsewhere are not read");
    return fileBeside(uri, unescaped(text));
  }
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos || !std::string_view(text).substr(0, comma).ends_with(";base64"))
    uri.fail("of the data: URIs, only those in base64 are supported");
  std::optional<std::string> bytes = fromBase64(std::string_view(text).substr(comma + 1));
  if (!bytes) uri.fail("is not valid base64");
  return std::move(*bytes);
}

std::string GltfData::fileBeside(const JsonNode& uri, const std::string& name) const {
  std::filesystem::path path;
  try {
    path = resolveInside(folder_, name, {}, file_, uri.place());
  } catch (const OutsidePath&) {  // whose text offers an option, which is not meant for parts of a mesh
    uri.fail(io::quoted(name) + " does not lie in the folder of the file, and no others are read");
  }
  try {
    return readFile(path, Limit::MeshMegabytes);
  } catch (const InputError& e) {
    const std::string reason = std::string(e.what()).substr(std::min(e.file().size(), std::string(e.what()).size()));
    uri.fail(io::quoted(name) + reason);
  }
}

template <class Put>
void GltfData::eachSparse(const GltfAccessor& a, const Put& put) const {
  std::int64_t last = -1;
  for (std::size_t i = 0; i < a.sparse.count; ++i) {
    const std::int64_t number = indexAt(a.sparse.scalar, a.sparse.numbers, i);
    const auto bad = [&](const std::string& reason) {
      fail(file_, a.place + ".sparse.indices",
           "number " + std::to_string(i) + " names element " + std::to_string(number) + reason);
    };
    if (number >= std::int64_t(a.count)) bad("; the accessor has " + std::to_string(a.count));
    if (number <= last) bad(" after element " + std::to_string(last) + "; they must ascend");
    last = number;
    put(std::size_t(number), i);
  }
}

void GltfData::append(const GltfAccessor& a, std::vector<Vector3d>& to) const {
  const std::size_t first = to.size();
  for (std::size_t i = 0; i < a.count; ++i) to.push_back(vectorAt(a, a.row, i));
  eachSparse(a, [&](std::size_t number, std::size_t i) { to[first + number] = vectorAt(a, a.sparse.values, i); });
}

std::vector<std::uint32_t> GltfData::values(const GltfAccessor& a) const {
  std::vector<std::uint32_t> all(a.count);
  for (std::size_t i = 0; i < a.count; ++i) all[i] = indexAt(a.scalar, a.row, i);
  eachSparse(a, [&](std::size_t number, std::size_t i) { all[number] = indexAt(a.scalar, a.sparse.values, i); });
  return all;
}

}  // namespace glint::io

// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh_reader.h"

#include <algorithm>

#include "core/base/atomic_file.h"
#include "core/base/found_file.h"
#include "io/mesh_builder.h"
#include "io/stl_layout.h"
#include "io/text_scan.h"

namespace glint {
namespace {

/// JSON text with the keys of a glTF.
bool isGltfText(std::string_view bytes) {
  bytes = io::withoutMark(bytes);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || bytes[first] != '{') return false;
  const auto has = [&](std::string_view key) { return bytes.find(key) != std::string_view::npos; };
  return has("\"asset\"") && (has("\"meshes\"") || has("\"accessors\""));
}

}  // namespace

MeshContent readMeshContent(const std::filesystem::path& file) { return parseMesh(readFile(file, Limit::MeshMegabytes), file); }

MeshContent parseMesh(std::string_view bytes, const std::filesystem::path& file) {
  const std::string name = file.string();
  if (bytes.empty()) io::fail(name, "", "the file is empty (0 bytes)");
  const bool namedStl = lowerEnding(file) == ".stl";
  // A binary STL may start with "solid" too; its size follows from its facet count.
  const bool solid = io::beginsAsStlText(bytes);
  const std::size_t promised = io::stlBytesPromised(bytes);
  if (const std::string_view ply = io::withoutMark(bytes); ply.starts_with("ply\n") || ply.starts_with("ply\r"))
    return parsePly(ply, name);
  if (promised == bytes.size() && bytes.find('\0') != std::string_view::npos) return parseStlBinary(bytes, name);
  if (bytes.starts_with("glTF") || isGltfText(bytes)) return parseGltf(bytes, file);
  if (solid) return parseStlText(bytes, name);
  if (namedStl) return parseStlBinary(bytes, name);
  if (bytes.find('\0') != std::string_view::npos ||
      (bytes.find("v ") == std::string_view::npos && bytes.find("v\t") == std::string_view::npos))
    io::fail(name, "", "is not a mesh; supported: PLY, OBJ, STL, glTF");
  return parseObj(bytes, name);
}

}  // namespace glint

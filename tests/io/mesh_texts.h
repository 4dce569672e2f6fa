// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Small files of each format, written by hand: a unit square of two triangles.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "io/mesh_reader.h"

namespace glint::testing_support {

template <class T>
void put(std::string& bytes, T value, bool bigEndian = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (bigEndian) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

inline const double kSquare[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

inline std::string plyHead(const std::string& format, const std::string& type, const std::string& faces = "uchar int") {
  return "ply\nformat " + format + " 1.0\ncomment by hand\nelement vertex 4\nproperty " + type + " x\nproperty " + type +
         " y\nproperty " + type + " z\nelement face 2\nproperty list " + faces + " vertex_indices\nend_header\n";
}
inline std::string plyText() { return plyHead("ascii", "float") + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"; }

inline std::string plyTextWithNormals() {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\n"
         "property float ny\nproperty float nz\nproperty uchar red\nelement face 1\nproperty list uchar uint vertex_index\n"
         "end_header\n0 0 0 0 0 2 255\n1 0 0 0 0 1 255\n1 1 0 0 0 1 0\n0 1 0 0 0 1 0\n4 0 1 2 3\n";
}

template <class T>
std::string plyBinary(const std::string& type, bool big, const double (&corners)[4][3] = kSquare) {
  std::string bytes = plyHead(big ? "binary_big_endian" : "binary_little_endian", type);
  for (const auto& corner : corners)
    for (const double v : corner) put(bytes, static_cast<T>(v), big);
  for (const auto& t : {std::vector<int>{0, 1, 2}, std::vector<int>{0, 2, 3}}) {
    put(bytes, std::uint8_t(3), big);
    for (const int i : t) put(bytes, i, big);
  }
  return bytes;
}

inline std::string stlBinary() {
  std::string bytes(80, ' ');
  put(bytes, std::uint32_t(2));
  for (const auto& t : {std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0}, std::vector<float>{0, 0, 0, 1, 1, 0, 0, 1, 0}}) {
    for (const float v : {0.f, 0.f, 1.f}) put(bytes, v);
    for (const float v : t) put(bytes, v);
    put(bytes, std::uint16_t(0));
  }
  return bytes;
}
inline std::string stlText() {
  return "solid s\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n  endloop\n endfacet\n"
         " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 1 0\n   vertex 0 1 0\n  endloop\n endfacet\nendsolid "
         "s\n";
}

inline std::string objText() {
  return "# square\nmtllib a.mtl\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\ns off\nf 1/1/1 2/1/1 3//1\n"
         "f -4//-1 -2//-1 -1//-1\n";
}

/// The document of a glTF whose buffer of 60 bytes has four positions and six indices.
inline std::string gltfDocument(const std::string& uri) {
  return "{ \"asset\": { \"version\": \"2.0\" },\n \"buffers\": [ { " + uri + "\"byteLength\": 60 } ],\n" +
         R"( "bufferViews": [ { "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 12 } ],
 "accessors": [ { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
  { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" } ],
 "meshes": [ { "primitives": [ { "attributes": { "POSITION": 0 }, "indices": 1 } ] } ],
 "nodes": [ { "mesh": 0 } ], "scenes": [ { "nodes": [ 0 ] } ], "scene": 0 }
)";
}
inline std::string gltfText() {
  // By Python: base64.b64encode(struct.pack('<12f6H', 0,0,0, 1,0,0, 1,1,0, 0,1,0, 0,1,2, 0,2,3))
  return gltfDocument(
      "\"uri\": \"data:application/octet-stream;base64,"
      "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMA\",\n ");
}

/// A .glb file of a document and a binary chunk.
inline std::string glbOf(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string bytes = "glTF";
  put(bytes, std::uint32_t(2));
  put(bytes, std::uint32_t(28 + json.size() + binary.size()));
  put(bytes, std::uint32_t(json.size()));
  bytes += "JSON" + json;
  put(bytes, std::uint32_t(binary.size()));
  bytes += "BIN" + std::string(1, '\0') + binary;
  return bytes;
}
inline std::string glb() {
  std::string binary;
  for (const auto& corner : kSquare)
    for (const double v : corner) put(binary, static_cast<float>(v));
  for (const int i : {0, 1, 2, 0, 2, 3}) put(binary, std::uint16_t(i));
  return glbOf(gltfDocument(""), binary);
}

/// What every mesh that was read must fulfil, whatever the bytes. "" if it does.
inline std::string brokenPromise(const MeshContent& mesh) {
  if (mesh.triangles.empty()) return "no triangles";
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.vertices.size()) return "normals and vertices differ in number";
  for (const Eigen::Vector3d& v : mesh.vertices)
    if (!v.allFinite() || !(v.cwiseAbs().maxCoeff() <= 1e30)) return "a vertex that is not finite";
  for (const Eigen::Vector3d& n : mesh.normals)
    if (!n.isZero(0) && !(std::abs(n.norm() - 1) <= 1e-12)) return "a normal that is neither of length 1 nor zero";
  const int count = static_cast<int>(mesh.vertices.size());
  for (const Eigen::Vector3i& t : mesh.triangles)
    if (t.minCoeff() < 0 || t.maxCoeff() >= count) return "a corner out of range";
  return "";
}

}  // namespace glint::testing_support

// SPDX-License-Identifier: BSD-3-Clause
// The readers of meshes: a mesh that keeps its promises, or an InputError.
#include "core/base/outcome.h"
#include "io/mesh_reader.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/scratch_file.h"
#include "tests/io/mesh_texts.h"

namespace glint::fuzz {
namespace {

template <class Parse>
bool feed(const Parse& parse, const std::string& file) {
  try {
    const MeshContent mesh = parse();
    if (const std::string broken = testing_support::brokenPromise(mesh); !broken.empty()) throw Finding{broken};
    return true;
  } catch (const InputError& e) {
    checkRefusal(e, file);
    return false;
  }
}

}  // namespace

bool feedPly(const std::string& bytes) {
  return feed([&] { return parsePly(bytes, "m.ply"); }, "m.ply");
}
bool feedObj(const std::string& bytes) {
  return feed([&] { return parseObj(bytes, "m.obj"); }, "m.obj");
}
bool feedStl(const std::string& bytes) {
  return feed([&] { return parseMesh(bytes, "m.stl"); }, "m.stl");
}
// With a folder of its own, and a file there (body.ply) that a buffer may name.
bool feedGltf(const std::string& bytes) {
  return feed([&] { return parseGltf(bytes, scratch().path() / "m.gltf"); }, "m.gltf");
}
bool feedGlb(const std::string& bytes) {
  return feed([&] { return parseGltf(bytes, scratch().path() / "m.glb"); }, "m.glb");
}

}  // namespace glint::fuzz

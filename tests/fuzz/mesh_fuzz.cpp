// SPDX-License-Identifier: BSD-3-Clause
// The readers of meshes: a mesh that keeps its promises, or an InputError.
#include <cmath>

#include "core/base/outcome.h"
#include "io/cloud_reader.h"
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

template <class Parse>
bool feedCloud(const Parse& parse, const std::string& file) {
  try {
    const CloudContent cloud = parse();
    if (cloud.points.empty()) throw Finding{"a cloud without points"};
    if (!cloud.normals.empty() && cloud.normals.size() != cloud.points.size()) throw Finding{"not a normal for every point"};
    for (const Eigen::Vector3d& p : cloud.points)
      if (!p.allFinite()) throw Finding{"a point that is not finite"};
    constexpr double kUnit = 1e-9;  // round-off of a division
    for (const Eigen::Vector3d& n : cloud.normals)
      if (!(std::abs(n.norm() - 1) < kUnit)) throw Finding{"a normal that is no unit vector"};
    return true;
  } catch (const InputError& e) {
    checkRefusal(e, file);
    return false;
  }
}

}  // namespace

bool feedPcd(const std::string& bytes) {
  return feedCloud([&] { return parsePcd(bytes, "c.pcd"); }, "c.pcd");
}
bool feedPlyCloud(const std::string& bytes) {
  return feedCloud([&] { return parsePlyCloud(bytes, "c.ply"); }, "c.ply");
}
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

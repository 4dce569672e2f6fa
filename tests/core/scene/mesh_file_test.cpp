// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cstring>

#include "core/scene/surface_source.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/shared_data.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// A unit square of two triangles with normals +z.
std::string asciiPly() {
  return "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
         "z\nproperty float nx\nproperty float ny\n"
         "property float nz\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0 2\n1 0 0 0 0 1\n1 1 0 "
         "0 0 1\n0 1 0 0 0 1\n3 0 1 2\n3 0 2 3\n";
}

template <class T>
void put(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

std::string binaryPly() {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement "
      "face 2\nproperty list uchar int vertex_indices\nend_header\n";
  for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f}) put(bytes, v);
  for (const auto& t : {std::array<int, 3>{0, 1, 2}, std::array<int, 3>{0, 2, 3}}) {
    put(bytes, static_cast<unsigned char>(3));
    for (const int i : t) put(bytes, i);
  }
  return bytes;
}

std::string binaryStl() {
  std::string bytes(80, ' ');
  put(bytes, std::uint32_t(2));
  for (const auto& t : {std::array<float, 9>{0, 0, 0, 1, 0, 0, 1, 1, 0}, std::array<float, 9>{0, 0, 0, 1, 1, 0, 0, 1, 0}}) {
    for (const float v : {0.f, 0.f, 1.f}) put(bytes, v);
    for (const float v : t) put(bytes, v);
    put(bytes, std::uint16_t(0));
  }
  return bytes;
}

std::string asciiStl() {
  return "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\nfacet normal 0 0 "
         "1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\n"
         "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
}

std::string obj() { return "# square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"; }

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    sum += (b - a).cross(c - a).norm() / 2;
  }
  return sum;
}

TEST(ReadMesh, EveryFormatGivesTheSameSquare) {
  const TemporaryFolder folder;
  for (const auto& [name, content] : {std::pair<const char*, std::string>{"a.ply", asciiPly()},
                                      {"b.ply", binaryPly()},
                                      {"b.stl", binaryStl()},
                                      {"a.stl", asciiStl()},
                                      {"a.obj", obj()},
                                      {"unnamed", binaryPly()},
                                      {"unnamed2", binaryStl()}}) {
    const TriangleMesh mesh = readMesh(folder.write(name, content));
    EXPECT_EQ(mesh.vertices.size(), 4u) << name;
    EXPECT_EQ(mesh.triangles.size(), 2u) << name;
    EXPECT_EQ(area(mesh), 1.0) << name;
  }
}

TEST(ReadMesh, NormalsAreTakenAndNormalised) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = readMesh(folder.write("a.ply", asciiPly()));
  ASSERT_EQ(mesh.normals.size(), 4u);
  EXPECT_EQ(mesh.normals[0], Eigen::Vector3d(0, 0, 1));
  EXPECT_TRUE(readMesh(folder.write("b.ply", binaryPly())).normals.empty());
}

TEST(ReadMesh, DataMeshesHaveTheCountsOfTheirHeaders) {
  GLINT_NEEDS_SHARED_DATA();
  const TriangleMesh mesh = readMesh(fs::path(GLINT_SHARED_DIR) / "data/cycles/sphere/mesh/geom_00.ply");
  EXPECT_EQ(mesh.vertices.size(), 98306u);
  EXPECT_EQ(mesh.triangles.size(), 196608u);
  EXPECT_EQ(mesh.normals.size(), 98306u);
}

/// Cutting a file anywhere must give an error, never fewer triangles, a crash, or a line on the terminal.
TEST(ReadMesh, TruncatedAnywhereIsAnError) {
  const TemporaryFolder folder;
  for (const auto& [name, content] : {std::pair<const char*, std::string>{"a.ply", asciiPly()},
                                      {"b.ply", binaryPly()},
                                      {"b.stl", binaryStl()},
                                      {"a.stl", asciiStl()}}) {
    // The last blank or newline, and the name after endsolid, may be missing.
    const std::size_t necessary = std::string(name) == "a.stl"   ? content.find("endsolid") + 8
                                  : std::string(name) == "a.ply" ? content.size() - 1
                                                                 : content.size();
    testing::internal::CaptureStderr();
    for (std::size_t n = 0; n < necessary; ++n) {
      const fs::path file = folder.write(name, content.substr(0, n));
      EXPECT_THAT(inputErrorOf([&] { readMesh(file); }), HasSubstr(file.string())) << n;
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << name;
  }
}

TEST(ReadMesh, WrongContentIsNamed) {
  const TemporaryFolder folder;
  const auto message = [&](const char* name, const std::string& content) {
    const fs::path file = folder.write(name, content);
    return inputErrorOf([&] { readMesh(file); });
  };
  EXPECT_THAT(message("a.ply", with(asciiPly(), "3 0 2 3", "3 0 2 9")), HasSubstr("face 1: names vertex 9"));
  EXPECT_THAT(message("a.ply", with(asciiPly(), "3 0 2 3", "3 0 2 -1")), HasSubstr("face 1: names vertex"));
  EXPECT_THAT(message("a.ply", with(asciiPly(), "1 1 0 0 0 1", "1 nan 0 0 0 1")), HasSubstr("vertex 2: is not finite"));
  EXPECT_THAT(message("a.ply", with(with(asciiPly(), "element face 2", "element face 0"), "3 0 1 2\n3 0 2 3\n", "")),
              HasSubstr("no faces"));
  EXPECT_THAT(message("a.ply", with(asciiPly(), "element vertex 4", "element vertex 4000000000000")), HasSubstr("truncated"));
  EXPECT_THAT(message("b.ply", with(binaryPly(), "element vertex 4", "element vertex 4000000000000000000")),
              HasSubstr("truncated"));
  EXPECT_THAT(message("a.obj", with(obj(), "f 1 2 3 4", "f 1 2 3 5")), HasSubstr("line 6: a face names vertex 5"));
  EXPECT_THAT(message("a.obj", with(obj(), "f 1 2 3 4", "f 1 2 x")), HasSubstr("line 6: 'x'"));
  EXPECT_THAT(message("a.obj", with(obj(), "f 1 2 3 4", "")), HasSubstr("no faces"));
  EXPECT_THAT(message("a.png", "\x89PNG"), HasSubstr("is not a mesh"));
  EXPECT_THAT(inputErrorOf([&] { readMesh(folder / "none.ply"); }), HasSubstr("No such file"));
}

}  // namespace
}  // namespace glint

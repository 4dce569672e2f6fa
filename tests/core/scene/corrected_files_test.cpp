// SPDX-License-Identifier: BSD-3-Clause
// Corrections that write a mesh. tests/formats/fixes.py has the whole way, against a mesh of another language.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <fstream>

#include "core/base/number_text.h"
#include "core/scene/correction.h"
#include "core/scene/geometry_check.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint::corrected_files_tests {
namespace {
using Eigen::Vector3d;
using testing::HasSubstr;
using testing_support::inputErrorOf;
using testing_support::TemporaryFolder;

/// A tetrahedron with facets that look outwards, worked out by hand, and normals away from its middle.
TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  for (const Vector3d& v : mesh.vertices) mesh.normals.push_back((v - Vector3d::Constant(0.25)).normalized());
  return mesh;
}

void turnFacets(TriangleMesh& mesh) {
  for (Eigen::Vector3i& t : mesh.triangles) std::swap(t[1], t[2]);
}
void turnNormals(TriangleMesh& mesh) {
  for (Vector3d& n : mesh.normals) n = -n;
}

/// Unit normals of its facets.
std::vector<Vector3d> facetNormals(const TriangleMesh& mesh) {
  std::vector<Vector3d> all;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Vector3d a = mesh.vertices[std::size_t(t[0])];
    all.push_back((mesh.vertices[std::size_t(t[1])] - a).cross(mesh.vertices[std::size_t(t[2])] - a).normalized());
  }
  return all;
}

std::string asPly(const TriangleMesh& mesh) {
  std::string ply = "ply\nformat ascii 1.0\nelement vertex 4\n";
  for (const char* k : {"x", "y", "z", "nx", "ny", "nz"}) ply += std::string("property double ") + k + "\n";
  ply += "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < 4; ++i) {
    for (const Vector3d& v : {mesh.vertices[i], mesh.normals[i]})
      for (int k = 0; k < 3; ++k) ply += formatted("%.17g", v[k]) + " ";
    ply += "\n";
  }
  for (const Eigen::Vector3i& t : mesh.triangles)
    ply += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
  return ply;
}

constexpr const char* kScene = R"({"glint_scene": 1,
  "camera": {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 31.5, "cy": 23.5},
  "frames": [{"id": "a", "surface": "body", "camera_from_world": [[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]]}],
  "surfaces": {"body": {"mesh": "body.ply", "units": "mm"}}})";

TEST(SidesRight, OfAClosedMeshWhateverIsReversed) {
  const std::vector<Vector3d> expected{{0, 0, -1}, {0, -1, 0}, {-1, 0, 0}, Vector3d::Constant(std::sqrt(1.0 / 3))};
  for (int what = 0; what < 4; ++what) {
    TriangleMesh mesh = tetrahedron();
    if (what & 1) turnFacets(mesh);
    if (what & 2) turnNormals(mesh);
    EXPECT_EQ(sidesOf(mesh).empty(), what == 0);
    const TriangleMesh right = withSidesRight(mesh, {});
    EXPECT_EQ(sidesOf(right), "");
    const std::vector<Vector3d> normals = facetNormals(right);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_LT((normals[i] - expected[i]).norm(), 1e-12) << what;
      EXPECT_LT((right.normals[i] - tetrahedron().normals[i]).norm(), 1e-12) << what;
    }
  }
}

TEST(SidesRight, OfAnOpenMeshAreThoseThatTheCamerasSee) {
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}};  // towards +z
  sheet.normals.assign(3, Vector3d(0, 0, -1));
  const TriangleMesh above = withSidesRight(sheet, {{0.2, 0.2, 3}, {1, 0, 2}, {0, 0, -1}});
  EXPECT_LT((facetNormals(above)[0] - Vector3d(0, 0, 1)).norm(), 1e-12);
  EXPECT_EQ(above.normals[0], Vector3d(0, 0, 1));
  const TriangleMesh below = withSidesRight(sheet, {{0.2, 0.2, -3}});
  EXPECT_LT((facetNormals(below)[0] - Vector3d(0, 0, -1)).norm(), 1e-12);
  EXPECT_EQ(below.normals[0], Vector3d(0, 0, -1));
}

TEST(CorrectedFor, WritesTheMeshBesideTheSceneInItsUnit) {
  const TemporaryFolder folder;
  TriangleMesh reversed = tetrahedron();
  turnFacets(reversed);
  turnNormals(reversed);
  folder.write("body.ply", asPly(reversed));
  const Scene scene = readScene(folder.write("scene.json", kScene));
  for (int again = 0; again < 2; ++again) {  // what it wrote itself, it replaces
    const Scene right = correctedFor(scene, {"flip-faces"}, folder / "right.json");
    EXPECT_EQ(right.surfaces.at("body").file()->file, folder / "right.body.ply");
    EXPECT_DOUBLE_EQ(right.surfaces.at("body").file()->metresPerUnit, 0.001);
    writeScene(right, folder / "right.json");
  }
  const Scene back = readScene(folder / "right.json");
  const TriangleMesh mesh = back.surfaces.at("body").triangles().mesh;
  EXPECT_LT((mesh.vertices[1] - Vector3d(0.001, 0, 0)).norm(), 1e-15);
  EXPECT_EQ(sidesOf(mesh), "");
}

TEST(CorrectedFor, RefusesWhereNothingIsReversedAndLeavesFilesOfOthers) {
  const TemporaryFolder folder;
  folder.write("body.ply", asPly(tetrahedron()));
  const Scene right = readScene(folder.write("scene.json", kScene));
  EXPECT_THAT(inputErrorOf([&] { correctedFor(right, {"flip-faces"}, folder / "right.json"); }),
              HasSubstr("no mesh has its sides reversed"));
  TriangleMesh reversed = tetrahedron();
  turnFacets(reversed);
  folder.write("body.ply", asPly(reversed));
  const Scene scene = readScene(folder / "scene.json");
  // A later fix that fails takes the mesh back.
  EXPECT_THAT(inputErrorOf([&] {
                correctedFor(scene, {"flip-faces", "depth-scale=1"}, folder / "right.json");
              }),
              HasSubstr("depth map"));
  EXPECT_FALSE(std::filesystem::exists(folder / "right.body.ply"));
  folder.write("right.body.ply", "somebody's notes");
  EXPECT_THAT(inputErrorOf([&] { correctedFor(scene, {"flip-faces"}, folder / "right.json"); }), HasSubstr("exists"));
  std::ifstream in(folder / "right.body.ply");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "somebody's notes");
}

TEST(CorrectedFor, PhotographsAreNotRewrittenAndItSaysWhatDoes) {
  const TemporaryFolder folder;
  folder.write("body.ply", asPly(tetrahedron()));
  const Scene scene = readScene(folder.write("scene.json", kScene));
  EXPECT_THAT(inputErrorOf([&] { correctedFor(scene, {"mirror-photographs"}, folder / "right.json"); }), HasSubstr("mogrify"));
}

}  // namespace
}  // namespace glint::corrected_files_tests

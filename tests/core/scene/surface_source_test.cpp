// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/surface_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/json_text.h"
#include "core/surface/point_surface.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

const char* const kRightTriangle = "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n";

AnalyticSpec ball() {
  AnalyticSpec s;
  s.type = "sphere";
  s.radius = 0.5;
  return s;
}

/// Points of a plane z = `height`, enough for a surface.
PointCloud plane(double height) {
  PointCloud cloud;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) cloud.points.emplace_back(0.1 * i, 0.1 * j, height);
  return cloud;
}

CapturePoints tracksOf(double height = 0) {
  return {{"/capture/points3D.bin"}, std::make_shared<const PointCloud>(plane(height))};
}

TEST(SurfaceSource, EveryKindSaysWhatItIsAndWhatItReads) {
  const SurfaceSource mesh = MeshFile{{"/a/body.ply", "body.ply"}}, points = PointsFile{{"/a/cloud.pcd", "cloud.pcd"}},
                      tracks = tracksOf(), formula = ball();
  EXPECT_EQ(mesh.kind() + "; " + points.kind() + "; " + tracks.kind() + "; " + formula.kind(),
            "mesh; points; points; analytic sphere");
  EXPECT_EQ(mesh.shape() + "; " + points.shape() + "; " + tracks.shape() + "; " + formula.shape(), "mesh; mesh; mesh; sphere");
  EXPECT_EQ(mesh.file()->file, "/a/body.ply");
  EXPECT_EQ(points.file()->file, "/a/cloud.pcd");
  EXPECT_EQ(tracks.file()->file, "/capture/points3D.bin");
  EXPECT_EQ(formula.file(), nullptr);
  EXPECT_TRUE(mesh.hasTriangles() && points.hasTriangles() && tracks.hasTriangles() && !formula.hasTriangles());
  EXPECT_EQ(formula.triangles().failure->reason, Reason::NotSupported);
}

TEST(SurfaceSource, TrianglesAreInMetres) {
  const TemporaryFolder folder;
  const SurfaceSource mesh = MeshFile{{folder.write("body.obj", kRightTriangle), "", 0.1}};
  EXPECT_NEAR(mesh.triangles().mesh.vertices[1].x(), 0.2, 1e-15);
  CapturePoints tracks = tracksOf(3);
  tracks.metresPerUnit = 0.01;
  EXPECT_NEAR(tracks.triangles().mesh.vertices.front().z(), 0.03, 1e-9);
  EXPECT_NEAR(tracks.points->points.front().z(), 3, 0) << "as the capture says";
}

TEST(SurfaceSource, TrianglesAreTheSameOfTheSameFileUnitAndKind) {
  const SurfaceSource mesh = MeshFile{{"/a/body.ply", "body.ply"}}, tracks = tracksOf(), formula = ball();
  EXPECT_TRUE(mesh.hasTrianglesOf(MeshFile{{"/a/body.ply"}}));  // whatever a file calls it
  EXPECT_FALSE(mesh.hasTrianglesOf(MeshFile{{"/b/body.ply"}}));
  EXPECT_FALSE(mesh.hasTrianglesOf(MeshFile{{"/a/body.ply", "", 0.001}}));
  EXPECT_FALSE(mesh.hasTrianglesOf(PointsFile{{"/a/body.ply"}}));
  EXPECT_TRUE(tracks.hasTrianglesOf(SurfaceSource(tracks)));
  EXPECT_FALSE(tracks.hasTrianglesOf(tracksOf()));
  EXPECT_FALSE(formula.hasTrianglesOf(formula));  // made anew: that is quick
}

TEST(SurfaceSource, LoadsEveryKindAndReadsTrianglesAsTheCallerDoes) {
  const TemporaryFolder folder;
  const SurfaceSource mesh = MeshFile{{folder.write("body.obj", kRightTriangle)}}, tracks = tracksOf(), formula = ball();
  for (const SurfaceSource* s : {&mesh, &tracks, &formula}) {
    const auto surface = s->load({});
    ASSERT_TRUE(surface) << surface.failure().message();
    EXPECT_TRUE((*surface)->firstHit({{0.3, 0.3, 5}, {0, 0, -1}})) << s->kind();
  }
  int reads = 0;
  const auto counted = [&](const SurfaceSource& s) { return ++reads, s.triangles(); };
  for (const SurfaceSource* s : {&mesh, &tracks, &formula}) EXPECT_TRUE(s->load({}, counted));
  EXPECT_EQ(reads, 2);
  const SurfaceSource few = CapturePoints{{"/c"}, std::make_shared<const PointCloud>(PointCloud{{{0, 0, 0}}, {}})};
  EXPECT_EQ(few.load({}).failure().reason, Reason::TooFewPoints);
  EXPECT_EQ(few.triangles().mesh.vertices.size(), 1u) << "the points alone";
  const fs::path empty = folder.write("none.obj", "v 0 0 0\n");
  EXPECT_THAT(inputErrorOf([&] { (void)SurfaceSource(MeshFile{{empty}}).load({}); }), HasSubstr(empty.string()));
}

TEST(SurfaceSource, ReadsOnlyTheKeysOfItsDocument) {
  const auto find = [](const JsonNode& n) { return fs::path("/found") / n.text(); };
  const auto parsed = [](const char* text) { return JsonNode::parse(text, "f.json"); };
  const SurfaceSource cloud = readSurfaceJson(parsed(R"({"points": "c.ply", "units": "cm"})"), find).source;
  EXPECT_EQ(cloud.kind(), "points");
  EXPECT_EQ(cloud.file()->file, "/found/c.ply");
  EXPECT_EQ(cloud.file()->named, "c.ply");
  EXPECT_EQ(cloud.file()->metresPerUnit, 0.01);
  for (const char* bad : {"{}", R"({"mesh": "a.ply", "points": "a.ply"})"})
    EXPECT_THAT(inputErrorOf([&] { readSurfaceJson(parsed(bad), find); }),
                HasSubstr("needs exactly one of mesh, points, analytic"));
  const std::vector<std::string> few{"mesh", "analytic"};
  EXPECT_THAT(inputErrorOf([&] { readSurfaceJson(parsed(R"({"points": "c.ply"})"), find, few); }),
              HasSubstr("needs exactly one of mesh, analytic"));
  EXPECT_EQ(readSurfaceJson(parsed(R"({"mesh": "a.ply", "units": "cm"})"), find, few).source.file()->metresPerUnit, 1)
      << "this document has no units";
}

TEST(SurfaceSource, KnowsTheKeysOfItsShape) {
  const auto known = [](const std::string& formula) {
    return readSurfaceJson(JsonNode::parse("{\"analytic\": " + formula + "}", "f.json"), {}).known.at("analytic");
  };
  EXPECT_THAT(known(R"({"type": "plane"})"), ElementsAre("type", "world_from_surface"));
  EXPECT_THAT(known(R"({"type": "sphere", "radius": 1})"), ElementsAre("radius", "type", "world_from_surface"));
  EXPECT_THAT(known(R"({"type": "cylinder", "radius": 1})"), ElementsAre("radius", "type", "world_from_surface"));
  EXPECT_THAT(known(R"({"type": "ellipsoid", "semi_axes": [1, 2, 3]})"), ElementsAre("semi_axes", "type", "world_from_surface"));
  EXPECT_THAT(known(R"({"type": "sheet", "curvature": 1})"),
              ElementsAre("curvature", "length", "type", "width", "world_from_surface"));
  EXPECT_THAT(known(R"({"type": "torus", "major_radius": 2, "minor_radius": 1})"),
              ElementsAre("major_radius", "minor_radius", "type", "world_from_surface"));
}

}  // namespace
}  // namespace glint

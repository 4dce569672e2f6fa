// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/convention_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {

/// Balls in a row, 3 m apart, each seen whole by two frames that come long after each other.
Scene rowOfBalls(int count) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    AnalyticSpec& ball = *scene.surfaces[std::to_string(i)].analytic();
    ball.type = "sphere";
    ball.radius = 0.25;
    ball.worldFromSurface.translation().x() = 3 * i;
  }
  for (int i = 0; i < 2 * count; ++i) {
    Frame f;
    f.id = std::to_string(i);
    f.surface = std::to_string(i % count);
    f.camera.width = 640;
    f.camera.height = 480;
    f.camera.pixelFromRay << 800, 0, 319.5, 0, 800, 239.5, 0, 0, 1;
    f.camera.camFromWorld.translation() = Eigen::Vector3d(-3 * (i % count), 0, 2);
    scene.frames.push_back(f);
  }
  return scene;
}

// More surfaces than triangles are kept of: every frame is still compared with its own.
TEST(ConventionReport, FramesOfManySurfacesSeeTheirOwn) {
  constexpr int kCount = 150;
  const ConventionReport report = conventionReport(rowOfBalls(kCount));
  ASSERT_EQ(report.surfaces.size(), std::size_t(kCount));
  ASSERT_EQ(report.frames.size(), std::size_t(2 * kCount));
  for (const ConventionReport::SurfaceFacts& s : report.surfaces) EXPECT_NEAR((s.upper - s.lower).x(), 0.5, 0.01) << s.id;
  for (const ConventionReport::FrameFacts& f : report.frames) {
    EXPECT_GT(f.vertices, 0);
    EXPECT_EQ(f.verticesInImage, f.vertices) << f.id;
    EXPECT_EQ(f.verticesInFront, f.vertices) << f.id;
    EXPECT_NEAR(f.distance, 2, 1e-9) << f.id;
  }
}

TEST(ConventionReport, CountsTheFacetsThatAnStlLeavesOut) {
  const testing_support::TemporaryFolder folder;
  const auto facet = [](const char* last) {
    return std::string("facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex ") + last + "\nendloop\nendfacet\n";
  };
  const auto findings = [&](const std::string& facets) {
    Scene scene = rowOfBalls(1);
    scene.surfaces.at("0") = MeshFile{{folder.write("m.stl", "solid m\n" + facets + "endsolid m\n")}};
    return conventionReport(scene).findings;
  };
  const std::string good = facet("0 1 0") + facet("1 1 0");
  const auto saysSo = testing::Contains(testing::HasSubstr("facets: a corner of each has no place"));
  EXPECT_THAT(findings(good), testing::Not(saysSo));
  EXPECT_THAT(findings(good + facet("0 nan 0") + facet("inf 1 0") + facet("0 1e31 0")),
              testing::Contains((folder / "m.stl").string() + " lacks 3 of its 5 facets: a corner of each has no place"));
}

/// IEEE 754: from 2^29 to 2^30 numbers of 53 bits are 2^-23 apart, those of 24 bits 2^6.
TEST(ConventionReport, AnObjectFarFromTheOriginIsAFinding) {
  const auto findingsAt = [](double distance) {
    Scene scene = rowOfBalls(1);
    scene.surfaces.at("0").analytic()->worldFromSurface.translation().x() += distance;
    for (Frame& f : scene.frames) f.camera.camFromWorld.translation().x() -= distance;
    std::string all;
    for (const std::string& f : conventionReport(scene).findings) all += f + "\n";
    return all;
  };
  EXPECT_EQ(findingsAt(0).find("apart"), std::string::npos);
  EXPECT_EQ(findingsAt(5e6).find("apart"), std::string::npos) << "coordinates of a map";
  const std::string far = findingsAt(1e9);
  EXPECT_NE(far.find("surface '0' of 0.866 m lies 1e+09 m from the origin, where coordinates are 1.2e-07 m apart"),
            std::string::npos)
      << far;
  EXPECT_NE(far.find("in 32-bit files 64 m"), std::string::npos) << far;
}

}  // namespace
}  // namespace glint

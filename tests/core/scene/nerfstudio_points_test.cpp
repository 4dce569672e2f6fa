// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "tests/core/scene/nerfstudio_fixture.h"
#include "tests/tolerances.h"

// The sparse points of nerfstudio (ply_file_path). Expected values come from computations written beside them.

namespace glint::nerfstudio_points_tests {
namespace {
using namespace testing_support;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(Nerfstudio, PointsAreThoseOfThePlyFile) {
  const TemporaryFolder folder;
  const fs::path points = folder.write("sub/sparse_pc.ply", kTwoPoints);
  const std::string text = with(minimalTransforms(), "{", R"({"ply_file_path": "./sub/sparse_pc.ply",)");
  const Capture capture = readText(folder, text);
  EXPECT_THAT(capture.sources, ElementsAre(folder / "transforms.json", points));
  const std::vector<CaptureTrack> tracks = nerfstudioReader().tracks(capture, {});
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_EQ(tracks[0].point, Eigen::Vector3d(4, -2, 1.5));
  EXPECT_EQ(tracks[1].point, Eigen::Vector3d(-1, 0.25, 8));
  EXPECT_TRUE(tracks[0].seen.empty());
}

/// saved = 4 (A original), A: (x, y, z) -> (y, -x, z) and a shift by (1, 2, 3): the original of (4, -2, 1.5) is found by hand.
/// Divided by 4: (1, -0.5, 0.375); less the shift: (0, -2.5, -2.625); y = 0, -x = -2.5.
TEST(Nerfstudio, PointsMoveToTheOriginalWorldWithTheCameras) {
  const TemporaryFolder folder;
  folder.write("sparse_pc.ply", kTwoPoints);
  const std::string text = with(minimalTransforms(), "{",
                                R"({"applied_transform": [[0,1,0,1],[-1,0,0,2],[0,0,1,3]], "applied_scale": 4,
                                "ply_file_path": "sparse_pc.ply",)");
  const Capture stored = readText(folder, text), original = readText(folder, text, originalWorld());
  EXPECT_THAT(original.facts, Contains(HasSubstr("in the original world as the cameras")));
  const std::vector<CaptureTrack> tracks = nerfstudioReader().tracks(original, originalWorld());
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_NEAR((tracks[0].point - Eigen::Vector3d(2.5, 0, -2.625)).norm(), 0, tolerance::kExact);
  // Cameras and points moved together: a point in front of the camera stays on its pixel.
  const Eigen::Vector3d before(0, 1.5, 1), after((2 - 1.5 / 4), 0 / 4. - 1, 1 / 4. - 3);
  const std::optional<Pixel> was = stored.views[0].camera.project(before), is = original.views[0].camera.project(after);
  ASSERT_TRUE(was && is);
  EXPECT_NEAR((*was - *is).norm(), 0, tolerance::kExact);
}

TEST(Nerfstudio, PointsThatCannotBeReadAreNamed) {
  const std::string text = with(minimalTransforms(), "{", R"({"ply_file_path": "p.ply",)");
  const TemporaryFolder folder;
  Capture capture = readText(folder, text);
  EXPECT_THAT(capture.warnings, ElementsAre(HasSubstr("there is no 'p.ply'")));
  EXPECT_TRUE(nerfstudioReader().tracks(capture, {}).empty());
  EXPECT_THAT(capture.sources, ElementsAre(folder / "transforms.json"));

  struct Damage {
    const char *from, *to, *reason;
  };
  for (const Damage& d : {Damage{"vertex 2", "vertex 3", "truncated"}, Damage{"vertex 2", "vertex 999999999", "truncated"},
                          Damage{"4 -2", "4e15 -2", "farther than 1e15"},
                          Damage{"property uint8 red", "element face 0\nproperty list uchar int i", ""}}) {
    folder.write("p.ply", with(kTwoPoints, d.from, d.to));
    capture = readText(folder, text);
    EXPECT_THAT(inputErrorOf([&] { nerfstudioReader().tracks(capture, {}); }),
                testing::AllOf(HasSubstr("p.ply: "), HasSubstr(d.reason)))
        << d.to;
  }
  folder.write("p.ply", with(kTwoPoints, "4 -2", "nan -2"));  // a point without a place costs that point
  EXPECT_EQ(nerfstudioReader().tracks(readText(folder, text), {}).size(), 1u);
  EXPECT_THAT(inputErrorOf([&] { readText(folder, with(text, "p.ply", "../p.ply")); }), HasSubstr("ply_file_path: "));
}

}  // namespace
}  // namespace glint::nerfstudio_points_tests

// SPDX-License-Identifier: BSD-3-Clause
// Scenes from images or a video with poses, and from points without triangles: what is read, written back, and kept by sessions.
#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

#include "core/app/session.h"
#include "core/scene/capture.h"
#include "core/scene/convention_report.h"
#include "tests/core/scene/png_fixture.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/core/scene/video_fixture.h"

namespace glint::posed_scene_tests {
namespace {
using testing::AllOf;
using testing::AnyOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using namespace testing_support;

/// A flat square of 30 x 30 points in the plane z = 0, 1 cm apart.
std::string cloudPly() {
  std::ostringstream ply;
  constexpr int kSide = 30;
  ply << "ply\nformat ascii 1.0\nelement vertex " << kSide * kSide
      << "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) ply << 0.01 * (x - kSide / 2) << ' ' << 0.01 * (y - kSide / 2) << " 0\n";
  return ply.str();
}

struct Folder : TemporaryFolder {
  Folder() {
    cloud = write("cloud.ply", cloudPly());
    poses = write("poses.txt", "0.04 0 0 -2 0 0 0 1\n0.2 0.1 0 -2 0 0 0 1\n");
    options.choices.poses = poses;
    options.choices.camera = {80, 80, 31.5, 23.5};
    options.choices.surface = InputChoices::Surface::File;
    options.choices.surfaceFile = cloud;
  }
  std::filesystem::path cloud, poses;
  ReadOptions options;
};

TEST(PosedScene, WithoutPosesAFolderOfImagesSaysWhatIsMissing) {
  const TemporaryFolder folder;
  folder.write("frames/0.04.png", pngOfSize(64, 48));
  try {
    readScene(folder / "frames");
    FAIL() << "not refused";
  } catch (const UndecidedInput& e) {
    EXPECT_EQ(e.question(), UndecidedInput::Question::Poses);
    EXPECT_THAT(e.what(), HasSubstr("--poses FILE"));
  }
  ReadOptions options;
  options.choices.posesByOrder = true;
  EXPECT_THAT(inputErrorOf([&] { readScene(folder / "frames", options); }), HasSubstr("--poses FILE, which is missing"));
  options.choices.poses = folder.write("poses.txt", "0.04 0 0 0 0 0 0 1\n");
  folder.write("empty/scene.json", minimalScene());
  EXPECT_THAT(inputErrorOf([&] { readScene(folder / "empty", options); }), HasSubstr("--poses"));
}

TEST(PosedScene, PicturesOfAVideoAreDecodedAndKeptInASceneFile) {
  Folder folder;
  ASSERT_TRUE(writeVideo(folder / "clip.avi", "MJPG", 20, 25));
  const Scene scene = readScene(folder / "clip.avi", folder.options);
  EXPECT_EQ(scene.kind, "video");
  ASSERT_EQ(scene.frames.size(), 2u);
  EXPECT_EQ(scene.frames[1].id, "000005");
  writeScene(scene, folder / "out.json");
  const Scene again = readScene(folder / "out.json");
  constexpr double kGreyOff = 6 / 255.0;  // of lossy pictures
  for (const Scene* s : {&scene, &again})
    for (const auto& [frame, picture] : {std::pair(1, 5), {0, 1}}) {
      ASSERT_TRUE(s->frames[std::size_t(frame)].ofVideo);
      const Outcome<Image> image = readPhotograph(s->frames[std::size_t(frame)]);
      ASSERT_TRUE(image) << image.failure().detail;
      EXPECT_EQ(image->channels, 3);
      EXPECT_NEAR(image->data[0], greyOf(picture) / 255.0, kGreyOff);
    }
}

TEST(PosedScene, SessionKeepsThePoses) {
  Folder folder;
  folder.write("frames/0.04.png", pngOfSize(64, 48));
  folder.write("frames/0.20.png", pngOfSize(64, 48));
  folder.options.choices.posesByOrder = true;
  const Scene scene = readScene(folder / "frames", folder.options);
  EXPECT_EQ(scene.choices.as, "images");
  EXPECT_THAT(scene.sources, Contains(folder.poses));
  Session session;
  session.input = scene.file;
  session.choices = scene.choices;
  session.request.models = {"limit-angle"};
  session.request.train = "0";
  writeSession(session, folder / "run.glint");
  EXPECT_THAT(contentOf(folder / "run.glint"), HasSubstr("\"poses\": \"poses.txt\""));
  const Session read = readSession(folder / "run.glint");
  EXPECT_EQ(read.choices, scene.choices);
  const Scene again = readScene(folder / "run.glint");
  EXPECT_EQ(again.kind, "images");
  ASSERT_EQ(again.frames.size(), 2u);
  // A session from others may not look into a file anywhere.
  const TemporaryFolder elsewhere;
  session.choices.poses = elsewhere.write("poses.txt", contentOf(folder.poses));
  writeSession(session, folder / "run.glint");
  EXPECT_THAT(inputErrorOf([&] { readScene(folder / "run.glint"); }), HasSubstr("input.reading.poses"));
}

TEST(PosedScene, CloudIsASurfaceAndStaysOneInASceneFile) {
  Folder folder;
  folder.write("frames/0.04.png", pngOfSize(64, 48));
  folder.options.choices.surfaceMetresPerUnit = 10;
  const Scene scene = readScene(folder / "frames", folder.options);
  EXPECT_EQ(scene.surfaces.begin()->second.kind(), "points");
  EXPECT_TRUE(std::get_if<PointsFile>(&scene.surfaces.begin()->second));
  writeScene(scene, folder / "out.json");
  EXPECT_THAT(contentOf(folder / "out.json"), HasSubstr("\"points\": \"cloud.ply\""));
  for (const Scene& s : {scene, readScene(folder / "out.json")}) {
    const auto surface = SurfaceCache(s).surfaceOf(0, {});
    ASSERT_TRUE(surface) << surface.failure().message();
    const Outcome<SurfacePoint> hit = (*surface)->firstHit({Eigen::Vector3d(0.5, 0.3, -2), Eigen::Vector3d::UnitZ()});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->position.z(), 0, 1e-9);
    EXPECT_FALSE((*surface)->firstHit({Eigen::Vector3d(1.7, 0, -2), Eigen::Vector3d::UnitZ()})) << "beyond the points";
  }
}

TEST(PosedScene, SparsePointsAreASurfaceOnlyWhenAskedForAndEnough) {
  const TemporaryFolder folder;
  folder.write("sparse/0/cameras.txt", "1 PINHOLE 64 48 80 80 32 24\n");
  folder.write("sparse/0/images.txt", "1 1 0 0 0 0 0 2 1 a.png\n32 24 1\n2 1 0 0 0 0 0 3 1 b.png\n32 24 1\n");
  folder.write("sparse/0/points3D.txt", "1 0 0 0 0 0 0 0.5 1 0 2 0\n");
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.path()); }), HasSubstr("--surface FILE"));
  ReadOptions options;
  options.choices.surface = InputChoices::Surface::Points;
  const Scene scene = readScene(folder.path(), options);
  ASSERT_TRUE(std::get_if<CapturePoints>(&scene.surfaces.begin()->second));
  EXPECT_EQ(scene.surfaces.begin()->second.triangles().mesh.vertices.size(), 1u);
  const auto surface = SurfaceCache(scene).surfaceOf(0, {});
  ASSERT_FALSE(surface);
  EXPECT_EQ(surface.failure().reason, Reason::TooFewPoints);
  EXPECT_THAT(inputErrorOf([&] { writeScene(scene, folder / "out.json"); }), HasSubstr("sparse points of a capture"));
}

/// Two cameras that look along z, and side x side points of the plane z = 0, 1 cm apart, as COLMAP writes what they saw.
void writeColmapOfSquare(const TemporaryFolder& folder, int side) {
  std::ostringstream points, seen[2];
  for (int i = 0; i < side * side; ++i) {
    const double x = 0.01 * (i % side), y = 0.01 * (i / side);
    points << i + 1 << ' ' << x << ' ' << y << " 0 0 0 0 0.5 1 " << i << " 2 " << i << '\n';
    for (int camera : {0, 1})
      seen[camera] << 32 + 80 * x / (camera + 2) << ' ' << 24 + 80 * y / (camera + 2) << ' ' << i + 1 << ' ';
  }
  folder.write("sparse/0/cameras.txt", "1 PINHOLE 64 48 80 80 32 24\n");
  folder.write("sparse/0/images.txt",
               "1 1 0 0 0 0 0 2 1 a.png\n" + seen[0].str() + "\n2 1 0 0 0 0 0 3 1 b.png\n" + seen[1].str() + "\n");
  folder.write("sparse/0/points3D.txt", points.str());
}

std::vector<std::string> findingsOf(const TemporaryFolder& folder, const ReadOptions& options) {
  return conventionReport(readScene(folder.path(), options)).findings;
}

TEST(PosedScene, TooFewSparsePointsAreNamedOnceAndNoMeshIsBlamed) {
  const TemporaryFolder folder;
  writeColmapOfSquare(folder, 6);
  ReadOptions options;
  options.choices.surface = InputChoices::Surface::Points;
  const std::vector<std::string> findings = findingsOf(folder, options);
  EXPECT_THAT(findings, Contains(AllOf(HasSubstr("no surface can be made of the points"), HasSubstr("there are 36"))));
  EXPECT_THAT(findings, Not(Contains(HasSubstr("sparse points"))));
}

TEST(PosedScene, NoSparsePointIsAnotherAnswerThanTooFew) {
  const TemporaryFolder folder;
  writeColmapOfSquare(folder, 6);
  folder.write("sparse/0/images.txt", "1 1 0 0 0 0 0 2 1 a.png\n\n2 1 0 0 0 0 0 3 1 b.png\n\n");
  folder.write("sparse/0/points3D.txt", "");
  ReadOptions options;
  options.choices.surface = InputChoices::Surface::Points;
  EXPECT_THAT(inputErrorOf([&] { findingsOf(folder, options); }), HasSubstr("it has no sparse points"));
}

TEST(PosedScene, EnoughSparsePointsAreASurfaceThatTheyDoNotContradict) {
  const TemporaryFolder folder;
  writeColmapOfSquare(folder, 12);
  ReadOptions options;
  options.choices.surface = InputChoices::Surface::Points;
  EXPECT_THAT(findingsOf(folder, options), Not(Contains(AnyOf(HasSubstr("sparse points"), HasSubstr("no surface")))));
}

TEST(PosedScene, AMeshThatNoSparsePointMeetsIsAskedAbout) {
  const TemporaryFolder folder;
  writeColmapOfSquare(folder, 6);
  ReadOptions options;
  options.choices.surface = InputChoices::Surface::File;
  options.choices.surfaceFile = folder.write("mesh.obj", "v 100 0 0\nv 101 0 0\nv 100 1 0\nf 1 2 3\n");
  EXPECT_THAT(findingsOf(folder, options),
              Contains(HasSubstr("none of 36 sparse points of the capture is seen before or on the surface (is the mesh")));
}

}  // namespace
}  // namespace glint::posed_scene_tests

// SPDX-License-Identifier: BSD-3-Clause
// From a capture of another program to a scene: which reading, which surface, units, names, and what a session keeps of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/app/session.h"
#include "core/scene/relinked.h"
#include "core/scene/scene_files.h"
#include "core/scene/scene_reader.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::inputErrorOf;
using testing_support::minimalScene;
using testing_support::TemporaryFolder;
using testing_support::with;

constexpr double kRoundOff = 1e-12;  // of numbers of order one

const char* const kTriangle =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n100 0 0\n0 100 0\n3 0 1 2\n";
const char* const kCloud =
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\nend_header\n0 0 0\n";

/// Two photographs of one camera, 2 and 3 units in front of the origin.
void writeColmap(const TemporaryFolder& folder, const std::string& first = "a.png", const std::string& second = "b.png") {
  folder.write("sparse/0/cameras.txt", "1 PINHOLE 64 48 80 80 32 24\n");
  folder.write("sparse/0/images.txt", "1 1 0 0 0 0 0 3 1 " + second + "\n\n" + "2 1 0 0 0 0 0 2 1 " + first + "\n\n");
  folder.write("sparse/0/points3D.txt", "");
}

TEST(CaptureScene, OneMeshInTheFolderIsTheSurfaceAndTheNamesAreTheIds) {
  TemporaryFolder folder;
  writeColmap(folder);
  folder.write("object.ply", kTriangle);
  folder.write("points.ply", kCloud);
  const Scene scene = readScene(folder.path());
  EXPECT_EQ(scene.kind, "colmap");
  ASSERT_EQ(scene.frames.size(), 2u);
  EXPECT_EQ(scene.frames[0].id, "a");
  EXPECT_EQ(scene.frames[1].id, "b");
  // K and pose by hand: the corner of the first pixel is (0, 0) there, its centre here.
  EXPECT_EQ(scene.frames[0].camera.pixelFromRay(0, 2), 31.5);
  EXPECT_EQ(scene.frames[0].camera.camFromWorld.translation().z(), 2);
  ASSERT_EQ(scene.surfaces.size(), 1u);
  EXPECT_EQ(scene.surfaces.begin()->second.file()->file, folder / "object.ply");
}

TEST(CaptureScene, SeveralMeshesAreListedAndRefused) {
  TemporaryFolder folder;
  writeColmap(folder);
  folder.write("one.ply", kTriangle);
  folder.write("two.ply", kTriangle);
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.path()); }),
              testing::AllOf(HasSubstr("one.ply, two.ply"), HasSubstr("--surface FILE")));
  folder.write("mesh.ply", kTriangle);
  EXPECT_EQ(readScene(folder.path()).surfaces.begin()->second.file()->file, folder / "mesh.ply") << "mesh.* comes first";
}

TEST(CaptureScene, WithoutSurfaceSaysHowToNameOne) {
  TemporaryFolder folder;
  writeColmap(folder);
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.path()); }), HasSubstr("--surface FILE"));
  ReadOptions options;
  options.choices.surface = InputChoices::Surface::Depth;
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.path(), options); }), HasSubstr("no frame has a depth map"));
}

TEST(CaptureScene, UnitsScalePosesAndMesh) {
  TemporaryFolder folder, elsewhere;
  writeColmap(folder);
  ReadOptions options;
  options.choices.surface = InputChoices::Surface::File;
  options.choices.surfaceFile = elsewhere.write("object.ply", kTriangle);
  options.choices.metresPerUnit = 0.01;
  options.choices.surfaceMetresPerUnit = 0.001;
  const Scene scene = readScene(folder.path(), options);
  EXPECT_NEAR(scene.frames[0].camera.camFromWorld.translation().z(), 0.02, kRoundOff);
  EXPECT_NEAR(scene.surfaces.begin()->second.triangles().mesh.vertices[1].x(), 0.1, kRoundOff);
  options.choices.surfaceMetresPerUnit.reset();  // as the poses
  EXPECT_NEAR(readScene(folder.path(), options).surfaces.begin()->second.triangles().mesh.vertices[1].x(), 1.0, kRoundOff);
}

TEST(CaptureScene, UnitOfTheMeshIsKeptInASceneFile) {
  TemporaryFolder folder;
  writeColmap(folder);
  folder.write("object.ply", kTriangle);
  ReadOptions options;
  options.choices.surfaceMetresPerUnit = 0.001;
  writeScene(readScene(folder.path(), options), folder / "out.json");
  const Scene again = readScene(folder / "out.json");
  EXPECT_NEAR(again.surfaces.begin()->second.triangles().mesh.vertices[1].x(), 0.1, kRoundOff);
  EXPECT_THAT(testing_support::contentOf(folder / "out.json"), HasSubstr("\"units\": \"mm\""));
}

TEST(CaptureScene, RepeatedNamesGetTheirFolder) {
  TemporaryFolder folder;
  writeColmap(folder, "left/1.png", "right/1.png");
  folder.write("object.ply", kTriangle);
  const Scene scene = readScene(folder.path());
  EXPECT_EQ(scene.frames[0].id, "left/1");
  EXPECT_EQ(scene.frames[1].id, "right/1");
}

TEST(CaptureScene, SceneFileOfTheFolderAlwaysWins) {
  TemporaryFolder folder;
  writeColmap(folder);
  folder.write("scene.json", minimalScene());
  EXPECT_EQ(readScene(folder.path()).kind, "scene");
  ReadOptions options;
  options.choices.as = "colmap";
  folder.write("object.ply", kTriangle);
  EXPECT_EQ(readScene(folder.path(), options).kind, "colmap");
}

TEST(CaptureScene, TwoReadingsAreListedAndRefused) {
  TemporaryFolder folder;
  writeColmap(folder);
  folder.write("other.json", minimalScene());
  try {
    readScene(folder.path());
    FAIL() << "not refused";
  } catch (const UndecidedInput& e) {
    ASSERT_EQ(e.answers().size(), 2u);
    EXPECT_EQ(e.answers()[0].value, "scene");
    EXPECT_EQ(e.answers()[1].value, "colmap");
    EXPECT_STREQ(e.option(), "--as");
    EXPECT_THAT(e.what(), HasSubstr("--as scene, --as colmap"));
  }
  ReadOptions options;
  options.choices.as = "scene";
  EXPECT_EQ(readScene(folder.path(), options).kind, "scene");
  EXPECT_EQ(readScene(folder / "other.json").kind, "scene") << "the file itself is unambiguous";
  options.choices.as = "nvm";
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.path(), options); }), HasSubstr("contains no"));
  options.choices.as = "colnap";
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.path(), options); }), HasSubstr("is not one of: scene, colmap"));
}

TEST(CaptureScene, SceneFileRefusesWhatIsForCaptures) {
  TemporaryFolder folder;
  ReadOptions options;
  options.choices.metresPerUnit = 0.001;
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.write("scene.json", minimalScene()), options); }),
              HasSubstr("says everything itself"));
}

TEST(CaptureScene, SessionKeepsHowItsInputIsRead) {
  TemporaryFolder folder;
  writeColmap(folder);
  folder.write("one.ply", kTriangle);
  folder.write("two.ply", kTriangle);
  ReadOptions options;
  options.choices.surface = InputChoices::Surface::File;
  options.choices.surfaceFile = folder / "two.ply";
  options.choices.metresPerUnit = 0.01;
  const Scene scene = readScene(folder.path(), options);
  Session session;
  session.input = scene.file;
  session.choices = scene.choices;
  session.files = hashInputs(scene, {});
  writeSession(session, folder / "x.glint");
  const OpenedSession opened = openSession(folder / "x.glint");
  EXPECT_EQ(opened.scene->choices, scene.choices);
  EXPECT_EQ(opened.scene->surfaces.begin()->second.file()->file, folder / "two.ply");
  EXPECT_NEAR(opened.scene->frames[0].camera.camFromWorld.translation().z(), 0.02, kRoundOff);
  // Every file that says what the capture is belongs to the inputs: a change of one is seen.
  EXPECT_THAT(changedFiles(opened.session), ElementsAre());
  folder.write("sparse/0/images.txt", "1 1 0 0 0 0 0 4 1 b.png\n\n");
  EXPECT_THAT(changedFiles(opened.session), ElementsAre(HasSubstr("images.txt: changed")));
}

TEST(CaptureScene, SessionWithoutReadingStaysAtVersion3) {
  TemporaryFolder folder;
  Session session;
  session.input = folder.write("scene.json", minimalScene());
  EXPECT_THAT(sessionText(session, folder / "x.glint"), HasSubstr("\"glint_session\": 3"));
  session.choices.object = "5";
  EXPECT_THAT(sessionText(session, folder / "x.glint"), HasSubstr("\"glint_session\": 4"));
}

TEST(CaptureScene, MeshThatMovedIsFoundWhereItWasRelinked) {
  TemporaryFolder folder, elsewhere;
  writeColmap(folder);
  ReadOptions options;
  options.choices.surface = InputChoices::Surface::File;
  options.choices.surfaceFile = folder / "gone.ply";
  EXPECT_THROW(readScene(folder.path(), options), MissingMesh);
  options.meshes["gone.ply"] = elsewhere.write("found.ply", kTriangle);
  const Scene scene = readScene(folder.path(), options);
  EXPECT_EQ(scene.surfaces.begin()->second.file()->file, elsewhere / "found.ply");
  EXPECT_EQ(scene.meshes.at("gone.ply"), elsewhere / "found.ply");
}

/// Reads, and gives the folder that a person would have to allow; "" = nothing is refused.
std::filesystem::path refusedFolder(const std::filesystem::path& input, const ReadOptions& options = {}) {
  try {
    readScene(input, options);
  } catch (const OutsidePath& e) {
    return e.folder();
  }
  return {};
}

TEST(CaptureScene, LinksThatLeaveTheCaptureAreRefusedLikeNamesThatDo) {
  for (const char* link : {"images", "images/a.png", "mesh.ply", "sparse/0/points3D.txt"}) {
    SCOPED_TRACE(link);
    TemporaryFolder folder, elsewhere;
    writeColmap(folder);
    folder.write("mesh.ply", kTriangle);
    folder.write("images/a.png", "a");
    folder.write("images/b.png", "b");
    EXPECT_EQ(refusedFolder(folder.path()), "");
    std::filesystem::rename(folder / link, elsewhere / "there");
    std::filesystem::create_symlink(elsewhere / "there", folder / link);
    const bool isFolder = std::string(link) == "images";
    const std::filesystem::path outside = std::filesystem::canonical(elsewhere.path()) / (isFolder ? "there" : "");
    EXPECT_EQ(refusedFolder(folder.path()) / "", outside / "");
    EXPECT_THAT(inputErrorOf([&] { readScene(folder.path()); }), HasSubstr("--allow-outside accepts it"));
    ReadOptions options;
    options.allowOutsidePaths = true;
    EXPECT_EQ(refusedFolder(folder.path(), options), "");
    options = {};
    options.folders = {elsewhere.path()};  // a person allowed it
    EXPECT_EQ(refusedFolder(folder.path(), options), "");
  }
}

TEST(CaptureScene, WhatAPersonNamesMayBeALink) {
  TemporaryFolder folder, elsewhere;
  writeColmap(folder);
  folder.write("mesh.ply", kTriangle);
  folder.write("images/a.png", "a");
  std::filesystem::create_directory_symlink(folder.path(), elsewhere / "capture");
  EXPECT_EQ(refusedFolder(elsewhere / "capture"), "");
  EXPECT_EQ(refusedFolder(elsewhere / "capture/sparse/0"), "");
  std::filesystem::rename(folder / "sparse/0", elsewhere / "model");
  std::filesystem::create_directory_symlink(elsewhere / "model", folder / "sparse/0");
  EXPECT_EQ(refusedFolder(folder / "sparse/0"), "") << "the model itself";
  // Links inside that stay inside.
  std::filesystem::rename(folder / "images", folder / "photographs");
  std::filesystem::create_directory_symlink("photographs", folder / "images");
  EXPECT_EQ(refusedFolder(folder.path()), "");
  // A mesh that is named, and photographs in a folder that is named, some of them links.
  std::filesystem::rename(folder / "mesh.ply", elsewhere / "mesh.ply");
  std::filesystem::create_symlink(elsewhere / "mesh.ply", folder / "mesh.ply");
  ReadOptions options;
  options.choices.surface = InputChoices::Surface::File;
  options.choices.surfaceFile = folder / "mesh.ply";
  std::filesystem::create_directories(elsewhere / "chosen");
  std::filesystem::create_symlink(elsewhere.write("all/a.png", "a"), elsewhere / "chosen/a.png");
  options.photographs = {elsewhere / "chosen"};
  EXPECT_EQ(refusedFolder(folder.path(), options), "");
}

TEST(CaptureScene, CameraNumbersAreChecked) {
  EXPECT_THAT(cameraNumbers("525,525,319.5,239.5", "--camera"), ElementsAre(525, 525, 319.5, 239.5));
  EXPECT_EQ(cameraNumbers("525,525,319.5,239.5,0.1,0.2,0.3,0.4", "--camera").size(), 8u);
  for (const char* bad :
       {"", "525", "525,525,1,2,3", "525,525,a,2", "525,525,1,", "-1,525,1,2", "nan,1,1,1", "1,1,1,1,1,1,1,1,1,1"})
    EXPECT_NE(inputErrorOf([&] { cameraNumbers(bad, "--camera"); }), "") << bad;
}

TEST(CaptureScene, UnitsHaveNames) {
  EXPECT_EQ(metresOfUnit("cm", "--units"), 0.01);
  EXPECT_THAT(inputErrorOf([] { metresOfUnit("inch", "--units inch"); }), HasSubstr("m, cm, mm"));
  EXPECT_EQ(unitOfMetres(0.001), "mm");
  EXPECT_EQ(unitOfMetres(0.3), "0.3");
  EXPECT_EQ(metresOfUnit("0.3", "--units"), 0.3);
  EXPECT_THAT(inputErrorOf([] { metresOfUnit("-1", "--units -1"); }), HasSubstr("metres per unit"));
}

}  // namespace
}  // namespace glint

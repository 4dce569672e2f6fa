// SPDX-License-Identifier: BSD-3-Clause
// Files by hand: the row format is that of VisualSFM's documentation, which writes a camera as name, focal length, quaternion
// (w first), centre, radial term, 0, and a measurement as image, feature, x, y.
#include <gmock/gmock.h>

#include "core/scene/capture.h"
#include "tests/core/scene/sfm_fixture.h"
#include "tests/shared_data.h"
#include "tests/tolerances.h"

namespace glint::nvm_tests {
namespace {
using namespace testing_support;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

/// Two cameras that look along +z: b.pgm from the origin, a.pgm from (1, 2, -5); one point that both see.
std::string smallNvm() {
  return "NVM_V3\n\n2\n"
         "b.pgm 100 1 0 0 0 0 0 0 0 0\n"
         "a.pgm 80 1 0 0 0 1 2 -5 0 0\n"
         "\n1\n"
         "1 2 5 10 20 30 2 0 7 20 40 1 3 0.5 -0.25\n";
}

struct NvmRead {
  Capture capture;
  std::vector<CaptureTrack> tracks;
};
NvmRead readNvmText(const TemporaryFolder& folder, const std::string& text, const CaptureOptions& options = {}) {
  const auto reader = makeNvmReader();
  const Capture capture = reader->read(folder.write("model.nvm", text), options);
  return {capture, reader->tracks(capture, options)};
}
void writeNvmImages(const TemporaryFolder& folder) {
  writeBlackImage(folder, "b.pgm", 64, 48);
  writeBlackImage(folder, "a.pgm", 33, 20);
}
/// The message for such a file, whose images exist.
std::string nvmErrorOf(const std::string& text) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  return inputErrorOf([&] { readNvmText(folder, text); });
}

TEST(Nvm, ViewsAreOrderedAndThePrincipalPointIsTheMiddleOfEachImage) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const Capture c = readNvmText(folder, smallNvm()).capture;
  EXPECT_EQ(c.kind, "nvm");
  EXPECT_EQ(c.file, folder / "model.nvm");
  EXPECT_EQ(c.folder, folder.path());
  EXPECT_THAT(c.sources, ElementsAre(folder / "model.nvm"));
  EXPECT_FALSE(c.hasScale);
  ASSERT_EQ(c.views.size(), 2u);
  const CaptureView &a = c.views[0], &b = c.views[1];
  EXPECT_EQ(a.name, "a.pgm");
  EXPECT_EQ(a.image, folder / "a.pgm");
  EXPECT_EQ(a.camera.width, 33);
  EXPECT_EQ(a.camera.height, 20);
  EXPECT_EQ(b.name, "b.pgm");
  // 64 x 48 pixels: the middle lies between pixels 31 and 32, and 23 and 24. 33 x 20: at pixel 16, between 9 and 10.
  EXPECT_EQ(b.camera.pixelFromRay, (Eigen::Matrix3d() << 100, 0, 31.5, 0, 100, 23.5, 0, 0, 1).finished());
  EXPECT_EQ(a.camera.pixelFromRay, (Eigen::Matrix3d() << 80, 0, 16, 0, 80, 9.5, 0, 0, 1).finished());
  EXPECT_FALSE(a.camera.hasDistortion());
  EXPECT_THAT(c.warnings, ElementsAre());
  EXPECT_THAT(c.facts, Contains(HasSubstr("2 cameras, 1 points with 2 measurements")));
}

TEST(Nvm, NumbersThatAreNotFiniteCostTheirImage) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const NvmRead read = readNvmText(folder, with(smallNvm(), "b.pgm 100 1 0 0 0", "b.pgm 100 nan 0 0 0"));
  ASSERT_EQ(read.capture.views.size(), 1u);
  EXPECT_EQ(read.capture.views[0].name, "a.pgm");
  EXPECT_THAT(read.capture.warnings, Contains(HasSubstr("model.nvm: line 4: no finite pose")));
  ASSERT_EQ(read.tracks.size(), 1u);
  EXPECT_EQ(read.tracks[0].seen.size(), 1u);  // where a.pgm saw it
}

TEST(Nvm, ALineThatIsCutCostsItsImage) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const NvmRead read = readNvmText(folder, with(smallNvm(), "b.pgm 100 1 0 0 0", "b.pgm 100 1 0\n#"));
  ASSERT_EQ(read.capture.views.size(), 1u);
  EXPECT_EQ(read.capture.views[0].name, "a.pgm");
  EXPECT_THAT(read.capture.warnings,
              Contains(HasSubstr(
                  "model.nvm: line 4: a camera needs a name and 10 numbers, has 4 entries (a cut line?); it is left out")));
  ASSERT_EQ(read.tracks.size(), 1u);
  EXPECT_EQ(read.tracks[0].seen.size(), 1u);  // where a.pgm saw it
}

TEST(Nvm, TheFileHasTheCentreOfTheCamera) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const Capture c = readNvmText(folder, smallNvm()).capture;
  EXPECT_EQ(c.views[0].camera.centreInWorld(), Eigen::Vector3d(1, 2, -5));
  // From (1, 2, -5), the point (1.5, 1, -3) lies at (0.5, -1, 2): right and above, 2 away.
  const std::optional<Pixel> pixel = c.views[0].camera.project({1.5, 1, -3});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 16 + 80 * 0.25, tolerance::kExact);
  EXPECT_NEAR(pixel->y(), 9.5 - 80 * 0.5, tolerance::kExact);
}

TEST(Nvm, TheQuaternionHasWFirstAndTurnsTheWorldIntoTheCamera) {
  // cos 30 deg, and sin 30 deg on z: by 60 degrees about z, which takes x to (1/2, sqrt(3)/2, 0) and y to (-sqrt(3)/2, 1/2, 0).
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const Capture c =
      readNvmText(folder, with(smallNvm(), "b.pgm 100 1 0 0 0 0 0 0", "b.pgm 100 0.86602540378443865 0 0 0.5 10 20 30")).capture;
  const Camera& b = viewNamed(c, "b.pgm").camera;
  const Eigen::Vector3d seen = b.camFromWorld * Eigen::Vector3d(11, 20, 32);  // 1 to the right of the centre, 2 in front
  EXPECT_NEAR(seen.x(), 0.5, 1e-14);
  EXPECT_NEAR(seen.y(), std::sqrt(3) / 2, 1e-14);
  EXPECT_NEAR(seen.z(), 2, 1e-14);
  EXPECT_NEAR((b.centreInWorld() - Eigen::Vector3d(10, 20, 30)).norm(), 0, 1e-14);
  EXPECT_THAT(c.warnings, ElementsAre());
}

TEST(Nvm, MeasurementsAreFromThePrincipalPointYDown) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const NvmRead read = readNvmText(folder, smallNvm());
  ASSERT_EQ(read.tracks.size(), 1u);
  EXPECT_EQ(read.tracks[0].point, Eigen::Vector3d(1, 2, 5));
  ASSERT_EQ(read.tracks[0].seen.size(), 2u);
  // Camera 0 of the file is b.pgm, which is view 1.
  EXPECT_EQ(read.tracks[0].seen[0].view, 1);
  EXPECT_EQ(read.tracks[0].seen[0].measured, Pixel(31.5 + 20, 23.5 + 40));
  EXPECT_EQ(read.tracks[0].seen[1].view, 0);
  EXPECT_EQ(read.tracks[0].seen[1].measured, Pixel(16 + 0.5, 9.5 - 0.25));
  // (1, 2, 5) from the origin: 100 / 5 = 20 right, 40 down, which is what the file has measured.
  EXPECT_NEAR((*read.capture.views[1].camera.project(read.tracks[0].point) - Pixel(51.5, 63.5)).norm(), 0, tolerance::kExact);
}

TEST(Nvm, TheRadialTermUndistortsOnNormalisedCoordinates) {
  // A measurement 20 px off at f = 100 is u = 0.2; x = u (1 + r u^2) with r = 0.5 is 0.2 * 1.02 = 0.204, 20.4 px. The term is the
  // normalised one: that of Wu's multicore bundle adjustment for pixels is r / f^2.
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const Capture c = readNvmText(folder, with(smallNvm(), "b.pgm 100 1 0 0 0 0 0 0 0", "b.pgm 100 1 0 0 0 0 0 0 0.5")).capture;
  const Camera& b = viewNamed(c, "b.pgm").camera;
  EXPECT_EQ(b.lens.model, LensModel::VisualSfm);
  EXPECT_EQ(b.lens.parameters, (std::array<double, 8>{0.5}));
  EXPECT_FALSE(viewNamed(c, "a.pgm").camera.hasDistortion());
  const Pixel ideal = b.undistorted({31.5 + 20, 23.5});
  EXPECT_NEAR(ideal.x(), 31.5 + 20.4, 1e-9);
  EXPECT_NEAR(ideal.y(), 23.5, 1e-9);
  // 3, 4, 5: u = 0.25 along (0.6, 0.8); 1 + 0.5 / 16 = 1.03125.
  const Pixel slanted = b.undistorted({31.5 + 15, 23.5 + 20});
  EXPECT_NEAR(slanted.x(), 31.5 + 15 * 1.03125, 1e-9);
  EXPECT_NEAR(slanted.y(), 23.5 + 20 * 1.03125, 1e-9);
  EXPECT_THAT(c.facts, Contains(HasSubstr("1 images with VisualSFM's term")));
}

TEST(Nvm, AFixedCalibrationHoldsForAllImages) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  // VisualSFM's order is fx cx fy cy, from the image's corner.
  const NvmRead read = readNvmText(folder, with(smallNvm(), "NVM_V3\n", "NVM_V3 FixedK 90 30 95 25 -0.1\n"));
  for (const CaptureView& view : read.capture.views) {
    EXPECT_EQ(view.camera.pixelFromRay, (Eigen::Matrix3d() << 90, 0, 29.5, 0, 95, 24.5, 0, 0, 1).finished());
    EXPECT_EQ(view.camera.lens.model, LensModel::VisualSfm);
    EXPECT_EQ(view.camera.lens.parameters[0], -0.1);
  }
  EXPECT_EQ(read.tracks.at(0).seen.at(0).measured, Pixel(29.5 + 20, 24.5 + 40));
  EXPECT_THAT(read.capture.facts, Contains(HasSubstr("FixedK holds for all images")));
}

TEST(Nvm, AFixedCalibrationWithoutATermLeavesThatOfTheCameras) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  for (const char* line : {"NVM_V3 FixedK 90 30 95 25\n", "NVM_V3\nFixedK 90 30 95 25 0\n"}) {
    const std::string text = with(with(smallNvm(), "NVM_V3\n", line), "b.pgm 100 1 0 0 0 0 0 0 0", "b.pgm 100 1 0 0 0 0 0 0 0.5");
    const Capture c = readNvmText(folder, text).capture;
    EXPECT_EQ(viewNamed(c, "b.pgm").camera.pixelFromRay(0, 0), 90) << line;
    EXPECT_EQ(viewNamed(c, "b.pgm").camera.lens.parameters[0], 0.5) << line;
    EXPECT_FALSE(viewNamed(c, "a.pgm").camera.hasDistortion()) << line;
  }
}

TEST(Nvm, BlanksInNamesAreQuotationMarksAndFoldersMayEndWithABackslash) {
  const TemporaryFolder folder;
  writeBlackImage(folder, "left side/my photo.pgm", 64, 48);
  writeBlackImage(folder, "two  blanks.pgm", 64, 48);
  std::string text = with(smallNvm(), "b.pgm", "left\"side\\my\"photo.pgm");
  text = with(text, "a.pgm", "two  blanks.pgm");  // as COLMAP writes them
  const Capture c = readNvmText(folder, text).capture;
  EXPECT_EQ(viewNamed(c, "left side/my photo.pgm").image, folder / "left side/my photo.pgm");
  EXPECT_EQ(viewNamed(c, "two  blanks.pgm").image, folder / "two  blanks.pgm");
}

TEST(Nvm, WhatFollowsTheFirstModelIsNamedAndLeftOut) {
  const std::string second = "\n1\nc.pgm 70 1 0 0 0 0 0 0 0 0\n1\n0 0 1 1 1 1 0\n";
  const std::string unposed = "\n3\nx.pgm 0 1 0 0 0 0 0 0 0 0\ny.pgm 0 1 0 0 0 0 0 0 0 0\nz.pgm 0 1 0 0 0 0 0 0 0 0\n0\n";
  const std::string meshes = "\n0\n#the last part names the meshes\n1 0\n";
  const TemporaryFolder folder;
  writeNvmImages(folder);
  EXPECT_THAT(readNvmText(folder, smallNvm() + meshes).capture.warnings, ElementsAre());
  EXPECT_THAT(readNvmText(folder, smallNvm() + second + second + meshes).capture.warnings,
              ElementsAre("the file holds 2 further models with 2 cameras: only the first is read"));
  const NvmRead all = readNvmText(folder, smallNvm() + second + unposed + meshes);
  EXPECT_THAT(all.capture.warnings, ElementsAre("the file holds 1 further model with 1 cameras: only the first is read",
                                                "3 images have no pose and are left out"));
  EXPECT_EQ(all.capture.views.size(), 2u);
  EXPECT_EQ(all.tracks.size(), 1u);
  // A damaged end is not needed.
  EXPECT_THAT(readNvmText(folder, smallNvm() + "5\nc.pgm 70").capture.warnings, ElementsAre());
  EXPECT_THAT(readNvmText(folder, smallNvm() + "9223372036854775807\n").capture.warnings, ElementsAre());
}

TEST(Nvm, LineBreaksOfWindowsAndEmptyLinesChangeNothing) {
  std::string windows;
  for (const char c : smallNvm()) windows += c == '\n' ? "\r\n" : std::string(1, c);
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const NvmRead read = readNvmText(folder, with(windows, "2\r\n", " \r\n 2 \r\n\r\n"));
  ASSERT_EQ(read.capture.views.size(), 2u);
  EXPECT_EQ(read.capture.views[1].camera.pixelFromRay(0, 0), 100);
  EXPECT_EQ(read.tracks.at(0).seen.at(1).measured, Pixel(16.5, 9.25));
}

TEST(Nvm, PointsThatNoImageShowsAreLeftOutOfTheTracks) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const NvmRead read = readNvmText(folder, with(smallNvm(), "\n1\n1 2 5", "\n2\n7 8 9 0 0 0 0\n1 2 5"));
  ASSERT_EQ(read.tracks.size(), 1u);
  EXPECT_EQ(read.tracks[0].point, Eigen::Vector3d(1, 2, 5));
}

TEST(Nvm, AModelWithoutPointsIsReadWithAWarning) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const std::string text = smallNvm();
  const NvmRead read = readNvmText(folder, text.substr(0, text.find("\n1\n")) + "0\n");
  EXPECT_EQ(read.capture.views.size(), 2u);
  EXPECT_TRUE(read.tracks.empty());
  EXPECT_THAT(read.capture.warnings, ElementsAre(HasSubstr("no points")));
}

TEST(Nvm, AQuaternionOfAnotherLengthIsNormalisedAndWarnedOfAFewTimes) {
  std::string text = "NVM_V3\n\n12\n";
  const TemporaryFolder folder;
  for (int i = 0; i < 12; ++i) {
    const std::string name = "i" + std::to_string(i) + ".pgm";
    writeBlackImage(folder, name, 4, 4);
    text += name + " 100 0 0 3 0 0 0 1 0 0\n";
  }
  const Capture c = readNvmText(folder, text + "1\n0 0 0 0 0 0 0\n").capture;
  EXPECT_EQ(c.warnings.size(), 9u);
  EXPECT_THAT(c.warnings.front(), HasSubstr("line 4: the quaternion of the rotation has length 3"));
  EXPECT_EQ(c.warnings.back(), "... and 4 more like this");
  // Half a turn about y: from z = 1 it looks back at the origin.
  EXPECT_NEAR(c.views[0].camera.depth(Eigen::Vector3d::Zero()), 1, tolerance::kExact);
}

TEST(Nvm, ImagesAreLookedForInTheFoldersOfPhotographsFirst) {
  const TemporaryFolder folder, photographs;
  writeNvmImages(folder);
  writeBlackImage(photographs, "b.pgm", 100, 50);
  CaptureOptions options;
  options.photographs = {photographs.path()};
  const Capture c = readNvmText(folder, smallNvm(), options).capture;
  EXPECT_EQ(c.views[1].image, photographs / "b.pgm");
  EXPECT_EQ(c.views[1].camera.pixelFromRay(0, 2), 49.5);
  EXPECT_EQ(c.views[0].image, folder / "a.pgm");
}

// As COLMAP 3.8 wrote it: blanks at the ends of lines, a term of -0, and no 0 at the end. Unlike VisualSFM it writes
// measurements from the image's corner.
const char* const kNvmOfColmap =
    "NVM_V3 \n \n3  \n"
    "b/second.pgm 80 0.92338051687663869 0.10259783520851541 -0.30779350562554619 0.20519567041703082 "
    "-2.5968421052631574 0.058947368421052582 -3.0631578947368423 -0 0\n"
    "a/first.pgm 55.5 0.8251369970070348 -0.2062842492517587 0.51571062312939675 0.10314212462587935 "
    "4.6510638297872351 0.92765957446808534 -1.6361702127659563 -0 0\n"
    "c.pgm 80 0.9521925672634175 0.05011539827702198 0.020046159310808789 -0.30069238966213185 "
    "0.51089009443439837 -0.83976290938316267 -4.4208358448864784 -0 0\n"
    "\n3\n"
    "0.25 -0.5 0.5 10 20 30 3 0 2 39.7855 11.1329 1 2 23.8555 28.537 2 2 32.3449 22.3237\n"
    "-0.75 0.5 -0.25 10 20 30 3 0 1 24.0811 26.12 1 1 9.02135 34.7494 2 1 27.793 49.0791\n"
    "0.5 0.25 0.125 10 20 30 3 0 0 40.8121 26.5722 1 0 18.4074 34.3737 2 0 43.3442 31.023\n";

TEST(Nvm, OfColmapProjectsAsTheModelItWasMadeFrom) {
  const TemporaryFolder folder;
  writeSfmImages(folder);
  const NvmRead read = readNvmText(folder, kNvmOfColmap);
  expectSfmProjections(read.capture);
  expectSfmMeasurements(read.capture, read.tracks);
  EXPECT_THAT(read.capture.facts, Contains(HasSubstr("from the image's corner, as COLMAP")));
  EXPECT_THAT(read.capture.warnings, ElementsAre());
}

TEST(Nvm, TheDistortionOfColmapIsKnownToBeRough) {
  // COLMAP writes its k, which distorts, as -k.
  const TemporaryFolder folder;
  writeSfmImages(folder);
  const NvmRead read = readNvmText(folder, with(kNvmOfColmap, "-0 0\n", "0.1 0\n"));
  EXPECT_THAT(read.capture.warnings, ElementsAre(HasSubstr("better read the COLMAP model")));
  EXPECT_EQ(viewNamed(read.capture, "b/second.pgm").camera.lens.parameters[0], 0.1);
}

TEST(Nvm, IsRecognisedByItsFirstLine) {
  const auto reader = makeNvmReader();
  const TemporaryFolder folder;
  EXPECT_EQ(reader->recognise(folder.path()), fs::path());
  EXPECT_EQ(reader->recognise(folder.write("anything.txt", smallNvm())), folder / "anything.txt");
  EXPECT_EQ(reader->recognise(folder.write("c.nvm", "# NVM_V3\n2\n")), fs::path());
  EXPECT_EQ(reader->recognise(folder.write("empty.nvm", "")), fs::path());
  EXPECT_EQ(reader->recognise(folder / "missing.nvm"), fs::path());
  EXPECT_EQ(reader->recognise(folder.path()), fs::path());  // "anything.txt" has to be named
  folder.write("b.nvm", smallNvm());
  EXPECT_EQ(reader->recognise(folder.path()), folder / "b.nvm");
  EXPECT_EQ(reader->name(), "nvm");
}

TEST(Nvm, OfSeveralInAFolderTheFirstIsTakenAndTheOthersAreNamed) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  folder.write("z.nvm", smallNvm());
  folder.write("b.nvm", smallNvm());
  const auto reader = makeNvmReader();
  const fs::path file = reader->recognise(folder.path());
  EXPECT_EQ(file, folder / "b.nvm");
  EXPECT_THAT(reader->read(file, {}).warnings, ElementsAre("the folder holds other NVM files: 'z.nvm'"));
}

TEST(Nvm, AMissingImageIsAskedFor) {
  const TemporaryFolder folder;
  writeBlackImage(folder, "b.pgm", 64, 48);
  const std::string message = inputErrorOf([&] { readNvmText(folder, smallNvm()); });
  EXPECT_THAT(message, HasSubstr("model.nvm: line 5: "));
  EXPECT_THAT(message, HasSubstr("a.pgm"));
  EXPECT_THAT(message, HasSubstr("--photographs"));
}

TEST(Nvm, ImagesOutsideOfTheFolderNeedPermission) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  writeBlackImage(folder, "outside/o.pgm", 10, 10);
  const auto reader = makeNvmReader();
  const fs::path file = folder.write("inside/model.nvm", "NVM_V3\n1\n../outside/o.pgm 9 1 0 0 0 0 0 0 0 0\n0\n");
  EXPECT_THROW(reader->read(file, {}), OutsidePath);
  CaptureOptions options;
  options.rights.folders = {folder / "outside"};
  EXPECT_EQ(reader->read(file, options).views.at(0).camera.width, 10);
}

struct NvmCase {
  const char* name;
  const char* from;
  const char* to;
  const char* place;
  const char* reason;
};
class BadNvm : public testing::TestWithParam<NvmCase> {};

TEST_P(BadNvm, IsOneLineWithFilePlaceAndReason) {
  const std::string message = nvmErrorOf(with(smallNvm(), GetParam().from, GetParam().to));
  EXPECT_THAT(message, HasSubstr(std::string("model.nvm: ") + GetParam().place)) << GetParam().name;
  EXPECT_THAT(message, HasSubstr(GetParam().reason)) << GetParam().name;
}

INSTANTIATE_TEST_SUITE_P(
    Nvm, BadNvm,
    testing::Values(
        NvmCase{"another version", "NVM_V3", "NVM_V3_R9T", "line 1: ", "'NVM_V3_R9T' is not supported, only NVM_V3 is"},
        NvmCase{"another calibration", "NVM_V3", "NVM_V3 FreeK 1 2 3 4", "line 1: ", "'FreeK' is not supported"},
        NvmCase{"short calibration", "NVM_V3", "NVM_V3 FixedK 1 2 3", "line 1: ", "needs at least 6 entries, has 5"},
        NvmCase{"long calibration", "NVM_V3", "NVM_V3 FixedK 1 2 3 4 5 6", "line 1: ", "more than five"},
        NvmCase{"calibration of words", "NVM_V3", "NVM_V3 FixedK 1 two 3 4", "line 1: ", "'two' is not a number"},
        NvmCase{"calibration without focal length", "NVM_V3", "NVM_V3 FixedK 0 1 1 1",
                "line 4: ", "focal length must be positive"},
        NvmCase{"no count of cameras", "\n2\n", "\n", "line 3: ", "expected the number of cameras"},
        NvmCase{"no cameras", "\n2\n", "\n0\n", "", "holds no cameras"},
        NvmCase{"negative count", "\n2\n", "\n-2\n", "line 3: ", "must not be negative"},
        NvmCase{"more cameras than bytes", "\n2\n", "\n1000000000000\n", "line 3: ", "1000000000000 cameras do not fit"},
        NvmCase{"a count beyond integers", "\n2\n", "\n99999999999999999999\n", "line 3: ", "expected the number of cameras"},
        NvmCase{"one camera too many", "\n2\n", "\n3\n", "line 8: ", "expected the number of points"},
        NvmCase{"two images of one name", "a.pgm", "b.pgm", "", "two images are called 'b.pgm'"},
        NvmCase{"no count of points", "\n1\n", "\n", "line 7: ", "expected the number of points"}));

/// One bad line costs its image or its point, with a warning.
class BadNvmLine : public testing::TestWithParam<NvmCase> {};

TEST_P(BadNvmLine, IsAWarningAndTheRestIsRead) {
  const NvmCase& bad = GetParam();
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const NvmRead whole = readNvmText(folder, smallNvm()), read = readNvmText(folder, with(smallNvm(), bad.from, bad.to));
  EXPECT_THAT(read.capture.warnings,
              Contains(AllOf(HasSubstr(std::string("model.nvm: ") + bad.place), HasSubstr(bad.reason), HasSubstr("left out"))))
      << bad.name;
  const std::string place = bad.place;
  ASSERT_EQ(read.capture.views.size(), place == "line 8: " ? 2u : 1u) << bad.name;
  for (const CaptureView& v : read.capture.views) {
    EXPECT_EQ(v.camera.camFromWorld.matrix(), viewNamed(whole.capture, v.name).camera.camFromWorld.matrix());
    if (place != "line 8: ") EXPECT_EQ(v.name, place == "line 4: " ? "a.pgm" : "b.pgm") << bad.name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Nvm, BadNvmLine,
    testing::Values(
        NvmCase{"camera of another kind", "0 0\na.pgm", "0 1\na.pgm", "line 4: ", "the last entry of a camera must be 0"},
        NvmCase{"no focal length", "b.pgm 100", "b.pgm 0", "line 4: ", "focal length must be positive"},
        NvmCase{"negative focal length", "b.pgm 100", "b.pgm -100", "line 4: ", "focal length must be positive"},
        NvmCase{"focal length too large", "b.pgm 100", "b.pgm 1e300", "line 4: ", "larger than"},
        NvmCase{"no rotation", "100 1 0 0 0", "100 0 0 0 0", "line 4: ", "quaternion of the rotation must not be zero"},
        NvmCase{"centre too far away", "1 2 -5 0 0", "1 1e300 -5 0 0", "line 5: ", "larger than"},
        NvmCase{"term too large", "1 2 -5 0 0", "1 2 -5 1e300 0", "line 5: ", "larger than"},
        NvmCase{"more points than bytes", "\n1\n", "\n5000000\n", "line 8: ", "ends before point 2 of 5000000"},
        NvmCase{"one point too many", "\n1\n", "\n2\n", "line 8: ", "ends before point 2 of 2"},
        NvmCase{"point without count", " 2 0 7 20 40 1 3 0.5 -0.25", "", "line 8: ", "needs at least 7 entries, has 6"},
        NvmCase{"point of words", "1 2 5 10", "1 x 5 10", "line 8: ", "'x' is not a number"},
        NvmCase{"point too far away", "1 2 5 10", "1 2 1e300 10", "line 8: ", "larger than"},
        NvmCase{"measurements too few", "30 2 0", "30 3 0",
                "line 8: ", "states 3 measurements of 4 entries, but 8 entries follow"},
        NvmCase{"measurements beyond memory", "30 2 0", "30 4611686018427387904 0", "line 8: ", "measurements of 4 entries"},
        NvmCase{"negative measurements", "30 2 0", "30 -1 0", "line 8: ", "states -1 measurements"},
        NvmCase{"measurement cut off", " -0.25", "", "line 8: ", "but 7 entries follow"},
        NvmCase{"measured by nobody", "1 3 0.5", "2 3 0.5", "line 8: ", "there is no camera 2, only 0 .. 1"},
        NvmCase{"measured by less than nobody", "1 3 0.5", "-1 3 0.5", "line 8: ", "there is no camera -1"},
        NvmCase{"measured by half a camera", "1 3 0.5", "0.5 3 0.5", "line 8: ", "'0.5' is not a whole number"},
        NvmCase{"measurement too far away", "1 3 0.5", "1 3 1e30", "line 8: ", "larger than"},
        NvmCase{"cut camera", "b.pgm 100 1 0 0 0", "b.pgm 100 1 0\n#",
                "line 4: ", "a camera needs a name and 10 numbers, has 4 entries"}));

TEST(Nvm, EveryBeginningOfAFileIsReadOrRefused) {
  const TemporaryFolder folder;
  writeNvmImages(folder);
  const std::string text = with(smallNvm(), "NVM_V3\n", "NVM_V3 FixedK 90 30 95 25 -0.1\n");
  const auto reader = makeNvmReader();
  for (std::size_t n = 0; n < text.size(); ++n) {
    const fs::path file = folder.write("cut.nvm", text.substr(0, n));
    try {
      const Capture c = reader->read(file, {});
      EXPECT_FALSE(c.views.empty()) << n;
      EXPECT_TRUE(c.views[0].camera.pixelFromRay.allFinite());
    } catch (const InputError& e) {
      EXPECT_EQ(e.file(), file.string()) << n;
    }
  }
}

}  // namespace
}  // namespace glint::nvm_tests

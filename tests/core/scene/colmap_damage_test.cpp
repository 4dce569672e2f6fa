// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <random>

#include "tests/core/scene/colmap_fixture.h"
#include "tests/tolerances.h"

// Files of COLMAP that are damaged, degenerate or hostile, and the redundant ones of newer versions.

namespace glint::colmap_damage_tests {
namespace {
using namespace testing_support;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

// One thing wrong with the model of the fixture.
struct ColmapBadTextRow {
  const char* name;
  const char* file;
  const char* from;
  const char* to;
  const char* place;
  const char* reason;
};
class ColmapBadText : public testing::TestWithParam<ColmapBadTextRow> {};

TEST_P(ColmapBadText, IsOneLineWithFilePlaceAndReason) {
  const ColmapBadTextRow& bad = GetParam();
  const TemporaryFolder folder;
  writeColmap(folder);
  const fs::path file = folder / bad.file;
  folder.write(bad.file, with(contentOf(file), bad.from, bad.to));
  const std::string message = inputErrorOf([&] { kColmapReader->read(folder / "cameras.txt", {}); });
  EXPECT_THAT(message, HasSubstr(file.string() + ": " + bad.place)) << bad.name;
  EXPECT_THAT(message, HasSubstr(bad.reason)) << bad.name;
}

INSTANTIATE_TEST_SUITE_P(
    Cameras, ColmapBadText,
    testing::Values(
        ColmapBadTextRow{"none", "cameras.txt", "7 PINHOLE", "# 7 PINHOLE", "", "contains no camera"},
        ColmapBadTextRow{"short", "cameras.txt", "7 PINHOLE 640 480 500 510 320 240", "7 PINHOLE 640",
                         "line 3: ", "CAMERA_ID, MODEL"},
        ColmapBadTextRow{"a parameter too few", "cameras.txt", " 320 240", " 320",
                         "line 3: ", "PINHOLE has 4 parameters, the line has 3"},
        ColmapBadTextRow{"a parameter too many", "cameras.txt", " 320 240", " 320 240 0",
                         "line 3: ", "has 4 parameters, the line has 5"},
        ColmapBadTextRow{"no number", "cameras.txt", "510", "51O", "line 3: ", "'51O' is not a number"},
        ColmapBadTextRow{"not a number", "cameras.txt", "510", "nan", "line 3: ", "'nan' is not a number"},
        ColmapBadTextRow{"infinite", "cameras.txt", "510", "1e999", "line 3: ", "'1e999' is not a number"},
        ColmapBadTextRow{"negative focal length", "cameras.txt", "510", "-510", "line 3: ", "the focal length must be positive"},
        ColmapBadTextRow{"no focal length", "cameras.txt", "500", "0", "line 3: ", "the focal length must be positive"},
        ColmapBadTextRow{"negative width", "cameras.txt", "640", "-640", "line 3: ", "'-640' is not a whole number"},
        ColmapBadTextRow{"no width", "cameras.txt", "640", "0", "line 3: ", "0 x 480 pixels"},
        ColmapBadTextRow{"huge width", "cameras.txt", "640", "4000000000", "line 3: ", "2147483647 x 480 pixels"},
        ColmapBadTextRow{"far centre", "cameras.txt", "320", "1e12", "line 3: ", "larger than"},
        ColmapBadTextRow{"a number of more than 32 bits", "cameras.txt", "7 PINHOLE", "4294967296 PINHOLE",
                         "line 3: ", "not a whole number"},
        ColmapBadTextRow{"unknown model", "cameras.txt", "PINHOLE", "HOLE", "line 3: ", "camera model 'HOLE' is not supported"},
        ColmapBadTextRow{"unsupported model", "cameras.txt", "PINHOLE", "RAD_TAN_THIN_PRISM_FISHEYE",
                         "line 3: ", "'RAD_TAN_THIN_PRISM_FISHEYE' is not supported"},
        ColmapBadTextRow{"a number twice", "cameras.txt", "7 PIN", "7 PINHOLE 1 1 1 1 1 1\n7 PIN", "",
                         "two cameras have the number 7"}));

INSTANTIATE_TEST_SUITE_P(Images, ColmapBadText,
                         testing::Values(ColmapBadTextRow{"a number twice", "images.txt", "4 1 0 0 0", "41 1 0 0 0", "",
                                                          "two images have the number 41"}));

/// One bad line costs its image, its 2D points or its point, with a warning.
class ColmapBadLine : public testing::TestWithParam<ColmapBadTextRow> {};

TEST_P(ColmapBadLine, IsAWarningAndTheRestIsRead) {
  const ColmapBadTextRow& bad = GetParam();
  const TemporaryFolder folder;
  writeColmap(folder);
  const std::string text = contentOf(folder / bad.file);
  folder.write(bad.file, with(text, bad.from, bad.to));
  const Capture capture = kColmapReader->read(folder / "cameras.txt", {});
  EXPECT_THAT(capture.warnings, Contains(AllOf(HasSubstr(std::string(bad.file) + ": " + bad.place), HasSubstr(bad.reason),
                                               HasSubstr("; it is left out"))))
      << bad.name;
  // The other one of the two images or points is as it was.
  const std::vector<CaptureTrack> tracks = kColmapReader->tracks(capture, {});
  const bool image = std::string(bad.file) == "images.txt", whole = !image || std::string(bad.place) == "line 3: ";
  ASSERT_EQ(capture.views.size(), whole ? 2u : 1u) << bad.name;
  ASSERT_EQ(tracks.size(), image ? 2u : 1u) << bad.name;
  EXPECT_EQ(tracks[0].point, Eigen::Vector3d(1, 2, 3));
  ASSERT_EQ(tracks[0].seen.size(), image ? 1u : 2u) << bad.name;
  const bool first = image && std::string(bad.place) == "line 4: ";  // of the file: b.jpg
  const Pixel expected = first || !image ? Pixel(100, 50) : Pixel(320, 240);
  EXPECT_EQ(tracks[0].seen[0].measured, expected) << bad.name;
}

INSTANTIATE_TEST_SUITE_P(
    Images, ColmapBadLine,
    testing::Values(
        ColmapBadTextRow{"unknown camera", "images.txt", "30 7 b.jpg", "30 8 b.jpg",
                         "line 2: ", "'b.jpg' is of camera 8, which cameras.txt"},
        ColmapBadTextRow{"cut", "images.txt", " 0 0 10 20 30 7 b.jpg", "", "line 2: ", "has 3 entries"},
        ColmapBadTextRow{"overwritten", "images.txt", "41 0.7", "4l 0.7", "line 2: ", "is not a whole number"},
        ColmapBadTextRow{"no name", "images.txt", " b.jpg", "", "line 2: ", "has 9 entries"},
        ColmapBadTextRow{"control character", "images.txt", "b.jpg", "b\x1b[2J.jpg", "line 2: ", "control character"},
        ColmapBadTextRow{"zero quaternion", "images.txt", "4 1 0 0 0 ", "4 0 0 0 0 ", "line 4: ", "must not be zero"},
        ColmapBadTextRow{"far away", "images.txt", "0 0 5 7", "0 0 5e15 7", "line 4: ", "larger than"},
        ColmapBadTextRow{"negative number", "images.txt", "41 0.7", "-41 0.7", "line 2: ", "'-41' is not a whole number"},
        ColmapBadTextRow{"half a 2D point", "images.txt", "100.5 50.5 3", "100.5 50.5", "line 3: ", "has 5 entries"},
        ColmapBadTextRow{"a 2D point of text", "images.txt", "100.5 50.5 3", "100.5 50.5 x",
                         "line 3: ", "2D point 1 is not X, Y, POINT3D_ID"},
        ColmapBadTextRow{"a comment for 2D points", "images.txt", "11.5 22.5", "# 11.5 22.5", "line 3: ", "has 7 entries"}));

INSTANTIATE_TEST_SUITE_P(
    Points, ColmapBadLine,
    testing::Values(
        ColmapBadTextRow{"short", "points3D.txt", "900 -4 5 6 10 20 30 0.5 4 1", "900 -4 5 6 10 20", "line 3: ", "has 6 entries"},
        ColmapBadTextRow{"half an entry", "points3D.txt", "0.5 4 1", "0.5 4", "line 3: ", "has 9 entries"},
        ColmapBadTextRow{"no number", "points3D.txt", "900 -4 5", "900 -4 five", "line 3: ", "'five' is not a number"},
        ColmapBadTextRow{"not a number", "points3D.txt", "900 -4 5", "900 -4 -nan", "line 3: ", "'-nan' is not a number"},
        ColmapBadTextRow{"far away", "points3D.txt", "900 -4 5", "900 -4 5e15", "line 3: ", "larger than"},
        ColmapBadTextRow{"negative index", "points3D.txt", "0.5 4 1", "0.5 4 -1", "line 3: ", "'-1' is not a whole number"}));

TEST(ColmapDamage, ABadCameraCostsItsImages) {
  const TemporaryFolder folder;
  const std::string cameras = std::string(kColmapCameras) + "8 PINHOLE 640 480 500 51";
  writeColmap(folder, "", cameras, with(kColmapImages, "30 7 b.jpg", "30 8 b.jpg"));
  const Capture capture = kColmapReader->read(folder / "cameras.txt", {});
  ASSERT_EQ(capture.views.size(), 1u);
  EXPECT_EQ(capture.views[0].name, "a.jpg");
  EXPECT_THAT(capture.warnings, Contains("cameras.txt: line 4: PINHOLE has 4 parameters, the line has 2; it is left out"));
  EXPECT_THAT(capture.warnings, Contains(HasSubstr("images.txt: line 2: image 'b.jpg' is of camera 8")));
}

// What a full disk leaves: every beginning that still has an image is read.
TEST(ColmapDamage, TextCutAnywhere) {
  const TemporaryFolder folder;
  writeColmap(folder);
  const std::string whole = kColmapImages;
  const std::size_t firstImage = whole.find("b.jpg") + 1;  // a name may end anywhere
  for (std::size_t size = 0; size < whole.size(); ++size) {
    folder.write("images.txt", whole.substr(0, size));
    if (size < firstImage) {
      EXPECT_THAT(inputErrorOf([&] { kColmapReader->read(folder / "cameras.txt", {}); }), HasSubstr("images.txt: ")) << size;
      continue;
    }
    const Capture capture = kColmapReader->read(folder / "cameras.txt", {});
    EXPECT_EQ(capture.views.size(), size > whole.find("a.jpg") ? 2u : 1u) << size;
  }
}

// Without these lines every second image would be lost without a word.
TEST(ColmapDamage, ImagesWithoutTheirSecondLinesAreRefused) {
  for (const char* name : {"b.jpg", "b c.jpg", "b c d.jpg", "IMG copy 3"}) {
    const TemporaryFolder folder;
    const std::string line = std::string(" 1 0 0 0 0 0 5 7 ") + name + "\n";
    writeColmap(folder, "", kColmapCameras, "1 1 0 0 0 0 0 5 7 a.jpg\n2" + line);
    EXPECT_THAT(inputErrorOf([&] { readColmap(folder.path()); }), HasSubstr("images.txt: line 2: ")) << name;
  }
}

TEST(ColmapDamage, TwoImagesOfOneName) {
  const TemporaryFolder folder;
  writeColmap(folder, "", kColmapCameras, with(kColmapImages, "b.jpg", "a.jpg"));
  EXPECT_THAT(inputErrorOf([&] { readColmap(folder.path()); }), HasSubstr("two images are called 'a.jpg'"));
}

TEST(ColmapDamage, APoseThatIsNotFiniteCostsItsImage) {
  const TemporaryFolder folder;
  writeColmap(folder, "", kColmapCameras, with(kColmapImages, "4 1 0 0 0 ", "4 inf 0 0 0 "));
  const Capture capture = kColmapReader->read(folder / "cameras.txt", {});
  ASSERT_EQ(capture.views.size(), 1u);
  EXPECT_EQ(capture.views[0].name, "b.jpg");
  EXPECT_THAT(capture.warnings, Contains(HasSubstr("images.txt: line 4: no finite pose")));
  for (const CaptureTrack& track : kColmapReader->tracks(capture, {}))
    for (const auto& seen : track.seen) EXPECT_EQ(seen.view, 0);
}

TEST(ColmapDamage, AnImageThatIsThereTwiceCountsOnce) {
  const TemporaryFolder folder;
  writeColmap(folder, "", kColmapCameras, std::string(kColmapImages) + kColmapImages);
  const Capture capture = kColmapReader->read(folder / "cameras.txt", {});
  EXPECT_EQ(capture.views.size(), 2u);
  EXPECT_THAT(capture.warnings, Contains(HasSubstr("and 1 more: says the same as a line before")));
}

TEST(ColmapDamage, NoImages) {
  const TemporaryFolder folder;
  writeColmap(folder, "", kColmapCameras, "# Image list\n");
  EXPECT_THAT(inputErrorOf([&] { readColmap(folder.path()); }), HasSubstr("images.txt: contains no image"));
}

// Binary files.

std::string colmapReadError(const TemporaryFolder& folder) {
  return inputErrorOf([&] { kColmapReader->read(folder / "cameras.bin", {}); });
}

TEST(ColmapDamage, BinaryFilesCutAnywhere) {
  const TemporaryFolder folder;
  for (const char* file : {"cameras.bin", "images.bin", "points3D.bin"}) {
    writeColmapBinary(folder);
    const std::string whole = contentOf(folder / file);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      folder.write(file, whole.substr(0, size));
      EXPECT_THAT(colmapReadError(folder), HasSubstr(std::string(file) + ": byte ")) << size;
    }
    folder.write(file, whole + "more");
    EXPECT_THAT(colmapReadError(folder), HasSubstr("byte " + std::to_string(whole.size()) + ": unexpected data")) << file;
    folder.write(file, whole);
  }
}

// A count that the file cannot hold is refused before memory is reserved for it.
TEST(ColmapDamage, CountsBeyondTheFile) {
  struct Row {
    const char* file;
    std::size_t at;
  };
  for (const Row& row : {Row{"cameras.bin", 0}, Row{"images.bin", 0}, Row{"images.bin", 8 + 64 + 6}, Row{"points3D.bin", 0},
                         Row{"points3D.bin", 8 + 43}}) {
    for (const std::uint64_t count : {std::uint64_t(1) << 62, ~std::uint64_t(0), std::uint64_t(100000000)}) {
      const TemporaryFolder folder;
      writeColmapBinary(folder);
      std::string bytes = contentOf(folder / row.file);
      std::memcpy(bytes.data() + row.at, &count, sizeof count);
      folder.write(row.file, bytes);
      EXPECT_THAT(colmapReadError(folder), HasSubstr("byte " + std::to_string(row.at) + ": is truncated: it declares"))
          << row.file;
    }
  }
}

TEST(ColmapDamage, NumbersOfABinaryFile) {
  const auto changed = [](const char* file, std::size_t at, auto value) {
    const TemporaryFolder folder;
    writeColmapBinary(folder);
    std::string bytes = contentOf(folder / file);
    std::memcpy(bytes.data() + at, &value, sizeof value);
    folder.write(file, bytes);
    return colmapReadError(folder);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinite = std::numeric_limits<double>::infinity();
  EXPECT_THAT(changed("cameras.bin", 12, std::int32_t(11)), HasSubstr("RAD_TAN_THIN_PRISM_FISHEYE is not supported"));
  EXPECT_THAT(changed("cameras.bin", 12, std::int32_t(18)), HasSubstr("camera model number 18 is not supported"));
  EXPECT_THAT(changed("cameras.bin", 12, std::int32_t(-1)), HasSubstr("camera model number -1 is not supported"));
  EXPECT_THAT(changed("cameras.bin", 16, std::uint64_t(1) << 32), HasSubstr("pixels is not supported"));
  EXPECT_THAT(changed("cameras.bin", 32, kNan), HasSubstr("is not a finite number"));
  // A quaternion and a translation: they cost their image.
  for (const auto& [at, value] : {std::pair<std::size_t, double>{12, kNan}, {44, kInfinite}}) {
    const TemporaryFolder folder;
    writeColmapBinary(folder);
    std::string bytes = contentOf(folder / "images.bin");
    std::memcpy(bytes.data() + at, &value, sizeof value);
    folder.write("images.bin", bytes);
    const Capture capture = kColmapReader->read(folder / "cameras.bin", {});
    EXPECT_EQ(capture.views.size(), 1u);
    EXPECT_THAT(capture.warnings, Contains(HasSubstr("images.bin: byte 8: no finite pose")));
  }
  EXPECT_THAT(changed("images.bin", 72, '\0'), HasSubstr("the name of the image is missing"));
  EXPECT_THAT(changed("points3D.bin", 16, kNan), HasSubstr("byte 8: is not a finite number"));
}

TEST(ColmapDamage, PixelsThatAreNotFiniteAreRefusedWithTheTracks) {
  const TemporaryFolder folder;
  writeColmapBinary(folder);
  std::string bytes = contentOf(folder / "images.bin");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::memcpy(bytes.data() + 8 + 64 + 6 + 8, &nan, sizeof nan);
  folder.write("images.bin", bytes);
  const Capture capture = readColmap(folder.path());
  EXPECT_THAT(inputErrorOf([&] { kColmapReader->tracks(capture, {}); }),
              HasSubstr("images.bin: byte 86: is not a finite number"));
}

/// The answer is complete, or an InputError.
bool isColmapReadWhole(const fs::path& cameras) {
  try {
    const Capture capture = kColmapReader->read(cameras, {});
    for (const CaptureView& v : capture.views) {
      EXPECT_TRUE(v.camera.camFromWorld.matrix().allFinite() && v.camera.pixelFromRay.allFinite());
      EXPECT_NEAR(v.camera.camFromWorld.linear().determinant(), 1, tolerance::kExact);
    }
    for (const CaptureTrack& track : kColmapReader->tracks(capture, {}))
      for (const auto& seen : track.seen) EXPECT_TRUE(seen.measured.allFinite() && seen.view < int(capture.views.size()));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

TEST(ColmapDamage, RandomBytes) {
  const TemporaryFolder folder;
  writeColmap(folder);
  writeColmapBinary(folder);
  std::mt19937 random(20261127);
  int whole = 0, refused = 0;
  constexpr int kRounds = 1000;
  for (int round = 0; round < kRounds; ++round) {
    const std::string ending = round % 2 == 0 ? ".bin" : ".txt";
    constexpr const char* kStems[] = {"cameras", "images", "points3D"};
    const std::string file = kStems[random() % 3] + ending, good = contentOf(folder / file);
    std::string bad = good;
    for (int i = 0; i < 3; ++i) bad[random() % bad.size()] = char(random());
    folder.write(file, bad);
    isColmapReadWhole(folder / ("cameras" + ending)) ? ++whole : ++refused;
    folder.write(file, good);
  }
  EXPECT_GT(whole, kRounds / 10);  // both happen
  EXPECT_GT(refused, kRounds / 10);
}

// rigs and frames (COLMAP 3.12 and later): a rig of two cameras. Camera 8 is turned by a quarter about x and moved by
// (10, 20, 30) in the rig, which is moved by (0, 0, 5) in the world: its image has R (0, 0, 5) + t = (0, -5, 0) + (10, 20, 30).

constexpr const char* kColmapRigs =
    "# Rig calib list with one line of data per calib:\n"
    "1 2 CAMERA 7 CAMERA 8 1 0.70710678118654757 0.70710678118654757 0 0 10 20 30\n";
constexpr const char* kColmapFrames =
    "# Frame list with one line of data per frame:\n"
    "5 1 1 0 0 0 0 0 5 2 CAMERA 7 4 CAMERA 8 41\n";

struct ColmapRigFolder : TemporaryFolder {
  ColmapRigFolder() {
    const std::string cameras = std::string(kColmapCameras) + "8 PINHOLE 640 480 500 510 320 240\n";
    writeColmap(*this, "", cameras, with(kColmapImages, "10 20 30 7", "10 15 30 8"));
    write("rigs.txt", kColmapRigs);
    write("frames.txt", kColmapFrames);
  }
  Capture read() const { return kColmapReader->read(*this / "cameras.txt", {}); }
};

TEST(ColmapRigs, AgreeWithTheImages) {
  const ColmapRigFolder folder;
  const Capture capture = folder.read();
  EXPECT_THAT(capture.facts, Contains("rigs.txt and frames.txt agree with the poses of 2 images"));
  EXPECT_THAT(capture.sources, Contains(folder / "rigs.txt"));
  EXPECT_THAT(capture.sources, Contains(folder / "frames.txt"));
  for (const std::string& warning : capture.warnings) EXPECT_THAT(warning, testing::Not(HasSubstr("rigs")));
}

TEST(ColmapRigs, BinaryAgreeWithTheImages) {
  const TemporaryFolder folder;
  writeColmapBinary(folder);
  // A rig of camera 7 and of an inertial sensor (type 1), which is not an image's.
  ColmapBytes rigs, frames;
  rigs.u64(1).u32(1).u32(2).i32(0).u32(7).i32(1).u32(3).u8(0);
  constexpr double kHalfTurn = 0.70710678118654757;
  frames.u64(2);
  frames.u32(5).u32(1).doubles({1, 0, 0, 0, 0, 0, 5}).u32(2).i32(0).u32(7).u64(4).i32(1).u32(3).u64(12);
  frames.u32(6).u32(1).doubles({kHalfTurn, kHalfTurn, 0, 0, 10, 20, 30}).u32(1).i32(0).u32(7).u64(41);
  folder.write("rigs.bin", rigs.text);
  folder.write("frames.bin", frames.text);
  EXPECT_THAT(readColmap(folder.path()).facts, Contains("rigs.bin and frames.bin agree with the poses of 2 images"));
  folder.write("frames.bin", frames.text.substr(0, 100));
  EXPECT_THAT(readColmap(folder.path()).warnings, Contains(HasSubstr("are not understood")));
}

TEST(ColmapRigs, ADifferenceOfMoreThanAMillionthIsRefused) {
  const ColmapRigFolder folder;
  folder.write("rigs.txt", with(kColmapRigs, "10 20 30", "10 20.00001 30"));
  EXPECT_THAT(folder.read().facts, Contains(HasSubstr("agree")));  // relative to 35 from the origin: 3e-7
  folder.write("rigs.txt", with(kColmapRigs, "10 20 30", "10 20.0001 30"));
  EXPECT_THAT(inputErrorOf([&] { folder.read(); }), HasSubstr("frames.txt: line 2: the pose of image 'b.jpg' differs"));
  folder.write("rigs.txt", kColmapRigs);
  folder.write("frames.txt", with(kColmapFrames, "5 1 1 0 0 0", "5 1 1 0 0 1e-5"));
  EXPECT_THAT(inputErrorOf([&] { folder.read(); }), HasSubstr("frames.txt: line 2: the pose of image 'a.jpg' differs"));
}

TEST(ColmapRigs, OtherCamerasAndRigsAreRefused) {
  const ColmapRigFolder folder;
  folder.write("frames.txt", with(kColmapFrames, "CAMERA 7 4", "CAMERA 8 4"));
  EXPECT_THAT(inputErrorOf([&] { folder.read(); }), HasSubstr("image 'a.jpg' is of camera 8 here and of camera 7"));
  folder.write("frames.txt", with(kColmapFrames, "CAMERA 7 4", "CAMERA 9 4"));
  EXPECT_THAT(inputErrorOf([&] { folder.read(); }), HasSubstr("rig 1 has no camera 9"));
  folder.write("frames.txt", with(kColmapFrames, "5 1 1", "5 2 1"));
  EXPECT_THAT(inputErrorOf([&] { folder.read(); }), HasSubstr("there is no rig 2"));
}

TEST(ColmapRigs, WhatCannotBeComparedIsAWarning) {
  const ColmapRigFolder folder;
  folder.write("rigs.txt", "1 2 CAMERA 7 CAMERA 8 0\n");  // COLMAP does not know the second camera's place in the rig
  EXPECT_THAT(folder.read().warnings, Contains(HasSubstr("no pose for the cameras of 1 image")));
  folder.write("rigs.txt", kColmapRigs);
  for (const char* image : {"99", "4294967300"}) {  // 2^32 + 4 is not image 4
    folder.write("frames.txt", with(kColmapFrames, "CAMERA 7 4", std::string("CAMERA 7 ") + image));
    EXPECT_THAT(folder.read().warnings, Contains("frames.txt names 1 image that the model does not have")) << image;
  }
  folder.write("frames.txt", "a later version\n");
  EXPECT_THAT(folder.read().warnings, Contains(HasSubstr("are not understood")));
  fs::remove(folder / "frames.txt");
  EXPECT_THAT(folder.read().warnings, Contains(HasSubstr("rigs.txt has no counterpart")));
}

}  // namespace
}  // namespace glint::colmap_damage_tests

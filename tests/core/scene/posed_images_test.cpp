// SPDX-License-Identifier: BSD-3-Clause
// Folders of images, and videos, with a file of poses.
#include <gmock/gmock.h>

#include "core/base/number_text.h"
#include "core/scene/capture.h"
#include "tests/core/scene/png_fixture.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/core/scene/video_fixture.h"
#include "tests/tolerances.h"

namespace glint::posed_images_tests {
namespace {
using namespace testing_support;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
namespace fs = std::filesystem;

constexpr double kRoundOff = 1e-12;  // of a few operations on numbers of order one

CaptureOptions posedBy(const fs::path& poses, bool withCamera = true) {
  CaptureOptions options;
  options.poses = poses;
  if (withCamera) {
    options.camera.emplace();
    options.camera->pixelFromRay << 100, 0, 31.5, 0, 110, 23.5, 0, 0, 1;
  }
  return options;
}

Capture readImages(const fs::path& folder, const CaptureOptions& options) {
  const auto reader = makeImagesReader();
  return reader->read(reader->recognise(folder), options);
}

std::string imagesError(const fs::path& folder, const CaptureOptions& options) {
  return inputErrorOf([&] { readImages(folder, options); });
}

/// A line whose camera looks along the world's z from (x, 0, -2).
std::string jsonLine(const std::string& id, double x, const std::string& more = "") {
  return "{\"id\": \"" + id + "\"" + more + ", \"camera_from_world\": [[1,0,0," + formatted("%.6f", -x) +
         "],[0,1,0,0],[0,0,1,2],[0,0,0,1]]}\n";
}

struct Frames : TemporaryFolder {
  explicit Frames(const std::vector<std::string>& names) {
    for (const std::string& name : names) write("frames/" + name, pngOfSize(64, 48));
  }
  fs::path frames() const { return *this / "frames"; }
};

TEST(PosedImages, ThePicturesOfAJpegAreNotAskedForToKnowItsSize) {
  // A frame header of 64 x 48 (ITU T.81, B.2.2) and nothing behind it: opening thousands of photographs does not read them.
  const std::string start = std::string("\xff\xd8\xff\xc0\0\x0b\x08\0\x30\0\x40\x01\x01\x11\0", 15);
  const Frames folder({});
  folder.write("frames/a.jpg", start);
  const Capture capture = readImages(folder.frames(), posedBy(folder.write("poses.jsonl", jsonLine("a", 1))));
  ASSERT_EQ(capture.views.size(), 1u);
  EXPECT_EQ(capture.views[0].camera.width, 64);
  EXPECT_EQ(capture.views[0].camera.height, 48);
  folder.write("frames/a.jpg", start.substr(0, 8));
  EXPECT_THAT(imagesError(folder.frames(), posedBy(folder / "poses.jsonl")), HasSubstr("truncated"));
}

TEST(PosedImages, JsonLinesGoByTheNameOfTheImageInAnyOrder) {
  const Frames folder({"b.png", "a.png", "c.d.png"});
  folder.write("frames/notes.txt", "no image");
  const fs::path poses =
      folder.write("poses.jsonl", "# of the robot\n" + jsonLine("c.d", 3) + jsonLine("a", 1) + "\n" + jsonLine("b", 2));
  const Capture capture = readImages(folder.frames(), posedBy(poses));
  EXPECT_EQ(capture.kind, "images");
  EXPECT_EQ(capture.file, folder.frames() / "a.png");
  EXPECT_THAT(capture.sources, Contains(poses));
  ASSERT_EQ(capture.views.size(), 3u);
  const std::vector<std::string> names{"a.png", "b.png", "c.d.png"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const CaptureView& view = capture.views[i];
    EXPECT_EQ(view.name, names[i]);
    EXPECT_EQ(view.image, folder.frames() / names[i]);
    EXPECT_EQ(view.camera.width, 64);
    EXPECT_EQ(view.camera.pixelFromRay(1, 1), 110);
    EXPECT_LT((view.camera.centreInWorld() - Eigen::Vector3d(double(i) + 1, 0, -2)).norm(), kRoundOff);
  }
  EXPECT_THAT(capture.warnings, IsEmpty());
}

TEST(PosedImages, TumLinesGoByTheTimeInTheName) {
  const Frames folder({"1305031102.175304.png", "1305031102.211214.png", "1305031102.300000.png"});
  // The nearest of each; the last image is 21 ms from its nearest; a pose is taken once.
  const fs::path poses = folder.write("groundtruth.txt",
                                      "# timestamp tx ty tz qx qy qz qw\n1305031102.1758 1 2 3 0 0 0.70710678118654752 "
                                      "0.70710678118654752\n1305031102.2158 4 5 6 0 0 0 1\n1305031102.279 7 8 9 0 0 0 1\n");
  const Capture capture = readImages(folder.frames(), posedBy(poses));
  ASSERT_EQ(capture.views.size(), 2u);
  EXPECT_EQ(capture.views[0].name, "1305031102.175304.png");
  // Camera to world, turned by 90 degrees about z: the camera's x is the world's y.
  const Eigen::Isometry3d& pose = capture.views[0].camera.camFromWorld;
  EXPECT_LT((pose * Eigen::Vector3d(1, 3, 3) - Eigen::Vector3d::UnitX()).norm(), tolerance::kExact);
  EXPECT_LT((capture.views[1].camera.centreInWorld() - Eigen::Vector3d(4, 5, 6)).norm(), kRoundOff);
  EXPECT_THAT(capture.warnings,
              AllOf(Contains(HasSubstr("1 image of 3 has no pose")), Contains(HasSubstr("1 pose is of no image"))));
}

TEST(PosedImages, LineWithACameraOfItsOwn) {
  const Frames folder({"a.png", "b.png"});
  const std::string camera =
      ", \"camera\": {\"width\": 64, \"height\": 48, \"fx\": 70, \"fy\": 71, \"cx\": 30, \"cy\": 20, \"distortion\": "
      "[0.1,0,0,0,0]}";
  folder.write("poses.jsonl", jsonLine("a", 1, camera) + jsonLine("b", 2, camera));
  const Capture both = readImages(folder.frames(), posedBy(folder / "poses.jsonl", false));
  EXPECT_EQ(both.views[0].camera.pixelFromRay(0, 0), 70);
  EXPECT_EQ(both.views[1].camera.lens.parameters[0], 0.1);
  folder.write("poses.jsonl", jsonLine("a", 1, camera) + jsonLine("b", 2));
  EXPECT_EQ(readImages(folder.frames(), posedBy(folder / "poses.jsonl")).views[1].camera.pixelFromRay(0, 0), 100);
  try {
    readImages(folder.frames(), posedBy(folder / "poses.jsonl", false));
    FAIL() << "intrinsics were guessed";
  } catch (const UndecidedInput& e) {
    EXPECT_EQ(e.question(), UndecidedInput::Question::Camera);
    EXPECT_THAT(e.what(), HasSubstr("no intrinsics of 'b.png'"));
  }
  folder.write("frames/a.png", pngOfSize(65, 48));
  EXPECT_THAT(imagesError(folder.frames(), posedBy(folder / "poses.jsonl")), HasSubstr("64 x 48 pixels, 'a.png' 65 x 48"));
}

// What EXIF says is offered in the refusal, and not taken: 43.2666 mm of film have the diagonal of 3, 4, 5 for a lens as long.
TEST(PosedImages, TheFocalLengthOfExifIsAHint) {
  const Frames folder({});
  const auto two = [](unsigned v) { return std::string{static_cast<char>(v >> 8), static_cast<char>(v & 0xFF)}; };
  const auto four = [&](unsigned v) { return two(v >> 16) + two(v & 0xFFFF); };
  const std::string exif = std::string("Exif\0\0MM", 8) + two(42) + four(8) + two(1) + two(0x8769) + two(4) + four(1) + four(26) +
                           four(0) + two(1) + two(0xA405) + two(3) + four(1) + two(50) + two(0) + four(0);
  const std::string frame = "\xFF\xC0" + two(11) + "\x08" + two(480) + two(640) + std::string("\1\1\x11\0", 4);
  folder.write("frames/a.jpg", "\xFF\xD8\xFF\xE1" + two(static_cast<unsigned>(exif.size()) + 2) + exif + frame + "\xFF\xD9");
  folder.write("poses.jsonl", jsonLine("a", 1));
  // 50 / 43.2666 * 800 px = 924.5 px; the middle of 640 x 480 pixels is 319.5, 239.5.
  EXPECT_THAT(imagesError(folder.frames(), posedBy(folder / "poses.jsonl", false)),
              HasSubstr("(EXIF: 50 mm on 35 mm film, about --camera 925,925,319.5,239.5 without distortion)"));
}

TEST(PosedImages, OneCameraForImagesOfSeveralSizesIsRefused) {
  const Frames folder({"a.png", "b.png"});
  folder.write("frames/b.png", pngOfSize(32, 24));
  folder.write("poses.jsonl", jsonLine("a", 1) + jsonLine("b", 2));
  EXPECT_THAT(imagesError(folder.frames(), posedBy(folder / "poses.jsonl")),
              HasSubstr("32 x 24 pixels, 'a.png' is 64 x 48: --camera is one for all"));
}

TEST(PosedImages, OrderCountsOnlyWhenAPersonSaysSo) {
  const Frames folder({"frame_01.png", "frame_02.png"});
  const std::string line = " 0 0 0 1\n";
  folder.write("poses.txt", "5.0 1 0 0" + line + "6.0 2 0 0" + line);
  CaptureOptions options = posedBy(folder / "poses.txt");
  EXPECT_THAT(imagesError(folder.frames(), options), AllOf(HasSubstr("no time in seconds"), HasSubstr("--poses-by order")));
  try {
    readImages(folder.frames(), options);
    FAIL() << "poses were paired";
  } catch (const UndecidedInput& e) {  // a person can say so: the window has a button
    EXPECT_EQ(e.question(), UndecidedInput::Question::PosesBy);
    EXPECT_STREQ(e.option(), "--poses-by");
    ASSERT_EQ(e.answers().size(), 1u);
    EXPECT_EQ(e.answers()[0].value, "order");
  }
  options.posesByOrder = true;
  EXPECT_EQ(readImages(folder.frames(), options).views[1].camera.centreInWorld().x(), 2);
  folder.write("poses.txt", "5.0 1 0 0" + line);
  EXPECT_THAT(imagesError(folder.frames(), options), HasSubstr("1 pose for 2 images: by order they must be as many"));
  options.posesByOrder = false;
  EXPECT_THAT(imagesError(folder.frames(), options), AllOf(HasSubstr("no time in seconds"), Not(HasSubstr("--poses-by order"))));
  try {
    readImages(folder.frames(), options);
  } catch (const InputError& e) {
    EXPECT_EQ(dynamic_cast<const UndecidedInput*>(&e), nullptr) << "the order cannot be right: there is nothing to ask";
  }
}

TEST(PosedImages, OrderIsRefusedWhereItIsNotCertain) {
  // As text frame_10 comes before frame_2.
  const Frames folder({"frame_1.png", "frame_2.png", "frame_10.png"});
  folder.write("poses.txt", "1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n3 3 0 0 0 0 0 1\n");
  CaptureOptions options = posedBy(folder / "poses.txt");
  options.posesByOrder = true;
  EXPECT_THAT(imagesError(folder.frames(), options), HasSubstr("the order of 'frame_10.png' and 'frame_2.png' is not certain"));
  // A line without a pose is passed over; three images and three poses are left, but they do not belong together.
  const Frames padded({"frame_01.png", "frame_02.png", "frame_10.png"});
  padded.write("poses.txt", "1 1 0 0 0 0 0 1\n2 nan nan nan 0 0 0 1\n3 3 0 0 0 0 0 1\n4 4 0 0 0 0 0 1\n");
  options.poses = padded / "poses.txt";
  EXPECT_THAT(imagesError(padded.frames(), options), AllOf(HasSubstr("line 2"), HasSubstr("no pose in this line")));
}

TEST(PosedImages, WhatDoesNotBelongTogetherIsRefused) {
  const Frames folder({"a.png", "b.png"});
  folder.write("poses.jsonl", jsonLine("x", 1) + jsonLine("y", 2) + jsonLine("z", 2));
  EXPECT_THAT(imagesError(folder.frames(), posedBy(folder / "poses.jsonl")),
              AllOf(HasSubstr("a.png"), HasSubstr("first id 'x'")));
  folder.write("frames/a.jpg", pngOfSize(64, 48));
  folder.write("poses.jsonl", jsonLine("a", 1));
  EXPECT_THAT(imagesError(folder.frames(), posedBy(folder / "poses.jsonl")), HasSubstr("has the same id as 'a.jpg'"));
  const Frames timed({"100.0.png", "100.1.png"});
  timed.write("poses.txt", "200 1 0 0 0 0 0 1\n");
  EXPECT_THAT(imagesError(timed.frames(), posedBy(timed / "poses.txt")),
              AllOf(HasSubstr("no pose within 20 ms of any image"), HasSubstr("100.000000 s"), HasSubstr("200.000000 s")));
}

TEST(PosedImages, WithoutPosesSaysWhatIsMissing) {
  const Frames folder({"a.png"});
  try {
    readImages(folder.frames(), {});
    FAIL() << "poses were guessed";
  } catch (const UndecidedInput& e) {
    EXPECT_EQ(e.question(), UndecidedInput::Question::Poses);
    EXPECT_STREQ(e.option(), "--poses");
  }
  EXPECT_THAT(imagesError(folder.frames(), posedBy(folder / "none.txt")), HasSubstr("none.txt"));
}

TEST(PosedVideo, PicturesTakeThePosesOfTheirTimes) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writeVideo(folder / "clip.avi", "MJPG", 50, 25));
  const fs::path poses = folder.write("poses.txt", "0.041 1 0 0 0 0 0 1\n1.0 2 0 0 0 0 0 1\n1.27 3 0 0 0 0 0 1\n");
  const auto reader = makeVideoReader();
  EXPECT_EQ(reader->recognise(folder.path()), folder / "clip.avi");
  const Capture capture = reader->read(folder / "clip.avi", posedBy(poses));
  ASSERT_EQ(capture.views.size(), 3u);
  // 25 pictures a second: 0.04 s is picture 1, 1 s picture 25, 1.28 s picture 32.
  const std::vector<int> pictures{1, 25, 32};
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    ASSERT_TRUE(capture.views[i].ofVideo);
    EXPECT_EQ(capture.views[i].ofVideo->index, pictures[i]);
    EXPECT_NEAR(capture.views[i].ofVideo->seconds, pictures[i] / 25.0, 1e-6);
    EXPECT_EQ(capture.views[i].camera.centreInWorld().x(), double(i) + 1);
    EXPECT_EQ(capture.views[i].camera.width, 64);
  }
  EXPECT_EQ(capture.views[0].name, "000001");
  folder.write("poses.jsonl", jsonLine("first", 1, ", \"time\": 0.0"));
  EXPECT_EQ(reader->read(folder / "clip.avi", posedBy(folder / "poses.jsonl")).views[0].ofVideo->index, 0);
  folder.write("poses.jsonl", jsonLine("first", 1));
  EXPECT_THAT(inputErrorOf([&] { reader->read(folder / "clip.avi", posedBy(folder / "poses.jsonl")); }),
              HasSubstr("has no time: the poses of a video are paired by time"));
}

}  // namespace
}  // namespace glint::posed_images_tests

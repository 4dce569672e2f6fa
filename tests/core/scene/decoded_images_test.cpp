// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/decoded_images.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <chrono>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "core/base/limits.h"
#include "core/scene/scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
namespace fs = std::filesystem;

DecodedImage imageOf(int width, uchar value) {
  return {std::make_shared<const cv::Mat>(1, width, CV_8UC1, cv::Scalar(value)), false};
}
FileVersion versionAt(std::int64_t ns) { return {1, 2, 3, ns}; }
uchar valueOf(const std::optional<DecodedImage>& image) { return image ? image->pixels->ptr<uchar>(0)[0] : 0; }

Frame frameOf(int width, int height, const fs::path& image) {
  Frame f;
  f.id = "a";
  f.camera.width = width;
  f.camera.height = height;
  f.image = image;
  return f;
}

/// What this process keeps is as before at the end of a test.
struct Keeping {
  explicit Keeping(std::size_t bytes) { keepDecodedImages(bytes); }
  ~Keeping() { keepDecodedImages(0); }
};

/// 4 x 3 pixels of one value, not compressed: files of all values have the same size.
bool writeStored(const fs::path& file, int value) {
  return cv::imwrite(file.string(), cv::Mat(3, 4, CV_8UC1, cv::Scalar(value)), {cv::IMWRITE_PNG_COMPRESSION, 0});
}

/// Waits until the file's last change is long enough ago for it to be kept.
void letItSettle() { std::this_thread::sleep_for(std::chrono::milliseconds(1100)); }

TEST(DecodedImages, GivesBackWhatWasKeptForThatFileAndVersionOnly) {
  DecodedImages images(1000);
  images.keep("a", versionAt(5), imageOf(10, 7));
  EXPECT_EQ(valueOf(images.find("a", versionAt(5))), 7);
  EXPECT_FALSE(images.find("b", versionAt(5)));
  EXPECT_FALSE(images.find("a", versionAt(6)));
  EXPECT_EQ(images.bytes(), 0u);  // nobody can ask for the old version any more
}

TEST(DecodedImages, HoldsNoMoreBytesThanItMayAndPassesOverMoreFramesFindSome) {
  DecodedImages images(1000);
  int found = 0;
  for (int pass = 0; pass < 20; ++pass)
    for (int frame = 0; frame < 15; ++frame) {
      const std::string file = std::to_string(frame);
      const std::optional<DecodedImage> kept = images.find(file, versionAt(1));
      if (kept)
        EXPECT_EQ(valueOf(kept), frame + 1);
      else
        images.keep(file, versionAt(1), imageOf(100, uchar(frame + 1)));
      found += kept.has_value();
      EXPECT_LE(images.bytes(), 1000u);
    }
  // There is room for ten of fifteen. "Least recently used" finds none; an eighth is far below what a random choice finds.
  EXPECT_GT(found, 300 / 8);
  images.setMostBytes(250);
  EXPECT_LE(images.bytes(), 250u);
  images.keep("large", versionAt(1), imageOf(251, 1));
  EXPECT_FALSE(images.find("large", versionAt(1)));
}

TEST(DecodedImages, AFileThatJustChangedIsNotKept) {
  DecodedImages images(1000);
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  const FileVersion fresh = versionAt(std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec);
  images.keep("a", fresh, imageOf(10, 7));
  EXPECT_FALSE(images.find("a", fresh));
}

TEST(DecodedImages, WhatIsHeldStaysAndWhatIsNotMakesRoomForIt) {
  DecodedImages images(300, 600);
  images.keep("other", versionAt(1), imageOf(200, 9));
  images.hold({"a", "b", "c"});
  images.keep("a", versionAt(1), imageOf(250, 1));
  images.keep("b", versionAt(1), imageOf(250, 2));  // takes the room of the one that nobody holds
  images.keep("c", versionAt(1), imageOf(250, 3));  // no room: those that came first stay
  EXPECT_EQ(valueOf(images.find("a", versionAt(1))), 1);
  EXPECT_EQ(valueOf(images.find("b", versionAt(1))), 2);
  EXPECT_FALSE(images.find("c", versionAt(1)));
  EXPECT_FALSE(images.find("other", versionAt(1)));
  images.keep("other", versionAt(1), imageOf(10, 9));
  EXPECT_FALSE(images.find("other", versionAt(1))) << "what is held takes more than all others may";
  EXPECT_EQ(images.bytes(), 500u);
  images.hold({"a"});
  images.release({"a", "b", "c"});
  EXPECT_LE(images.bytes(), 300u);
  EXPECT_EQ(valueOf(images.find("a", versionAt(1))), 1) << "somebody else holds it";
  EXPECT_FALSE(images.find("b", versionAt(1)));
}

TEST(DecodedImages, AFileThatJustChangedIsKeptAsLongAsItIsHeld) {
  DecodedImages images(1000);
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  const FileVersion fresh = versionAt(std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec);
  images.hold({"a"});
  images.keep("a", fresh, imageOf(10, 7));
  EXPECT_EQ(valueOf(images.find("a", fresh)), 7);
  images.release({"a"});
  EXPECT_FALSE(images.find("a", fresh));
}

TEST(DecodedImages, APhotographWithAlphaIsDecodedOnceForItsPixelsAndOnceForItsAlpha) {
  const TemporaryFolder folder;
  Scene scene;
  scene.frames = {frameOf(4, 3, folder / "x.png")};
  cv::Mat cutOut(3, 4, CV_8UC4, cv::Scalar(10, 20, 30, 255));
  cutOut.at<cv::Vec4b>(1, 2)[3] = 0;
  ASSERT_TRUE(cv::imwrite(scene.frames[0].image.string(), cutOut));
  const Outcome<MaskedImage> alone = readMasked(scene.frames[0], FrameSource::Image);
  ASSERT_TRUE(alone && alone->mask);
  const PhotographsHeld held(scene, {0});
  const int before = timesDecoded();
  for (int pass = 0; pass < 3; ++pass) {
    const Outcome<MaskedImage> image = readMasked(scene.frames[0], FrameSource::Image);
    ASSERT_TRUE(image && image->mask);
    EXPECT_EQ(image->linear.data, alone->linear.data);
    EXPECT_EQ(image->mask->data, alone->mask->data);
    EXPECT_EQ(image->mask->at(2, 1), 0.f);
    EXPECT_EQ(image->mask->at(1, 1), 1.f);
    const Outcome<std::optional<Image>> mask = readMask(scene.frames[0]);
    ASSERT_TRUE(mask && *mask);
    EXPECT_EQ((*mask)->data, alone->mask->data);
  }
  EXPECT_EQ(timesDecoded() - before, 2);
}

// Another picture of the same size in bytes, written into the same file, which is given its old time again: as hard to notice as
// it can be.
TEST(DecodedImages, AFrameWhoseFileChangesIsReadAgain) {
  const TemporaryFolder folder;
  const Keeping keeping(1'000'000);
  const Frame f = frameOf(4, 3, folder / "x.png");
  ASSERT_TRUE(writeStored(f.image, 10));
  const std::uintmax_t bytes = fs::file_size(f.image);
  const fs::file_time_type written = fs::last_write_time(f.image);
  letItSettle();
  const Outcome<Image> first = readLinear(f, FrameSource::Image), again = readLinear(f, FrameSource::Image);
  ASSERT_TRUE(first && again);
  EXPECT_EQ(first->data, again->data);
  EXPECT_EQ(decodedImages().bytes(), 12u);
  ASSERT_TRUE(writeStored(f.image, 128));
  fs::last_write_time(f.image, written);
  ASSERT_EQ(fs::file_size(f.image), bytes);
  const Outcome<Image> changed = readLinear(f, FrameSource::Image);
  ASSERT_TRUE(changed);
  EXPECT_NEAR(changed->data[0], 0.2158605f, 1e-6f);  // code 128 in linear light by the sRGB standard
  fs::remove(f.image);
  EXPECT_FALSE(readLinear(f, FrameSource::Image));
}

TEST(DecodedImages, ALimitThatIsLoweredAndACameraOfAnotherSizeCountForKeptImagesToo) {
  const TemporaryFolder folder;
  const Keeping keeping(10'000'000);
  Frame f = frameOf(1200, 1000, folder / "x.png");
  ASSERT_TRUE(cv::imwrite(f.image.string(), cv::Mat(1000, 1200, CV_8UC1, cv::Scalar(10))));
  letItSettle();
  ASSERT_TRUE(readLinear(f, FrameSource::Image));
  ASSERT_EQ(decodedImages().bytes(), 1'200'000u);
  const double standard = limitOf(Limit::ImageMegapixels);
  setLimit("image.megapixels=1");
  const Outcome<Image> refused = readLinear(f, FrameSource::Image);
  setLimit("image.megapixels=" + std::to_string(static_cast<int>(standard)));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.failure().detail, testing::HasSubstr("--limit"));
  f.camera.width = 1000;
  f.camera.height = 1200;
  const Outcome<Image> turned = readLinear(f, FrameSource::Image);
  ASSERT_FALSE(turned);
  EXPECT_THAT(turned.failure().detail, testing::HasSubstr("1200 x 1000"));
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// What libglint-codecs writes and reads, against OpenCV's own modules, which this program links.
#include "core/codecs/codecs.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "tests/core/scene/scene_fixture.h"

namespace glint::codecs_tests {
namespace {

constexpr double kGreyOff = 6;  // grey values that the lossy codec of the video is off by, as in the tests of core/scene

cv::Mat ramp(int type) {
  cv::Mat pixels(40, 56, type);
  cv::RNG random(7);
  random.fill(pixels, cv::RNG::UNIFORM, 0, 250);
  return pixels;
}

std::string text(const std::vector<unsigned char>& bytes) { return {bytes.begin(), bytes.end()}; }

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(Codecs, FilesHaveTheBytesThatOpenCvWrites) {
  const std::vector<int> uncompressed{cv::IMWRITE_TIFF_COMPRESSION, 1}, quality{cv::IMWRITE_JPEG_QUALITY, 70};
  const std::vector<std::tuple<std::string, int, std::vector<int>>> files{
      {".png", CV_8UC3, {}}, {".png", CV_16UC1, {}}, {".jpg", CV_8UC3, quality}, {".tiff", CV_32FC3, uncompressed}};
  for (const auto& [ending, type, parameters] : files) {
    std::vector<unsigned char> ours, theirs;
    ASSERT_TRUE(encodeWithOpenCv(ending, ramp(type), ours, parameters));
    ASSERT_TRUE(cv::imencode(ending, ramp(type), theirs, parameters));
    EXPECT_EQ(ours, theirs) << ending << " " << type;
  }
}

TEST(Codecs, PixelsComeBackWithAlphaAndDepth) {
  std::string reason;
  for (const auto& [ending, type] : {std::pair{".png", CV_8UC4}, {".png", CV_16UC3}, {".tiff", CV_32FC1}, {".bmp", CV_8UC3}}) {
    std::vector<unsigned char> bytes;
    ASSERT_TRUE(cv::imencode(ending, ramp(type), bytes, {cv::IMWRITE_TIFF_COMPRESSION, 1}));
    EXPECT_TRUE(same(decodeOtherFormat(text(bytes), reason), ramp(type))) << ending << " " << type;
  }
}

TEST(Codecs, WhatIsNoImageIsEmptyOrThrows) {
  std::string reason;
  EXPECT_TRUE(decodeOtherFormat("no image at all", reason).empty());
  EXPECT_THROW(decodeOtherFormat("", reason), cv::Exception);
  std::vector<unsigned char> bytes;
  EXPECT_THROW(encodeWithOpenCv(".nothing", ramp(CV_8UC3), bytes), cv::Exception);
}

TEST(Codecs, AVideoIsWhatOpenCvReadsAndWrites) {
  const testing_support::TemporaryFolder folder;
  const std::string file = (folder.path() / "grey.avi").string();
  {
    const std::unique_ptr<VideoEncoder> writer = newVideoEncoder();
    EXPECT_FALSE(writer->open((folder.path() / "no/folder.avi").string(), "MJPG", 25, 64, 48));
    ASSERT_TRUE(writer->open(file, "MJPG", 25, 64, 48));
    for (int i = 0; i < 5; ++i) writer->write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(40 * i)));
    writer->close();
  }
  cv::VideoCapture theirs(file);
  const std::unique_ptr<VideoDecoder> ours = newVideoDecoder();
  EXPECT_FALSE(ours->isOpen());
  ASSERT_TRUE(ours->open(file));
  EXPECT_TRUE(ours->isOpen());
  EXPECT_EQ(ours->width(), 64);
  EXPECT_EQ(ours->height(), 48);
  EXPECT_EQ(ours->picturesPerSecond(), 25);
  for (int i = 0; i < 5; ++i) {
    cv::Mat a, b;
    ASSERT_TRUE(ours->grab() && ours->retrieve(a) && theirs.read(b));
    EXPECT_TRUE(same(a, b)) << i;
    EXPECT_NEAR(cv::mean(a)[0], 40 * i, kGreyOff);
    EXPECT_NEAR(ours->seconds(), i / 25., 1e-9);
  }
  EXPECT_FALSE(ours->grab());
  ASSERT_TRUE(ours->open(file) && ours->seek(3) && ours->grab());
  cv::Mat fourth;
  ASSERT_TRUE(ours->retrieve(fourth));
  EXPECT_NEAR(cv::mean(fourth)[0], 120, kGreyOff);
  ours->close();
  EXPECT_FALSE(ours->isOpen());
  EXPECT_FALSE(ours->open((folder.path() / "absent.avi").string()));
}

}  // namespace
}  // namespace glint::codecs_tests

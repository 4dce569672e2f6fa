// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/video.h"

#include <gmock/gmock.h>

#include <thread>

#include "tests/core/scene/scene_fixture.h"
#include "tests/core/scene/video_fixture.h"

namespace glint::video_tests {
namespace {
using namespace testing_support;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kPictures = 200;
constexpr double kRate = 25;
constexpr double kGreyOff = 6;            // grey values that lossy codecs are off by, measured: up to 4; neighbours differ by 37
constexpr double kMillisecondOff = 1e-3;  // Matroska counts milliseconds

double meanOf(const cv::Mat& pixels) { return (cv::mean(pixels)[0] + cv::mean(pixels)[1] + cv::mean(pixels)[2]) / 3; }

void expectPicture(const fs::path& file, int index, double seconds) {
  const Outcome<cv::Mat> pixels = videoPicture(file, {index, seconds});
  ASSERT_TRUE(pixels) << pixels.failure().detail;
  EXPECT_EQ(pixels->type(), CV_8UC3);
  EXPECT_NEAR(meanOf(*pixels), greyOf(index), kGreyOff) << "picture " << index;
}

std::uint32_t wordAt(const std::string& bytes, std::size_t at) {
  std::uint32_t v = 0;
  for (std::size_t i = 0; i < 4; ++i) v = v << 8 | static_cast<unsigned char>(bytes[at + i]);
  return v;
}

void putWord(std::string& bytes, std::size_t at, std::uint32_t v) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(v >> (24 - 8 * i) & 0xff);
}

/// Makes the pictures from `from` on last twice as long, as a telephone does in the dark: one more row in the table of durations
/// (ISO 14496-12, 8.6.1.2), in boxes that grow by it. The table lies behind the pictures, so that no place of theirs changes.
std::string withSlowerEnd(std::string mp4, std::uint32_t from) {
  const std::size_t table = mp4.find("stts") + 4;  // version and flags; count of rows; rows of count and duration
  const std::uint32_t count = wordAt(mp4, table + 8), duration = wordAt(mp4, table + 12);
  EXPECT_EQ(wordAt(mp4, table + 4), 1u) << "the encoder writes a constant rate";
  putWord(mp4, table + 4, 2);
  putWord(mp4, table + 8, from);
  std::string row(8, '\0');
  putWord(row, 0, count - from);
  putWord(row, 4, 2 * duration);
  mp4.insert(table + 16, row);
  mp4.replace(mp4.find("edts"), 4, "free");  // the list of edits says how long the video was
  for (const char* box : {"moov", "trak", "mdia", "minf", "stbl", "stts"})
    putWord(mp4, mp4.find(box) - 4, wordAt(mp4, mp4.find(box) - 4) + 8);
  return mp4;
}

TEST(Video, PicturesAndTimesAreThoseThatWereWritten) {
  const TemporaryFolder folder;
  for (const auto& [name, codec] : {std::pair("a.mp4", "mp4v"), {"b.avi", "MJPG"}, {"c.mkv", "FFV1"}}) {
    char four[5] = {codec[0], codec[1], codec[2], codec[3], 0};
    ASSERT_TRUE(writeVideo(folder / name, four, kPictures, kRate)) << name;
    EXPECT_TRUE(looksLikeVideo(folder / name));
    const VideoContent content = readVideoContent(folder / name);
    EXPECT_EQ(content.width, 64);
    EXPECT_EQ(content.height, 48);
    ASSERT_EQ(content.seconds.size(), std::size_t(kPictures)) << name;
    for (int i = 0; i < kPictures; ++i)
      EXPECT_NEAR(content.seconds[std::size_t(i)], i / kRate, kMillisecondOff) << name << " " << i;
    // Forwards, back, far ahead, and again.
    for (const int i : {0, 1, 7, 3, 199, 60, 61, 150, 0, 149}) expectPicture(folder / name, i, content.seconds[std::size_t(i)]);
  }
}

TEST(Video, ChangingRateIsReadFromThePicturesAndSeeksFindThem) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writeVideo(folder / "constant.mp4", "mp4v", kPictures, kRate));
  const int from = 80;
  const fs::path file = folder.write("changing.mp4", withSlowerEnd(contentOf(folder / "constant.mp4"), from));
  const VideoContent content = readVideoContent(file);
  ASSERT_EQ(content.seconds.size(), std::size_t(kPictures));
  const auto seconds = [from](int i) { return (std::min(i, from) + 2 * std::max(0, i - from)) / kRate; };
  for (int i = 0; i < kPictures; ++i) EXPECT_NEAR(content.seconds[std::size_t(i)], seconds(i), kMillisecondOff) << i;
  for (const int i : {190, 5, 120, 81, 199}) expectPicture(file, i, content.seconds[std::size_t(i)]);
}

TEST(Video, ThreadsThatAskAtOnceGetTheirOwnPictures) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writeVideo(folder / "a.avi", "MJPG", kPictures, kRate));
  std::vector<double> grey(kPictures, -1);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = t; i < kPictures; i += 4)
        if (const auto pixels = videoPicture(folder / "a.avi", {i, i / kRate})) grey[std::size_t(i)] = meanOf(*pixels);
    });
  for (std::thread& t : threads) t.join();
  for (int i = 0; i < kPictures; ++i) EXPECT_NEAR(grey[std::size_t(i)], greyOf(i), kGreyOff) << i;
}

TEST(Video, AnotherVideoInItsPlaceIsNoticed) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writeVideo(folder / "a.avi", "MJPG", 20, 10));
  expectPicture(folder / "a.avi", 5, 0.5);
  const Outcome<cv::Mat> other = videoPicture(folder / "a.avi", {5, 0.2});  // at 25 per second
  ASSERT_FALSE(other);
  EXPECT_EQ(other.failure().reason, Reason::FrameUnreadable);
  EXPECT_THAT(other.failure().detail, HasSubstr("picture 5 is of 0.500 s, not of 0.200 s"));
  expectPicture(folder / "a.avi", 6, 0.6);
  const Outcome<cv::Mat> beyond = videoPicture(folder / "a.avi", {20, 2.0});
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.failure().detail, HasSubstr("picture 20 does not decode"));
  ASSERT_TRUE(writeVideo(folder / "a.avi", "MJPG", 30, 25));
  expectPicture(folder / "a.avi", 5, 0.2);
}

TEST(Video, WhatIsNoneIsRefused) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writeVideo(folder / "a.mp4", "mp4v", 20, 10));
  const std::string whole = contentOf(folder / "a.mp4");
  folder.write("cut.mp4", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(inputErrorOf([&] { readVideoContent(folder / "cut.mp4"); }), HasSubstr("cut.mp4"));
  EXPECT_FALSE(videoPicture(folder / "cut.mp4", {0, 0}));
  // What would make the decoder open other files, or addresses.
  for (const char* list : {"ffconcat version 1.0\nfile a.mp4\n", "#EXTM3U\n#EXTINF:1,\na.mp4\n", "", "no video"}) {
    folder.write("list.mp4", list);
    EXPECT_FALSE(looksLikeVideo(folder / "list.mp4"));
    EXPECT_THAT(inputErrorOf([&] { readVideoContent(folder / "list.mp4"); }), HasSubstr("is no video"));
    EXPECT_FALSE(videoPicture(folder / "list.mp4", {0, 0}));
  }
  EXPECT_FALSE(looksLikeVideo(folder / "missing.mp4"));
  EXPECT_FALSE(videoPicture(folder / "missing.mp4", {0, 0}));
}

}  // namespace
}  // namespace glint::video_tests

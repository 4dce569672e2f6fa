// SPDX-License-Identifier: BSD-3-Clause
// Pixels against OpenCV's own readers, which share the decoding library but none of the code here; damaged files against silence.
#include "core/scene/image_decode.h"

#include <gmock/gmock.h>
#include <png.h>

#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/base/atomic_file.h"
#include "core/base/limits.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
using testing::Not;

/// Smooth colours with some noise, so that every coder has something to do.
cv::Mat ramp(int type, double largest) {
  cv::Mat m(48, 64, CV_MAKETYPE(CV_64F, CV_MAT_CN(type)));
  for (int y = 0; y < m.rows; ++y)
    for (int x = 0; x < m.cols * m.channels(); ++x)
      m.ptr<double>(y)[x] = largest * (0.1 + 0.6 * (x * 7 % 191) / 191.0 + 0.3 * y / 48.0);
  cv::Mat out;
  m.convertTo(out, type);
  return out;
}

std::string encoded(const std::string& extension, const cv::Mat& m, const std::vector<int>& options = {}) {
  std::vector<uchar> bytes;
  EXPECT_TRUE(cv::imencode(extension, m, bytes, options));
  return {bytes.begin(), bytes.end()};
}

Outcome<cv::Mat> decoded(const std::string& bytes) {
  const ImageHeader header = readImageHeader(bytes);
  if (!header.problem.empty()) return Failure{Reason::FrameUnreadable, header.problem};
  return decodeImage(bytes, header);
}

/// What OpenCV reads, without alpha, red first.
cv::Mat byOpenCv(const std::string& bytes) {
  const cv::Mat m = cv::imdecode(std::vector<uchar>(bytes.begin(), bytes.end()), cv::IMREAD_UNCHANGED);
  if (m.channels() == 1) return m;
  std::vector<cv::Mat> c;
  cv::split(m, c);
  cv::Mat out;
  cv::merge(std::vector<cv::Mat>{c[2], c[1], c[0]}, out);
  return out;
}

void expectSame(const std::string& what, const std::string& bytes) {
  const Outcome<cv::Mat> ours = decoded(bytes);
  ASSERT_TRUE(ours) << what << ": " << ours.failure().message();
  const cv::Mat theirs = byOpenCv(bytes);
  ASSERT_EQ(ours->type(), theirs.type()) << what;
  ASSERT_EQ(ours->size(), theirs.size()) << what;
  EXPECT_EQ(cv::norm(*ours, theirs, cv::NORM_INF), 0) << what;
}

TEST(ImageDecode, LegalFilesAreReadAsOpenCvReadsThem) {
  expectSame("PNG, 8 bits, colour", encoded(".png", ramp(CV_8UC3, 255)));
  expectSame("PNG, 8 bits, grey", encoded(".png", ramp(CV_8UC1, 255)));
  expectSame("PNG, 8 bits, alpha", encoded(".png", ramp(CV_8UC4, 255)));
  expectSame("PNG, 16 bits, colour", encoded(".png", ramp(CV_16UC3, 65535)));
  expectSame("PNG, 16 bits, grey", encoded(".png", ramp(CV_16UC1, 65535)));
  expectSame("PNG, 16 bits, alpha", encoded(".png", ramp(CV_16UC4, 65535)));
  expectSame("PNG, 1 bit", encoded(".png", ramp(CV_8UC1, 255), {cv::IMWRITE_PNG_BILEVEL, 1}));
  expectSame("JPEG, colour", encoded(".jpg", ramp(CV_8UC3, 255)));
  expectSame("JPEG, grey", encoded(".jpg", ramp(CV_8UC1, 255)));
  expectSame("JPEG, progressive",
             encoded(".jpg", ramp(CV_8UC3, 255), {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_QUALITY, 60}));
  expectSame("TIFF, 16 bits", encoded(".tiff", ramp(CV_16UC3, 65535)));
  expectSame("TIFF, float", encoded(".tiff", ramp(CV_32FC3, 3), {cv::IMWRITE_TIFF_COMPRESSION, 1}));
  expectSame("EXR", encoded(".exr", ramp(CV_32FC3, 3)));
  expectSame("BMP", encoded(".bmp", ramp(CV_8UC3, 255)));
  expectSame("PPM", encoded(".ppm", ramp(CV_8UC3, 255)));
  expectSame("PGM, 16 bits", encoded(".pgm", ramp(CV_16UC1, 65535)));
  expectSame("HDR", encoded(".hdr", ramp(CV_32FC3, 3)));
  expectSame("WebP", encoded(".webp", ramp(CV_8UC3, 255), {cv::IMWRITE_WEBP_QUALITY, 101}));
}

/// Written by libpng itself: rows in seven passes (Adam7).
std::string interlacedPng(const cv::Mat& rgb) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, png_size_t n) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(data), n);
      },
      nullptr);
  png_set_IHDR(png, info, png_uint_32(rgb.cols), png_uint_32(rgb.rows), 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_ADAM7,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_bytep> rows;
  for (int y = 0; y < rgb.rows; ++y) rows.push_back(const_cast<png_bytep>(rgb.ptr(y)));
  png_set_rows(png, info, rows.data());
  png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

TEST(ImageDecode, AnInterlacedPngIsWhatWasWritten) {
  const cv::Mat m = ramp(CV_8UC3, 255);
  const Outcome<cv::Mat> ours = decoded(interlacedPng(m));
  ASSERT_TRUE(ours) << ours.failure().message();
  EXPECT_EQ(cv::norm(*ours, m, cv::NORM_INF), 0);
}

/// Every damaged file is a failure with a reason, or pixels; no decoder writes a line of its own.
TEST(ImageDecode, DamagedFilesEndInAReasonAndInSilence) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"png", encoded(".png", ramp(CV_8UC3, 255))},   {"png16", encoded(".png", ramp(CV_16UC1, 65535))},
      {"jpg", encoded(".jpg", ramp(CV_8UC3, 255))},   {"tiff", encoded(".tiff", ramp(CV_32FC3, 3))},
      {"exr", encoded(".exr", ramp(CV_32FC3, 3))},    {"bmp", encoded(".bmp", ramp(CV_8UC3, 255))},
      {"ppm", encoded(".ppm", ramp(CV_8UC3, 255))},   {"hdr", encoded(".hdr", ramp(CV_32FC3, 3))},
      {"webp", encoded(".webp", ramp(CV_8UC3, 255))},
  };
  cv::RNG random(20260401);  // one seed, so that a failure comes again
  int refused = 0, read = 0;
  testing::internal::CaptureStderr();
  for (const auto& [name, whole] : files)
    for (int round = 0; round < 60; ++round) {
      std::string bytes = whole;
      if (round % 3 == 0) bytes.resize(static_cast<std::size_t>(random.uniform(0, int(bytes.size()))));
      for (int k = 0; k < 1 + round % 4 && !bytes.empty(); ++k)
        bytes[static_cast<std::size_t>(random.uniform(0, int(bytes.size())))] = static_cast<char>(random.uniform(0, 256));
      const ImageHeader header = readImageHeader(bytes);
      constexpr double kMost = 1e6;  // pixels: the caller refuses sizes that are not its camera's
      if (header.problem.empty() && double(header.width) * double(header.height) > kMost) continue;
      const Outcome<cv::Mat> m = decoded(bytes);
      ++(m ? read : refused);
      if (!m) {
        EXPECT_FALSE(m.failure().detail.empty()) << name;
      }
    }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(refused, 100);
  EXPECT_GT(read, 20) << "the damage is too coarse to reach the decoders";
}

TEST(ImageDecode, GreyWhereDataAreMissingIsNoPicture) {
  const std::string jpeg = encoded(".jpg", ramp(CV_8UC3, 255));
  // The end marker stays, so that the file looks whole.
  const std::string gap = jpeg.substr(0, jpeg.size() * 2 / 3) + "\xff\xd9";
  const Outcome<cv::Mat> m = decoded(gap);
  ASSERT_FALSE(m);
  EXPECT_THAT(m.failure().detail, HasSubstr("the JPEG is damaged"));
}

TEST(ImageHeader, SaysTheSizeThatTheEncoderWrote) {
  for (const char* extension : {".png", ".jpg", ".tiff", ".exr", ".bmp", ".ppm", ".hdr", ".webp"}) {
    const bool isFloat =
        std::string(extension) == ".exr" || std::string(extension) == ".hdr" || std::string(extension) == ".tiff";
    const ImageHeader header = readImageHeader(encoded(extension, ramp(isFloat ? CV_32FC3 : CV_8UC3, isFloat ? 3 : 255)));
    EXPECT_EQ(header.problem, "") << extension;
    EXPECT_EQ(header.width, 64u) << extension;
    EXPECT_EQ(header.height, 48u) << extension;
  }
}

TEST(ImageHeader, APngThatClaimsToBeHugeIsSeenBeforeItIsDecoded) {
  std::string png = encoded(".png", ramp(CV_8UC1, 255));
  png.replace(16, 8, std::string("\0\0\xea\x60\0\0\xea\x60", 8));  // 60,000 x 60,000
  EXPECT_EQ(readImageHeader(png).width, 60000u);
}

TEST(ImageHeader, WhatIsNoImageIsSaid) {
  EXPECT_THAT(readImageHeader("").problem, HasSubstr("empty"));
  EXPECT_THAT(readImageHeader("GIF89a").problem, HasSubstr("a GIF picture, which is not supported"));
  EXPECT_THAT(readImageHeader("P7\nWIDTH 4\n").problem, HasSubstr("not a supported image"));
  for (const char* start : {"\x89PNG\r\n\x1a\n", "\xff\xd8", "BM", "P6\n", "#?RADIANCE\n", "II*"})
    EXPECT_NE(readImageHeader(start).problem, "") << start;
}

std::string corpus(const char* name) {
  return readFile(std::filesystem::path(GLINT_SOURCE_DIR) / "tests/fuzz/corpus/image" / name, Limit::ImageMegabytes);
}

/// Files written byte by byte after their specifications, 7 x 5 px, whose value is 1000 channel + 100 row + 10 column.
TEST(ImageDecode, KindsThatOpenCvCannotRead) {
  struct Case {
    const char* name;
    int type;
    double factor;
  };
  for (const Case& c : {Case{"planar16.tiff", CV_16UC3, 1}, Case{"planar_float.tiff", CV_32FC3, 1},
                        Case{"half.tiff", CV_32FC3, 1}, Case{"big16.tiff", CV_16UC3, 1}, Case{"big_grey.tiff", CV_8UC1, 0.1},
                        Case{"layers.exr", CV_32FC3, 1}, Case{"depth_v.exr", CV_32FC1, 1}}) {
    const Outcome<cv::Mat> read = decoded(corpus(c.name));
    ASSERT_TRUE(read) << c.name << ": " << read.failure().message();
    ASSERT_EQ(read->type(), c.type) << c.name;
    ASSERT_EQ(read->size(), cv::Size(7, 5)) << c.name;
    cv::Mat expected(5, 7, CV_MAKETYPE(CV_64F, read->channels())), found;
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < expected.cols * expected.channels(); ++x)
        expected.ptr<double>(y)[x] = c.factor * (1000 * (x % expected.channels()) + 100 * y + 10 * (x / expected.channels()));
    read->convertTo(found, CV_64F);
    EXPECT_LE(cv::norm(found, expected, cv::NORM_INF), 0.5 * (std::string_view(c.name) == "half.tiff"))
        << c.name;  // halves step by 1 up to 2048
  }
}

TEST(ImageDecode, AnExrFileWithoutColoursOrDepthNamesItsChannels) {
  const Outcome<cv::Mat> read = decoded(corpus("normals.exr"));
  ASSERT_FALSE(read);
  EXPECT_THAT(read.failure().message(), HasSubstr("the EXR has the channels Normal.W, Normal.X, Normal.Y2; needed are"));
}

TEST(ImageDecode, ACutFileIsRefused) {
  for (const char* name : {"planar16.tiff", "half.tiff", "big16.tiff", "layers.exr", "depth_v.exr"}) {
    const std::string whole = corpus(name);
    for (std::size_t size = 0; size + 1 < whole.size(); size += 13)
      EXPECT_FALSE(decoded(whole.substr(0, size))) << name << " " << size;
  }
}

TEST(ImageHeader, RawFilesOfCamerasAreNamed) {
  using namespace std::string_literals;
  const auto tiff = [](const std::string& entries, char count) {
    return "II*\0\x08\0\0\0"s + count + "\0"s + entries + "\0\0\0\0"s + std::string(64, '\0');
  };
  const std::string mosaic = "\x06\x01\x03\0\x01\0\0\0\x23\x80\0\0"s, dng = "\x12\xc6\x01\0\x04\0\0\0\x01\x04\0\0"s,
                    preview = "\xfe\0\x04\0\x01\0\0\0\x01\0\0\0"s, make = "\x0f\x01\x02\0\x06\0\0\0\x40\0\0\0"s,
                    parts = "\x4a\x01\x04\0\x02\0\0\0\x40\0\0\0"s;
  const std::vector<std::string> files{tiff(mosaic, 1),
                                       tiff(dng, 1),
                                       tiff(preview + make + parts, 3),
                                       "II*\0\x10\0\0\0CR\2\0"s,
                                       "FUJIFILMCCD-RAW 0201"s,
                                       "IIRO\x08\0\0\0"s,
                                       "IIU\0\x08\0\0\0"s,
                                       "\0\0\0\x18"
                                       "ftypcrx \0\0\0\1"s};
  for (const std::string& file : files) EXPECT_THAT(readImageHeader(file).problem, HasSubstr("a raw file of a camera"));
  EXPECT_THAT(readImageHeader(tiff(preview, 1)).problem, Not(HasSubstr("raw")));
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/scene/scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr float kFloat = 1e-6f;  // a few ulp of float32 at 1

Frame frameOf(int width, int height) {
  Frame f;
  f.id = "a";
  f.camera.width = width;
  f.camera.height = height;
  return f;
}

/// 4 x 3, every pixel its own colour (blue, green, red as OpenCV stores it).
cv::Mat picture(int depth, double largest) {
  cv::Mat m(3, 4, CV_MAKETYPE(depth, 3));
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x)
      for (int c = 0; c < 3; ++c) {
        const double v = (12.0 * y + 3 * x + c + 1) / 40 * largest;
        if (depth == CV_8U) m.ptr<uchar>(y)[3 * x + c] = uchar(v);
        if (depth == CV_16U) m.ptr<ushort>(y)[3 * x + c] = ushort(v);
        if (depth == CV_32F) m.ptr<float>(y)[3 * x + c] = float(v);
      }
  return m;
}

// The standard's own worked values: code 128 is 0.2158605 in linear light, code 10 lies on the straight part (10 / 255 / 12.92).
TEST(ReadLinear, EightBitGoesThroughTheInverseSrgbCurveAndKeepsRedFirst) {
  const TemporaryFolder folder;
  cv::Mat m(3, 4, CV_8UC3, cv::Scalar(10, 128, 64));  // blue, green, red
  Frame f = frameOf(4, 3);
  f.image = folder / "x.png";
  ASSERT_TRUE(cv::imwrite(f.image.string(), m));
  const Outcome<Image> image = readLinear(f, FrameSource::Image);
  ASSERT_TRUE(image) << image.failure().message();
  EXPECT_EQ(image->channels, 3);
  EXPECT_NEAR(image->at(1, 2, 0), 0.0512695f, kFloat);  // code 64
  EXPECT_NEAR(image->at(1, 2, 1), 0.2158605f, kFloat);
  EXPECT_NEAR(image->at(1, 2, 2), 10 / 255.f / 12.92f, kFloat);
}

TEST(ReadLinear, PixelsStayWhereTheyAre) {
  const TemporaryFolder folder;
  Frame f = frameOf(4, 3);
  for (const char* name : {"x.tiff", "x.exr"}) {
    const cv::Mat m = picture(CV_32F, 2);
    f.radiance = folder / name;
    ASSERT_TRUE(
        cv::imwrite(f.radiance.string(), m, {cv::IMWRITE_TIFF_COMPRESSION, 1, cv::IMWRITE_EXR_TYPE, cv::IMWRITE_EXR_TYPE_FLOAT}));
    const Outcome<Image> image = readLinear(f, FrameSource::Radiance);
    ASSERT_TRUE(image) << name << image.failure().message();
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 4; ++x)
        for (int c = 0; c < 3; ++c) EXPECT_EQ(image->at(x, y, c), m.ptr<float>(y)[3 * x + 2 - c]) << name;
  }
}

TEST(ReadLinear, SixteenBitUsesAllItsBits) {
  const TemporaryFolder folder;
  cv::Mat m(3, 4, CV_16UC1, cv::Scalar(32896));  // 128 / 255 of 65535
  Frame f = frameOf(4, 3);
  f.image = folder / "x.png";
  ASSERT_TRUE(cv::imwrite(f.image.string(), m));
  const Outcome<Image> image = readLinear(f, FrameSource::Image);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->channels, 1);
  EXPECT_NEAR(image->at(0, 0), 0.2158605f, kFloat);
}

TEST(ReadLinear, RadianceIsTheDefaultAndTheOnlyOneIsTaken) {
  const TemporaryFolder folder;
  Frame f = frameOf(4, 3);
  f.image = folder / "x.png";
  f.radiance = folder / "x.tiff";
  ASSERT_TRUE(cv::imwrite(f.image.string(), cv::Mat(3, 4, CV_8UC1, cv::Scalar(255))));
  ASSERT_TRUE(cv::imwrite(f.radiance.string(), cv::Mat(3, 4, CV_32FC1, cv::Scalar(7)), {cv::IMWRITE_TIFF_COMPRESSION, 1}));
  EXPECT_EQ(readLinear(f, FrameSource::Radiance)->at(0, 0), 7.f);
  EXPECT_NEAR(readLinear(f, FrameSource::Image)->at(0, 0), 1.f, kFloat);
  Frame only = f;
  only.radiance.clear();
  EXPECT_NEAR(readLinear(only, FrameSource::Radiance)->at(0, 0), 1.f, kFloat);
  only.image.clear();
  EXPECT_EQ(readLinear(only, FrameSource::Radiance).failure().reason, Reason::FrameUnreadable);
}

TEST(ReadLinear, NotFiniteRadianceIsPassedOnForDetectionToCount) {
  const TemporaryFolder folder;
  Frame f = frameOf(4, 3);
  f.radiance = folder / "x.tiff";
  cv::Mat m(3, 4, CV_32FC1, cv::Scalar(1));
  m.at<float>(1, 2) = std::numeric_limits<float>::quiet_NaN();
  ASSERT_TRUE(cv::imwrite(f.radiance.string(), m, {cv::IMWRITE_TIFF_COMPRESSION, 1}));
  EXPECT_TRUE(std::isnan(readLinear(f, FrameSource::Radiance)->at(2, 1)));
}

TEST(ReadLinear, BadFilesAreNamedWithTheReason) {
  const TemporaryFolder folder;
  for (const char* extension : {".png", ".jpg", ".tiff", ".exr"}) {
    const bool isFloat = std::string(extension) == ".tiff" || std::string(extension) == ".exr";
    const fs::path whole = folder / (std::string("whole") + extension);
    cv::Mat noise(48, 64, isFloat ? CV_32FC3 : CV_8UC3);
    cv::randu(noise, 0, isFloat ? 1 : 255);
    ASSERT_TRUE(cv::imwrite(whole.string(), noise));
    Frame f = frameOf(64, 48);
    const auto failureOf = [&](const fs::path& file) {
      f.image = file;
      const Outcome<Image> image = readLinear(f, FrameSource::Image);
      if (image) {
        ADD_FAILURE() << file << " was read";
        return std::string();
      }
      EXPECT_EQ(image.failure().reason, Reason::FrameUnreadable);
      EXPECT_THAT(image.failure().detail, HasSubstr(file.string()));
      EXPECT_EQ(image.failure().detail.find('\n'), std::string::npos);
      return image.failure().detail;
    };
    f.image = whole;
    ASSERT_TRUE(readLinear(f, FrameSource::Image)) << extension;
    testing::internal::CaptureStderr();
    const std::string bytes = contentOf(whole);
    for (const double part : {0.2, 0.6, 0.98})
      failureOf(folder.write(std::string("cut") + extension, bytes.substr(0, std::size_t(part * double(bytes.size())))));
    EXPECT_THAT(failureOf(folder.write(std::string("empty") + extension, "")), HasSubstr("empty"));
    failureOf(folder.write(std::string("text") + extension, "hello"));
    EXPECT_THAT(failureOf(folder / (std::string("missing") + extension)), HasSubstr("No such file"));
    f.camera.width = 65;
    EXPECT_THAT(failureOf(whole), HasSubstr("64 x 48 pixels, the camera 65 x 48"));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << extension;  // the decoders' own chatter
  }
}

TEST(ReadDepth, IntegerNeedsAScaleAndNothingIsZero) {
  const TemporaryFolder folder;
  Frame f = frameOf(4, 3);
  f.depth = folder / "d.png";
  cv::Mat m(3, 4, CV_16UC1, cv::Scalar(5000));
  m.at<ushort>(0, 0) = 0;
  ASSERT_TRUE(cv::imwrite(f.depth.string(), m));
  const auto refused = readDepth(f);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.failure().detail, HasSubstr("depth_scale"));
  f.depthScale = 1.0 / 5000;
  const auto depth = readDepth(f);
  ASSERT_TRUE(depth && *depth);
  EXPECT_NEAR((*depth)->at(1, 1), 1.f, kFloat);
  EXPECT_EQ((*depth)->at(0, 0), 0.f);
  EXPECT_FALSE(*readDepth(frameOf(4, 3)));
}

TEST(ReadNormals, SixteenBitCodesHaveAnExactZero) {
  const TemporaryFolder folder;
  Frame f = frameOf(4, 3);
  f.normals = folder / "n.png";
  ASSERT_TRUE(cv::imwrite(f.normals.string(), cv::Mat(3, 4, CV_16UC3, cv::Scalar(65532, 32766, 0))));  // z y x
  const auto normals = readNormals(f);
  ASSERT_TRUE(normals && *normals);
  EXPECT_EQ((*normals)->at(0, 0, 0), -1.f);
  EXPECT_EQ((*normals)->at(0, 0, 1), 0.f);
  EXPECT_EQ((*normals)->at(0, 0, 2), 1.f);
}

TEST(ReadMask, NonZeroIsGlossy) {
  const TemporaryFolder folder;
  Frame f = frameOf(4, 3);
  f.mask = folder / "m.png";
  cv::Mat m(3, 4, CV_8UC3, cv::Scalar(0, 0, 0));
  m.at<cv::Vec3b>(1, 2) = {0, 1, 0};
  ASSERT_TRUE(cv::imwrite(f.mask.string(), m));
  const auto mask = readMask(f);
  ASSERT_TRUE(mask && *mask);
  EXPECT_EQ((*mask)->channels, 1);
  EXPECT_EQ((*mask)->at(2, 1), 1.f);
  EXPECT_EQ((*mask)->at(0, 0), 0.f);
}

TEST(ReadPhotograph, IsSrgbWithThreeChannelsWhateverTheSource) {
  const TemporaryFolder folder;
  Frame f = frameOf(4, 3);
  f.image = folder / "x.png";
  ASSERT_TRUE(cv::imwrite(f.image.string(), cv::Mat(3, 4, CV_8UC1, cv::Scalar(128))));
  const auto photograph = readPhotograph(f);
  ASSERT_TRUE(photograph);
  EXPECT_EQ(photograph->channels, 3);
  EXPECT_NEAR(photograph->at(3, 2, 1), 128 / 255.f, kFloat);
  Frame r = frameOf(4, 3);
  r.radiance = folder / "x.tiff";
  cv::Mat m(3, 4, CV_32FC1, cv::Scalar(5));
  m.at<float>(0, 0) = std::numeric_limits<float>::infinity();
  ASSERT_TRUE(cv::imwrite(r.radiance.string(), m, {cv::IMWRITE_TIFF_COMPRESSION, 1}));
  const auto toneMapped = readPhotograph(r);
  ASSERT_TRUE(toneMapped);
  EXPECT_EQ(toneMapped->channels, 3);
  for (const float v : toneMapped->data) EXPECT_TRUE(v >= 0 && v <= 1);
  EXPECT_NEAR(toneMapped->at(1, 1, 0), 1.f, kFloat);
}

}  // namespace
}  // namespace glint

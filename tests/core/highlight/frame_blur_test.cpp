// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/frame_blur.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "highlight_images.h"

/// Blur of edges against images that OpenCV blurred at eight times the resolution: a Gaussian of known width and a path of known
/// length.
namespace glint::frame_blur_test {
namespace {

constexpr int kFine = 8, kSize = 200;

/// A disc, bright on dark, with edges in all directions.
cv::Mat fineDisc(double radius) {
  cv::Mat fine(kSize * kFine, kSize * kFine, CV_32F, cv::Scalar(0.2));
  cv::circle(fine, {kSize * kFine / 2, kSize * kFine / 2}, static_cast<int>(radius * kFine), cv::Scalar(0.8), cv::FILLED);
  return fine;
}

Image photographed(cv::Mat fine, double sigma, double motion, double rad) {
  if (motion > 0) {
    const int reach = static_cast<int>(std::ceil(motion * kFine / 2)) + 1;
    cv::Mat path = cv::Mat::zeros(2 * reach + 1, 2 * reach + 1, CV_32F);
    constexpr int kSteps = 400;
    for (int k = 0; k < kSteps; ++k) {
      const double t = ((k + 0.5) / kSteps - 0.5) * motion * kFine;
      path.at<float>(reach + static_cast<int>(std::lround(t * std::sin(rad))),
                     reach + static_cast<int>(std::lround(t * std::cos(rad)))) += 1.f / kSteps;
    }
    cv::filter2D(fine, fine, -1, path, {-1, -1}, 0, cv::BORDER_REPLICATE);
  }
  if (sigma > 0) cv::GaussianBlur(fine, fine, {}, sigma * kFine, sigma * kFine, cv::BORDER_REPLICATE);
  cv::Mat small;
  cv::resize(fine, small, {kSize, kSize}, 0, 0, cv::INTER_AREA);
  Image image(kSize, kSize, 1);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) image.at(x, y) = small.at<float>(y, x);
  return image;
}

double turned(double a, double b) { return std::abs(std::remainder(a - b, M_PI)); }

TEST(MeasureBlur, NominalDefocusAndMotion) {
  for (const double sigma : {0.0, 1.0, 2.0}) {
    const Outcome<FrameBlur> blur = measureBlur(photographed(fineDisc(70), sigma, 0, 0), 0);
    ASSERT_TRUE(blur) << blur.failure().message();
    EXPECT_NEAR(blur->sigmaPx, sigma, 0.12 + (sigma == 0 ? 0.1 : 0)) << sigma;
    EXPECT_EQ(blur->motionPx, 0) << sigma;
  }
  for (const double rad : {0.3, 1.2, 2.5}) {
    const Outcome<FrameBlur> blur = measureBlur(photographed(fineDisc(70), 0.8, 6, rad), 0);
    ASSERT_TRUE(blur) << blur.failure().message();
    EXPECT_NEAR(blur->motionPx, 6, 0.6) << rad;
    EXPECT_LT(turned(blur->directionRad, rad), 0.08) << rad;
    EXPECT_NEAR(blur->sigmaPx, 0.8, 0.3) << rad;
  }
}

TEST(MeasureBlur, ScaleOfValuesAndOfBlur) {
  Image image = photographed(fineDisc(70), 1.5, 0, 0);
  const Outcome<FrameBlur> once = measureBlur(image, 0);
  for (float& v : image.data) v *= 1e-4f;
  const Outcome<FrameBlur> dim = measureBlur(image, 0);
  ASSERT_TRUE(once && dim);
  EXPECT_NEAR(dim->sigmaPx, once->sigmaPx, 1e-3);
  const Outcome<FrameBlur> long_ = measureBlur(photographed(fineDisc(60), 1, 14, 0.7), 0);
  ASSERT_TRUE(long_);
  EXPECT_NEAR(long_->motionPx, 14, 1.4);
}

TEST(MeasureBlur, NoiseOfAPercent) {
  for (const double motion : {0.0, 6.0}) {
    Image image = photographed(fineDisc(70), 1.2, motion, 0.5);
    test::addNoise(image, 0.006, 7);
    const Outcome<FrameBlur> blur = measureBlur(image, 0);
    ASSERT_TRUE(blur) << blur.failure().message();
    EXPECT_NEAR(blur->motionPx, motion, 1.2);
    EXPECT_NEAR(blur->sigmaPx, 1.2, 0.4);
  }
}

TEST(MeasureBlur, DegenerateWhereThereAreNoEdgesOrOneDirection) {
  const Image flat(100, 100, 1, 0.5f);
  const Image oneEdge = test::drawn(100, 100, [](const Pixel& p) { return p.x() < 50 ? 0.1 : 0.9; });
  const Image tiny(5, 5, 1, 0.5f);
  Image clipped = photographed(fineDisc(70), 1, 0, 0);
  const Image shading = test::drawn(200, 200, [](const Pixel& p) { return 0.2 + 0.002 * p.norm(); });
  for (const Image& image : {flat, oneEdge, tiny, shading}) {
    const Outcome<FrameBlur> blur = measureBlur(image, 0);
    ASSERT_FALSE(blur);
    EXPECT_EQ(blur.failure().reason, Reason::TooFewPoints);
  }
  EXPECT_TRUE(measureBlur(clipped, 0.9));
  EXPECT_FALSE(measureBlur(clipped, 0.75));  // every edge touches clipped pixels
  for (int x = 0; x < 200; ++x) clipped.at(x, 60) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(measureBlur(clipped, 0));
}

}  // namespace
}  // namespace glint::frame_blur_test

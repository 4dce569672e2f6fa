// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/image.h"
#include "core/highlight/highlight.h"
#include "tests/shared_data.h"

/// Photographs of a ball in daylight: the large clipped highlight at levels that differ by 10 %. The bounds are those of an ideal
/// Gaussian lobe, as docs/make_real.py has them.
namespace glint::gymball_test {
namespace {

namespace fs = std::filesystem;

const fs::path kGymball = fs::path(GLINT_SHARED_DIR) / "data" / "gymball";

std::optional<Highlight> largestHighlight(const Image& image, double level) {
  DetectOptions options;
  options.level = level;
  options.clipValue = 1;
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, options);
  if (!found) return std::nullopt;
  return *std::max_element(found->begin(), found->end(), [](const auto& a, const auto& b) { return a.areaPx2 < b.areaPx2; });
}

double overlap(const Polyline& a, const Polyline& b, const cv::Size& size) {
  cv::Mat masks[2];
  for (int i = 0; i < 2; ++i) {
    masks[i] = cv::Mat::zeros(size, CV_8U);
    std::vector<cv::Point> corners;
    for (const Pixel& p : (i == 0 ? a : b).points)
      corners.emplace_back(int(std::lround(p.x() * 256)), int(std::lround(p.y() * 256)));
    cv::fillPoly(masks[i], std::vector{corners}, cv::Scalar(255), cv::LINE_8, 8);
  }
  return double(cv::countNonZero(masks[0] & masks[1])) / cv::countNonZero(masks[0] | masks[1]);
}

TEST(Gymball, EveryLargeHighlightIsFoundAndStableWhenTheLevelChangesByATenth) {
  GLINT_NEEDS_SHARED_DATA();
  const double axes = 1 - std::sqrt(std::log(0.55) / std::log(0.5)), area = std::log(0.55) / std::log(0.5);
  int images = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(kGymball)) {
    if (entry.path().extension() != ".png") continue;
    ++images;
    const std::string name = entry.path().stem().string();
    const cv::Mat read = cv::imread(entry.path().string(), cv::IMREAD_COLOR);
    Image image(read.cols, read.rows, 3);
    for (int y = 0; y < read.rows; ++y)
      for (int x = 0; x < read.cols; ++x)
        for (int c = 0; c < 3; ++c)
          image.at(x, y, c) = static_cast<float>(linearFromSrgb(read.at<cv::Vec3b>(y, x)[2 - c] / 255.0));
    const std::optional<Highlight> middle = largestHighlight(image, 0.5);
    ASSERT_TRUE(middle && middle->ellipse) << name;
    EXPECT_TRUE(middle->clipped) << name;
    for (const double level : {0.45, 0.55}) {
      const std::optional<Highlight> other = largestHighlight(image, level);
      ASSERT_TRUE(other && other->ellipse) << name;
      EXPECT_LT((other->ellipse->centre - middle->ellipse->centre).norm(), 0.02 * middle->ellipse->semiAxes.x())
          << name << " " << level;
      for (int k = 0; k < 2; ++k)
        EXPECT_NEAR(other->ellipse->semiAxes[k] / middle->ellipse->semiAxes[k], 1, axes) << name << " " << level;
      EXPECT_GT(overlap(other->contour, middle->contour, read.size()), area) << name << " " << level;
    }
  }
  EXPECT_EQ(images, 16);
}

}  // namespace
}  // namespace glint::gymball_test

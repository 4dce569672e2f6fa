// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "core/base/image.h"
#include "core/pipeline/inspection.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/shared_data.h"

/// Photographs of a path tracer, whose sRGB codes are written again through another curve.
namespace glint::response_check_tests {
namespace {

using namespace testing_support;

/// What the fit says of the response, where the codes are light to the power of 1 / gamma; 0: as they are.
std::string saidOf(double gamma) {
  const TemporaryFolder folder;
  Scene scene = readScene(std::filesystem::path(GLINT_SHARED_DIR) / "data/cycles/sphere/scene-analytic.json");
  for (Frame& frame : scene.frames) {
    frame.radiance.clear();
    if (gamma == 0) continue;
    cv::Mat codes = cv::imread(frame.image.string(), cv::IMREAD_COLOR);
    for (int y = 0; y < codes.rows; ++y)
      for (int x = 0; x < codes.cols; ++x)
        for (int c = 0; c < 3; ++c) {
          unsigned char& code = codes.at<cv::Vec3b>(y, x)[c];
          code = static_cast<unsigned char>(std::lround(255 * std::pow(linearFromSrgb(code / 255.0), 1 / gamma)));
        }
    frame.image = folder / (frame.id + ".png");
    cv::imwrite(frame.image.string(), codes);
  }
  InspectionRequest request;
  request.models = {"limit-angle"};
  request.train = "spread:4";
  request.source = FrameSource::Image;
  const Inspection r = inspect(std::make_shared<const Scene>(std::move(scene)), request);
  const Outcome<ModelFit>& fit = r.models.at("limit-angle").fits.at(0).fit;
  if (!fit) return fit.failure().message();
  for (const std::string& remark : fit->remarks)
    if (remark.find("no response of the camera") != std::string::npos) return remark;
  return "";
}

TEST(ResponseDoubt, LinearCodesAndAPowerAreNamedAndSrgbIsNot) {
  GLINT_NEEDS_SHARED_DATA();
  EXPECT_EQ(saidOf(0), "");
  EXPECT_NE(saidOf(1).find("\"response\": \"linear\""), std::string::npos) << saidOf(1);
  EXPECT_NE(saidOf(1.8).find("\"response\": \"gamma:1.8\""), std::string::npos) << saidOf(1.8);
}

}  // namespace
}  // namespace glint::response_check_tests

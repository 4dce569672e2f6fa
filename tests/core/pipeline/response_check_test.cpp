// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <locale>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <sstream>
#include <string>

#include "core/base/image.h"
#include "core/pipeline/inspection.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/shared_data.h"

/// Photographs of a path tracer, whose sRGB codes are written again through another curve.
namespace glint::response_check_tests {
namespace {

using namespace testing_support;

using Recode = std::function<double(double light, double radius2)>;

/// What the fit says of response and vignetting, where codes are this function of the light and of the squared distance from the
/// middle, 1 in the corners; empty: as they are.
/// @param stated  as the scene's file says it
std::string saidOf(const Recode& recode, int frames = 4, const std::string& stated = "") {
  const TemporaryFolder folder;
  Scene scene = readScene(std::filesystem::path(GLINT_SHARED_DIR) / "data/cycles/sphere/scene-analytic.json");
  for (Frame& frame : scene.frames) {
    frame.radiance.clear();
    if (!recode) continue;
    cv::Mat codes = cv::imread(frame.image.string(), cv::IMREAD_COLOR);
    const double cx = (codes.cols - 1) / 2.0, cy = (codes.rows - 1) / 2.0;
    for (int y = 0; y < codes.rows; ++y)
      for (int x = 0; x < codes.cols; ++x)
        for (int c = 0; c < 3; ++c) {
          unsigned char& code = codes.at<cv::Vec3b>(y, x)[c];
          const double radius2 = ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (cx * cx + cy * cy);
          code =
              static_cast<unsigned char>(std::lround(255 * std::clamp(recode(linearFromSrgb(code / 255.0), radius2), 0.0, 1.0)));
        }
    if (!stated.empty()) frame.response = *CameraResponse::named(stated, "", "");
    frame.image = folder / (frame.id + ".png");
    cv::imwrite(frame.image.string(), codes);
  }
  InspectionRequest request;
  request.models = {"limit-angle"};
  request.train = "spread:" + std::to_string(frames);
  request.source = FrameSource::Image;
  const Inspection r = inspect(std::make_shared<const Scene>(std::move(scene)), request);
  const Outcome<ModelFit>& fit = r.models.at("limit-angle").fits.at(0).fit;
  if (!fit) return fit.failure().message();
  for (const std::string& remark : fit->remarks)
    if (remark.find("no response of the camera") != std::string::npos || remark.find("vignetting") != std::string::npos)
      return remark;
  return "";
}

Recode power(double gamma) {
  return [gamma](double light, double) { return std::pow(light, 1 / gamma); };
}

TEST(ResponseDoubt, LinearCodesAndPowersAreNamedAndSrgbIsNot) {
  GLINT_NEEDS_SHARED_DATA();
  EXPECT_EQ(saidOf({}), "");
  EXPECT_NE(saidOf(power(1)).find("\"response\": \"linear\""), std::string::npos) << saidOf(power(1));
  EXPECT_NE(saidOf(power(1.8)).find("\"response\": \"gamma:1.8\""), std::string::npos) << saidOf(power(1.8));
  constexpr int kViews = 6;  // gamma 2.2 is so near to sRGB that four do not tell
  const std::string near = saidOf(power(2.2), kViews);
  EXPECT_NE(near.find("\"response\": \"gamma:2.2\""), std::string::npos) << near;
}

TEST(ResponseDoubt, AnSCurveIsNamedWithItsContrast) {
  GLINT_NEEDS_SHARED_DATA();
  constexpr double contrast = 0.42;
  const std::string said = saidOf([](double light, double) {
    const double code = srgbFromLinear(light);
    return code - contrast * std::sin(2 * std::numbers::pi * code) / (2 * std::numbers::pi);
  });
  const std::string before = "\"response\": \"s-curve:";
  ASSERT_NE(said.find(before), std::string::npos) << said;
  std::istringstream number(said.substr(said.find(before) + before.size()));
  number.imbue(std::locale::classic());
  double named = 0;
  number >> named;
  EXPECT_NEAR(named, contrast, 0.02) << said;
}

/// Values that say nothing of a curve: as noise grows, nothing false is said.
TEST(ResponseDoubt, NoiseNamesNoCurve) {
  GLINT_NEEDS_SHARED_DATA();
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 4 / 255.0);
  EXPECT_EQ(saidOf([&](double light, double) { return srgbFromLinear(light) + noise(random); }), "");
}

TEST(Vignetting, IsNamedWithItsSize) {
  GLINT_NEEDS_SHARED_DATA();
  // The photographs' codes are spread first over what was rounded to them: dark light that lies on steps cannot fall by less.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> within(-0.5 / 255, 0.5 / 255);
  const auto darker = [&](double loss) {
    return Recode([&, loss](double light, double radius2) {
      return srgbFromLinear(std::max(0.0, linearFromSrgb(srgbFromLinear(light) + within(random))) * (1 - loss * radius2));
    });
  };
  for (const double loss : {0.25, 0.5}) {
    const std::string said = saidOf(darker(loss), 6), before = "about ", fix = "\"response\": \"";
    ASSERT_NE(said.find("vignetting"), std::string::npos) << said;
    EXPECT_NEAR(std::stod(said.substr(said.find(before) + before.size())), 100 * loss, 5) << said;
    const std::size_t at = said.find(fix) + fix.size();
    EXPECT_EQ(saidOf(darker(loss), 6, said.substr(at, said.find('"', at) - at)), "");  // what it names is the fix
  }
  EXPECT_EQ(saidOf(darker(0.05), 6), "");  // below what matters
}

/// Three views: too few for it.
TEST(Vignetting, FewViewsSayNothing) {
  GLINT_NEEDS_SHARED_DATA();
  EXPECT_EQ(saidOf([](double light, double radius2) { return srgbFromLinear(light * (1 - 0.4 * radius2)); }, 3), "");
}

}  // namespace
}  // namespace glint::response_check_tests

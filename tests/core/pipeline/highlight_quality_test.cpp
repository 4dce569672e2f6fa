// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/pipeline/evidence.h"
#include "tests/core/highlight/highlight_images.h"

/// Uncertainties of the contour of a round Gaussian lobe h exp(-r^2 / a^2), whose slope at radius r is 2 r v / a^2 in closed
/// form, and flags on a sphere.
namespace glint::highlight_quality_tests {
namespace {

constexpr double kA = 25;  // px

LinearPixels pixelsOf(const Image& image, double clip = 0) { return linearPixels(image, nullptr, clip); }

Image lobeImage(double height, double clip, double noise = 0) {
  Image image =
      test::drawn(220, 200, [&](const Pixel& p) { return 0.1 + height * std::exp(-((p - Pixel(110, 100)) / kA).squaredNorm()); });
  if (noise > 0) test::addNoise(image, noise, 5);
  for (float& v : image.data) v = std::min(v, static_cast<float>(clip));
  return image;
}

Highlight detected(const Image& image, double clip) {
  DetectOptions options;
  options.clipValue = clip;
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, options);
  EXPECT_TRUE(found);
  return found ? found->front() : Highlight{};
}

Frame frameOf(int width = 220, int height = 200) {
  Frame frame;
  frame.camera.pixelFromRay << 1000, 0, width / 2.0, 0, 1000, height / 2.0, 0, 0, 1;
  frame.camera.width = width;
  frame.camera.height = height;
  return frame;
}

bool hasFlag(const HighlightQuality& q, const std::string& text) {
  return std::any_of(q.flags.begin(), q.flags.end(), [&](const std::string& f) { return f.find(text) != std::string::npos; });
}

TEST(HighlightQualities, NominalAClippedContourIsLessSure) {
  const Image image = lobeImage(4, 1.1);
  const HighlightQuality q = highlightQualities(frameOf(), pixelsOf(image, 1.1), nullptr, {}, {detected(image, 1.1)}).front();
  EXPECT_TRUE(hasFlag(q, "clipped core"));
  // At half of the clip value above the background, 0.5: r = a sqrt(ln(4 / 0.5)); half of the true peak lies at a sqrt(ln 2).
  const double r = kA * std::sqrt(std::log(8.0)), truth = kA * std::sqrt(std::log(2.0));
  EXPECT_GT(q.levelPx, r - truth);
  EXPECT_LT(q.levelPx, r);
  const Image whole = lobeImage(1, 100);
  const HighlightQuality sure = highlightQualities(frameOf(), pixelsOf(whole, 100), nullptr, {}, {detected(whole, 100)}).front();
  EXPECT_TRUE(sure.flags.empty());
  EXPECT_EQ(sure.levelPx, 0);
  EXPECT_GT(q.contourSigmaPx(), sure.contourSigmaPx());
}

TEST(HighlightQualities, NoiseOverTheSlope) {
  for (const double noise : {0.005, 0.02}) {
    const Image image = lobeImage(1, 100, noise);
    const HighlightQuality q = highlightQualities(frameOf(), pixelsOf(image), nullptr, {}, {detected(image, 0)}).front();
    const double r = kA * std::sqrt(std::log(2.0)), slope = 2 * r * 0.5 / (kA * kA);
    EXPECT_NEAR(q.noisePx, noise / slope, 0.15 * noise / slope) << noise;
  }
}

TEST(HighlightQualities, ScaleOfValuesDoesNotMatter) {
  Image image = lobeImage(1, 100, 0.01);
  const HighlightQuality once = highlightQualities(frameOf(), pixelsOf(image), nullptr, {}, {detected(image, 0)}).front();
  for (float& v : image.data) v *= 1000;
  const HighlightQuality bright = highlightQualities(frameOf(), pixelsOf(image), nullptr, {}, {detected(image, 0)}).front();
  EXPECT_NEAR(bright.noisePx, once.noisePx, 1e-3 * once.noisePx);
}

/// A Gaussian lobe of width a, blurred by sigma, is one of width sqrt(a^2 + 2 sigma^2).
TEST(HighlightQualities, BlurWidensByWhatTheConvolutionSays) {
  const Image image = lobeImage(1, 100);
  FrameBlur blur;
  blur.sigmaPx = 6;
  const HighlightQuality q = highlightQualities(frameOf(), pixelsOf(image), nullptr, blur, {detected(image, 0)}).front();
  EXPECT_NEAR(q.blurPx, std::sqrt(std::log(2.0)) * (kA - std::sqrt(kA * kA - 2 * 36)), 0.02);
  EXPECT_TRUE(hasFlag(q, "no edge of the frame is sharper than a blur of 6.0 px"));
  blur.sigmaPx = 0.2;
  EXPECT_TRUE(highlightQualities(frameOf(), pixelsOf(image), nullptr, blur, {detected(image, 0)}).front().flags.empty());
  blur.motionPx = 20;
  blur.directionRad = 0.5;
  EXPECT_TRUE(hasFlag(highlightQualities(frameOf(), pixelsOf(image), nullptr, blur, {detected(image, 0)}).front(),
                      "a motion of 20.0 px along 29 degrees"));
}

TEST(HighlightQualities, SilhouettesAndStrangersOnASphere) {
  AnalyticSpec spec;
  spec.type = "sphere";
  spec.radius = 0.8;
  spec.worldFromSurface.translation() = Eigen::Vector3d(0, 0, 10);
  const std::shared_ptr<const Surface> sphere = makeAnalytic(spec);  // its outline: a circle of 80 px about (110, 100)
  const auto circle = [](double x, double y, double r) {
    Highlight h;
    h.contour = {Ellipse{{x, y}, {r, r}, 0}.sample(200), true};
    h.peak = {x, y};
    h.areaPx2 = M_PI * r * r;
    return h;
  };
  Frame frame = frameOf();
  frame.lightsOn = {"lamp"};
  const std::vector<Highlight> highlights{circle(100, 100, 12), circle(150, 120, 6), circle(183, 100, 9), circle(20, 20, 5)};
  const LinearPixels pixels = pixelsOf(lobeImage(1, 100));
  std::vector<HighlightQuality> q = highlightQualities(frame, pixels, sphere.get(), {}, highlights);
  flagStrangers(frame, *sphere, highlights, q);
  EXPECT_TRUE(q[0].flags.empty());
  EXPECT_TRUE(hasFlag(q[1], "not the lamp of the largest highlight"));
  EXPECT_TRUE(hasFlag(q[2], "at the silhouette"));
  // Two pixels outwards, at 11 px from its middle, which lies 73 px from the outline's: |(73 + 11 cos t, 11 sin t)| = R.
  const double outline = 1000 * 0.8 / std::sqrt(100 - 0.64),
               t = std::acos((outline * outline - 73 * 73 - 11 * 11) / (2 * 73 * 11));
  EXPECT_NEAR(q[2].silhouetteShare, t / M_PI, 1.5 / 72);
  EXPECT_TRUE(hasFlag(q[3], "off the surface"));
  frame.lightsOn = {"lamp", "sun"};
  q = highlightQualities(frame, pixels, sphere.get(), {}, highlights);
  flagStrangers(frame, *sphere, highlights, q);
  EXPECT_FALSE(hasFlag(q[1], "not the lamp"));
}

TEST(HighlightQualities, DegenerateContoursAndPicturesSayNothing) {
  const Highlight nothing;
  Highlight small;
  small.contour.points = {{0, 0}, {1, 0}, {1, 1}};
  for (const Image& image : {Image(1, 1, 1, 0.5f), Image(50, 50, 1, 0.5f)}) {
    const std::vector<HighlightQuality> q =
        highlightQualities(frameOf(), pixelsOf(image), nullptr, FrameBlur{}, {nothing, small});
    ASSERT_EQ(q.size(), 2u);
    for (const HighlightQuality& each : q) EXPECT_EQ(each.contourSigmaPx(), 0);
  }
}

}  // namespace
}  // namespace glint::highlight_quality_tests

// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/photograph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {

using namespace testing_support;

constexpr double kPixelPx = 0.75;     // half a pixel's diagonal: the brightest pixel's centre is no nearer to the peak
constexpr double kBlurPx = 0.05;      // bilinear interpolation of a lobe some 100 px wide, across its contour
constexpr double kFloatShare = 1e-6;  // of a float of order one

InspectionRequest synthetic(double roughness = 0.05) {
  InspectionRequest q;
  q.models = {"limit-angle"};
  q.train = "first:4";
  q.whatIf.synthesise = true;
  q.whatIf.roughness = roughness;
  return q;
}

std::shared_ptr<Scene> lit(const AnalyticSpec& surface) { return litScene(surface, 4); }

Pixel brightest(const Image& image) {
  Pixel best(0, 0);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (image.at(x, y) > image.at(int(best.x()), int(best.y()))) best = Pixel(x, y);
  return best;
}

// The peak of a narrow lobe, where masking and falloff do not count, is the mirror point: on the plane z = 0 the point that the
// camera sees in the direction of the mirrored lamp.
TEST(SynthesisedPhotograph, NominalPeakIsTheMirroredLampOfThePlane) {
  InspectionRequest q = synthetic(0.005);
  q.whatIf.lightsBy["lamp"] = Eigen::Vector3d(-0.05, 0.1, 0.2);
  const Inspection in = inspect(lit(sheet(0)), q);
  for (int frame = 0; frame < 4; ++frame) {
    const Outcome<Image> picture = linearImageOf(in, frame, FrameSource::Radiance);
    ASSERT_TRUE(picture) << picture.failure().message();
    ASSERT_EQ(picture->channels, 1);
    const std::optional<Pixel> mirrored = in.scene->frames[std::size_t(frame)].camera.project({0.05, 0.3, -1.6});
    ASSERT_TRUE(mirrored);
    EXPECT_LT((brightest(*picture) - *mirrored).norm(), kPixelPx) << frame;
  }
}

// The only lamp off: nothing shines there, and neither the exposure nor any other frame's picture changes.
TEST(SynthesisedPhotograph, NominalALightSwitchedOffShinesNoMore) {
  InspectionRequest q = synthetic();
  const auto scene = lit(sphere(0.5));
  const Inspection on = inspect(scene, q);
  constexpr int kEvery = 8;                  // pixels: enough to tell
  for (int frame = 0; frame < 4; ++frame) {  // one of them is the brightest, which the exposure is made for
    q.whatIf = switched(synthetic().whatIf, *scene, frame, "lamp", false);
    const Inspection off = inspect(scene, q);
    EXPECT_NE(pictureKey(off), pictureKey(on));
    const Outcome<Image> dark = linearImageOf(off, frame, FrameSource::Image, kEvery);
    ASSERT_TRUE(dark) << dark.failure().message();
    EXPECT_EQ(*std::max_element(dark->data.begin(), dark->data.end()), 0.0f);
    const int other = (frame + 1) % 4;
    EXPECT_EQ(linearImageOf(off, other, FrameSource::Image, kEvery)->data,
              linearImageOf(on, other, FrameSource::Image, kEvery)->data);
  }
}

// What is drawn over the picture belongs to it: along the contour the radiance is `detect.level` of the peak's.
TEST(SynthesisedPhotograph, NominalContoursAreItsLevelSets) {
  for (const AnalyticSpec& surface : {sphere(0.5), sheet(1)}) {
    const Inspection in = inspect(lit(surface), synthetic());
    double top = 0;
    for (const Frame& f : in.scene->frames) top = std::max(top, f.highlights.at(0).peakValue);
    for (int frame = 0; frame < 4; ++frame) {
      const Highlight& h = in.scene->frames[std::size_t(frame)].highlights.at(0);
      const Outcome<Image> picture = linearImageOf(in, frame, FrameSource::Radiance);
      ASSERT_TRUE(picture);
      const cv::Mat mat(picture->height, picture->width, CV_32F, const_cast<float*>(picture->data.data()));
      const double peak = kPeakValue / (1 + kMattShare) * h.peakValue / top;
      int tried = 0;
      for (const Pixel& p : h.contour.points) {
        const Pixel m = in.scene->frames[std::size_t(frame)].camera.distorted(p);
        if (m.x() < 1 || m.y() < 1 || m.x() > 638 || m.y() > 478) continue;
        cv::Mat value;
        cv::getRectSubPix(mat, {1, 1}, cv::Point2f(float(m.x()), float(m.y())), value);
        EXPECT_NEAR(value.at<float>(0, 0) / peak, h.level, h.level * kBlurPx) << frame;
        ++tried;
      }
      EXPECT_GT(tried, 10);
    }
  }
}

TEST(SynthesisedPhotograph, NominalThePhotographIsTheLobeAndAMattPart) {
  const Inspection in = inspect(lit(sphere(0.5)), synthetic());
  double brightestOfAll = 0;
  for (int frame = 0; frame < 4; ++frame) {
    const Outcome<Image> linear = linearImageOf(in, frame, FrameSource::Image), shown = photographOf(in, frame),
                         lobe = linearImageOf(in, frame, FrameSource::Radiance);
    ASSERT_TRUE(linear && shown && lobe);
    ASSERT_EQ(linear->channels, 3);
    for (std::size_t i = 0; i < linear->data.size(); i += 997) {
      const double v = linear->data[i], code = shown->data[i];
      EXPECT_GE(v, lobe->data[i / 3]);
      // The curve's own definition, IEC 61966-2-1, from the code to the light.
      EXPECT_NEAR(code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4), std::min(v, 1.0),
                  1e-5);  // its two pieces meet to 1e-6
    }
    const Pixel peak = brightest(*linear);
    brightestOfAll = std::max<double>(brightestOfAll, linear->at(int(peak.x()), int(peak.y())));
  }
  EXPECT_NEAR(brightestOfAll, kPeakValue, 5e-3);  // a pixel centre 0.7 px from the peak of a lobe with a deviation of 10 px
}

// A lamp that is twice as far gives a quarter of the light, and the exposure follows: the picture keeps its brightness.
TEST(SynthesisedPhotograph, ScaleOfTheSceneDoesNotChangeThePicture) {
  const auto scene = lit(sphere(0.5));
  const auto large = std::make_shared<Scene>(*scene);
  constexpr double kFactor = 1000;
  for (Frame& f : large->frames) f.camera.camFromWorld.translation() *= kFactor;
  AnalyticSpec ball = sphere(0.5 * kFactor);
  for (auto& [id, source] : large->surfaces) source = ball;
  large->lights[0].lamp = lampAt(scene->lights[0].lamp.position() * kFactor);
  const Outcome<Image> a = photographOf(inspect(scene, synthetic()), 1), b = photographOf(inspect(large, synthetic()), 1);
  ASSERT_TRUE(a && b);
  for (std::size_t i = 0; i < a->data.size(); i += 101) EXPECT_NEAR(a->data[i], b->data[i], 10 * kFloatShare) << i;
}

TEST(SynthesisedPhotograph, AQuickLookHasTheSamePixelsFewerTimes) {
  const Inspection in = inspect(lit(sphere(0.5)), synthetic());
  const Outcome<Image> all = photographOf(in, 2), quick = photographOf(in, 2, 5);
  ASSERT_TRUE(all && quick);
  for (int y = 0; y < 480; y += 5)
    for (int x = 0; x < 640; x += 5) {
      EXPECT_EQ(quick->at(x, y, 1), all->at(x + 2, y + 2, 1));
      EXPECT_EQ(quick->at(x + 4, y + 4, 1), all->at(x + 2, y + 2, 1));
    }
}

TEST(SynthesisedPhotograph, DegenerateNothingToExposeFor) {
  InspectionRequest q = synthetic();
  q.whatIf.lightsBy["lamp"] = Eigen::Vector3d(0, 0, -5);  // behind the plane
  const Inspection in = inspect(lit(sheet(0)), q);
  const Outcome<Image> picture = photographOf(in, 0);
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.failure().reason, Reason::NoHighlight);
}

TEST(SynthesisedPhotograph, DegenerateRequests) {
  const Inspection in = inspect(lit(sphere(0.5)), synthetic());
  EXPECT_THROW((void)photographOf(in, 4), std::invalid_argument);
  EXPECT_THROW((void)photographOf(in, 0, 0), std::invalid_argument);
  EXPECT_THROW((void)photographOf(in, 0, 1, [](const StageEvent&) { return false; }), Stopped);
}

TEST(SynthesisedPhotograph, WithoutSynthesisItIsWhatWasCaptured) {
  InspectionRequest q = synthetic();
  q.whatIf = {};
  q.whatIf.poses[1].translation = {0.01, 0, 0};  // the scene changes, its pictures do not
  const Inspection in = inspect(lit(sphere(0.5)), q);
  EXPECT_FALSE(picturesAreSynthesised(in));
  const Outcome<Image> picture = photographOf(in, 1), linear = linearImageOf(in, 1, FrameSource::Radiance);
  ASSERT_FALSE(picture);  // this scene has no files
  EXPECT_EQ(picture.failure().reason, Reason::FrameUnreadable);
  EXPECT_EQ(linear.failure().message(), readLinear(in.given->frames[1], FrameSource::Radiance).failure().message());
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// What highlights tell about images and intrinsics. The contours are exact ones of the true cameras; then the scene is told
// something else.
#include "core/advise/camera_check.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <random>
#include <sstream>
#include <vector>

#include "core/scene/scene.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/sanitizers/cases.h"
#include "tests/shared_data.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TrueLight pointLamp() {
  TrueLight lamp;
  lamp.id = "lamp";
  lamp.lamp = lampAt(Eigen::Vector3d(1.2, -1.0, 2.2));
  return lamp;
}
TrueLight ballLamp() {
  TrueLight lamp = pointLamp();
  lamp.lamp = withRadius(lamp.lamp, 0.15);
  return lamp;
}
TrueLight tubeLamp() {
  TrueLight lamp;
  lamp.id = "lamp";
  lamp.lamp = segmentLamp(Eigen::Vector3d(0.9, -1.2, 2.2), Eigen::Vector3d(1.5, -0.8, 2.2));
  return lamp;
}

/// An orbit of ten cameras around a glossy body, with the contours that another lobe and light give exactly.
Scene orbit(const AnalyticSpec& body, int frames = 10, double noisePx = 0, const TrueLight& lamp = pointLamp()) {
  Scene scene;
  scene.name = "orbit";
  scene.surfaces["body"] = body;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 1);
  for (int i = 0; i < frames; ++i) {
    Frame f;
    f.id = std::to_string(i);
    f.surface = "body";
    const double a = -2.2 + 3.0 * i / std::max(1, frames - 1);
    f.camera = lookingAt({2 * std::cos(a), 2 * std::sin(a), 0.9}, {0, 0, 0});
    const Outcome<std::vector<Highlight>> exact =
        exactHighlights(*makeAnalytic(body), f.camera, lamp, Material{}, ExactOptions{});
    if (exact) f.highlights = *exact;
    for (Highlight& h : f.highlights) {
      h.light = "lamp";
      h.fromScene = true;
      for (Pixel& p : h.contour.points) p += noisePx * Pixel(noise(random), noise(random));
    }
    scene.frames.push_back(std::move(f));
  }
  return scene;
}

// The lobe that fits best beside wrong cameras takes in a part of their error: up to a quarter was measured (0.13 px, 0.27 %).
constexpr double kShiftPx = 0.18, kFocalPct = 0.35;

AnalyticSpec ellipsoid() {
  AnalyticSpec s;
  s.type = "ellipsoid";
  s.semiAxes = {0.6, 0.35, 0.25};
  return s;
}
AnalyticSpec ball() {
  AnalyticSpec s;
  s.type = "sphere";
  s.radius = 0.5;
  return s;
}

Scene withCameras(Scene scene, const std::function<void(Camera&)>& change) {
  for (Frame& f : scene.frames) change(f.camera);
  return scene;
}

TEST(CameraCheck, GoodCamerasAreLeftAlone) {
  for (const AnalyticSpec& body : cases<AnalyticSpec>({ellipsoid(), ball()}))
    for (const double noise : cases<double>({0.3, 0.0})) {
      const CameraCheck check = checkCameras(orbit(body, 10, noise));
      EXPECT_EQ(check.views, 8) << check.whyNot;
      EXPECT_THAT(check.findings, IsEmpty()) << body.type << " " << noise;
    }
}

/// What calibrations leave: nothing to alarm about.
TEST(CameraCheck, SmallErrorsAreLeftAlone) {
  const Scene scene = orbit(ellipsoid());
  EXPECT_THAT(checkCameras(withCameras(scene, [](Camera& c) { c.pixelFromRay.topLeftCorner<2, 2>() *= 1.001; })).findings,
              IsEmpty());
  EXPECT_THAT(checkCameras(withCameras(scene, [](Camera& c) { c.pixelFromRay(0, 2) += 0.1; })).findings, IsEmpty());
}

TEST(CameraCheck, HalfAPixel) {
  for (const AnalyticSpec& body : cases<AnalyticSpec>({ellipsoid(), ball()})) {
    const double noise = body.type == "sphere" ? 0 : 0.05;
    const Scene scene = orbit(body, 10, noise);
    const auto shifted = [&](double by) {
      return checkCameras(withCameras(scene, [&](Camera& c) { c.pixelFromRay.topRightCorner<2, 1>().array() += by; }));
    };
    const CameraCheck corner = shifted(0.5), twice = shifted(-0.5);
    EXPECT_THAT(corner.findings, ElementsAre(HasSubstr("half a pixel off"))) << body.type << noise;
    EXPECT_THAT(corner.findings, Each(HasSubstr("-0.5 px added to cx and cy")));
    EXPECT_THAT(corner.findings, Each(HasSubstr("COLMAP")));
    EXPECT_THAT(twice.findings, ElementsAre(HasSubstr("+0.5 px added to cx and cy"))) << body.type << noise;
    ASSERT_TRUE(corner.shiftPx && twice.shiftPx);
    EXPECT_NEAR(*corner.shiftPx, -0.5, kShiftPx);
    EXPECT_NEAR(*twice.shiftPx, 0.5, kShiftPx);
  }
}

TEST(CameraCheck, FocalLengthOfOnePercent) {
  for (const double pct : cases<double>({1.0, -1.0})) {
    const CameraCheck check =
        checkCameras(withCameras(orbit(ellipsoid()), [&](Camera& c) { c.pixelFromRay.topLeftCorner<2, 2>() *= 1 + pct / 100; }));
    EXPECT_THAT(check.findings, ElementsAre(HasSubstr(pct > 0 ? "% shorter" : "% longer")));
    ASSERT_TRUE(check.focalPct);
    EXPECT_NEAR(*check.focalPct, -pct, kFocalPct);
  }
}

/// The shape of the lamp is searched for the cameras as given, and kept for changed intrinsics.
TEST(CameraCheck, ALampWithASizeOrALengthIsNoFault) {
  for (const TrueLight& lamp : cases<TrueLight>({ballLamp(), tubeLamp()})) {
    const CameraCheck check = checkCameras(orbit(ellipsoid(), 10, 0, lamp));
    EXPECT_EQ(check.views, 8) << check.whyNot;
    EXPECT_THAT(check.findings, IsEmpty()) << nameOf(lamp.lamp.shape);
  }
}

/// As a point the tube leaves more than the wrong focal length does.
TEST(CameraCheck, FocalLengthUnderALampWithASizeOrALength) {
  for (const TrueLight& lamp : cases<TrueLight>({ballLamp(), tubeLamp()})) {
    const CameraCheck check = checkCameras(
        withCameras(orbit(ellipsoid(), 10, 0, lamp), [](Camera& c) { c.pixelFromRay.topLeftCorner<2, 2>() *= 1.01; }));
    EXPECT_THAT(check.findings, ElementsAre(HasSubstr("% shorter"))) << nameOf(lamp.lamp.shape);
    EXPECT_NEAR(check.focalPct.value_or(0), -1, kFocalPct) << nameOf(lamp.lamp.shape);
  }
}

TEST(CameraCheck, MirroredImages) {
  for (const bool upsideDown : cases<bool>({false, true})) {
    Scene scene = orbit(ellipsoid());
    for (Frame& f : scene.frames)
      for (Highlight& h : f.highlights) {
        const auto turn = [&](Pixel& p) {
          if (upsideDown)
            p.y() = f.camera.height - 1 - p.y();
          else
            p.x() = f.camera.width - 1 - p.x();
        };
        turn(h.peak);
        for (Pixel& p : h.contour.points) turn(p);
        std::reverse(h.contour.points.begin(), h.contour.points.end());
      }
    EXPECT_THAT(checkCameras(scene).findings, ElementsAre(HasSubstr(upsideDown ? "the images are mirrored upside down"
                                                                               : "the images are mirrored left-right")));
  }
}

Highlight disc(const Pixel& middle, double radius) {
  Highlight h;
  h.light = "lamp";
  h.level = 0.5;
  h.fromScene = true;
  h.peak = middle;
  for (int i = 0; i < 40; ++i)
    h.contour.points.push_back(middle + radius * Pixel(std::cos(EIGEN_PI * i / 20), std::sin(EIGEN_PI * i / 20)));
  return h;
}

/// A lamp on a wall beside the body, and a window that it mirrors elsewhere: the lamp that all frames share counts, its cameras
/// are checked.
TEST(CameraCheck, OtherHighlightsInTheFrames) {
  Scene scene = orbit(ellipsoid());
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    Frame& f = scene.frames[i];
    const Pixel middle(f.camera.width / 2.0, f.camera.height / 2.0);
    f.highlights.insert(f.highlights.begin(), disc({20, 20}, 15));
    f.highlights.push_back(disc(middle + Pixel(9.0 * double(i % 3) - 9, 7.0 * double(i % 4) - 9), 12));
  }
  const CameraCheck right = checkCameras(scene);
  EXPECT_EQ(right.views, 8) << right.whyNot;
  EXPECT_THAT(right.findings, IsEmpty());
  EXPECT_LT(right.missDeg.value_or(90), 2);
  const CameraCheck longer = checkCameras(withCameras(scene, [](Camera& c) { c.pixelFromRay.topLeftCorner<2, 2>() *= 1.01; }));
  EXPECT_THAT(longer.findings, ElementsAre(HasSubstr("% shorter")));
}

/// The mesh beside its place: the cameras are moved in place of it. How far is found to a hundredth of its size.
TEST(CameraCheck, ShiftedSurface) {
  for (const Eigen::Vector3d& shift :
       {Eigen::Vector3d(0.1, -0.05, 0.08), Eigen::Vector3d(-0.04, -0.03, 0), Eigen::Vector3d(0, 0.06, -0.05)}) {
    const CameraCheck check = checkCameras(withCameras(orbit(ellipsoid()), [&](Camera& c) {
      c.camFromWorld = c.camFromWorld * Eigen::Translation3d(-shift);  // its centre moves by the shift
    }));
    ASSERT_THAT(check.findings, ElementsAre(HasSubstr("the mesh seems to be shifted by ("))) << shift.transpose();
    const std::string& words = check.findings.front();
    Eigen::Vector3d found;
    std::istringstream numbers(words.substr(words.find('(') + 1));  // with a point, whatever the locale
    char comma = ',';
    ASSERT_TRUE(numbers >> found.x() >> comma >> found.y() >> comma >> found.z()) << words;
    constexpr double kSize = 1.476;  // m, of the ellipsoid's box
    EXPECT_LT((found + shift).norm(), 0.01 * kSize) << words << " " << shift.transpose();
  }
}

TEST(CameraCheck, SaysWhyItCannotTell) {
  EXPECT_THAT(checkCameras(orbit(ellipsoid(), 3)).whyNot, HasSubstr("3 frames show a whole highlight"));
  Scene depth = orbit(ellipsoid());
  for (Frame& f : depth.frames) f.surface.clear();
  EXPECT_THAT(checkCameras(depth).whyNot, HasSubstr("0 frames"));
  Scene two = orbit(ellipsoid(), 6);
  for (std::size_t i = 0; i < two.frames.size(); i += 2) two.frames[i].highlights.front().light = "other";
  EXPECT_THAT(checkCameras(two).whyNot, HasSubstr("different lights"));
  EXPECT_THROW(checkCameras(orbit(ellipsoid()), [](const StageEvent&) { return false; }), Stopped);
}

TEST(CameraCheck, FramesThatDoNotShareTheLampAreNamed) {
  Scene scene = orbit(ellipsoid(), 8);
  std::swap(scene.frames[2].camera, scene.frames[5].camera);
  const CameraCheck check = checkCameras(scene);
  ASSERT_THAT(check.findings, ElementsAre(HasSubstr("the highlights of 6 frames share one lamp; those of 2 do not")));
  EXPECT_THAT(check.findings.front(), AllOf(HasSubstr(scene.frames[2].id), HasSubstr(scene.frames[5].id)));
}

/// What evaluations take off, or smooth, is no mistake of the scene.
TEST(CameraCheck, TextureAndNoiseOfAMeshAreSaidAsWhatTheyAre) {
  GLINT_NEEDS_SHARED_DATA();
  const auto checked = [](const char* name) {
    return checkCameras(readScene(std::filesystem::path(GLINT_SHARED_DIR) / "data/exact" / name / "scene.json"));
  };
  for (const char* textured : {"checker", "wood"}) {
    const CameraCheck check = checked(textured);
    EXPECT_THAT(check.findings, IsEmpty()) << textured;
    EXPECT_THAT(check.whyNot, HasSubstr("the surface is textured")) << textured;
  }
  EXPECT_THAT(checked("noise1mm").findings, ElementsAre(HasSubstr("the mesh has noise of 0.0012 m")));
}

}  // namespace
}  // namespace glint

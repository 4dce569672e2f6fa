// SPDX-License-Identifier: BSD-3-Clause
// A dome's lamps as the scene states them, right and wrong, against exact contours.
#include "core/advise/known_lamp_check.h"

#include <gmock/gmock.h>

#include "tests/core/pipeline/exact_scene.h"

namespace glint::known_lamp_check_tests {
namespace {
using namespace testing_support;
using Eigen::Vector3d;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kLamps = 10;

std::string nameOfLamp(int i) { return "dome-" + std::to_string(i); }

/// A ball in front of a still camera, one lamp on in each photograph.
Scene ballUnderDome() {
  Scene scene;
  scene.name = "dome";
  scene.surfaces["ball"] = sphere(0.5);
  for (int i = 0; i < kLamps; ++i) {
    const double azimuth = 2.4 * i;
    const Vector3d place = 4 * Vector3d(std::cos(azimuth) * (0.3 + 0.05 * i), std::sin(azimuth) * (0.3 + 0.05 * i), 0.9);
    TrueLight light;
    light.id = nameOfLamp(i);
    light.lamp = lampAt(place);
    light.known = true;
    scene.lights.push_back(light);
    Frame f;
    f.id = "v" + std::to_string(i);
    f.camera = lookingAt({0.4, -1.2, 1.6}, {0, 0, -0.1});
    f.surface = "ball";
    f.lightsOn = {light.id};
    f.highlights = exactContours(sphere(0.5), f.camera, {light.id, place});
    scene.frames.push_back(std::move(f));
  }
  return scene;
}

std::vector<std::string> findingsOf(const Scene& scene) {
  const std::optional<CameraCheck> check = checkKnownLamps(scene);
  return check ? check->findings : std::vector<std::string>{"no check"};
}

TEST(KnownLampCheck, ARightStatementIsHeldAndNothingIsSaid) {
  const std::optional<CameraCheck> check = checkKnownLamps(ballUnderDome());
  ASSERT_TRUE(check);
  EXPECT_THAT(check->findings, IsEmpty());
  EXPECT_EQ(check->views, kLamps);
  EXPECT_LT(*check->missDeg, 0.05);
}

TEST(KnownLampCheck, ATurnedDomeIsNamedWithItsAxis) {
  Scene scene = ballUnderDome();
  // Stated with y up: (x, y, z) stands for (x, z, -y), which a turn by 90 degrees about x undoes.
  for (TrueLight& l : scene.lights) {
    const Vector3d p = l.lamp.position();
    l.lamp = lampAt({p.x(), p.z(), -p.y()});
  }
  EXPECT_THAT(findingsOf(scene), ElementsAre(AllOf(HasSubstr("the known lamps do not make these highlights"),
                                                   HasSubstr("turned by 90 degrees about x"))));
}

TEST(KnownLampCheck, ReversedDirectionsAreNamed) {
  Scene scene = ballUnderDome();
  for (int i = 0; i < kLamps; ++i) {
    const Vector3d d = scene.lights[std::size_t(i)].lamp.position().normalized();
    TrueLight& light = scene.lights[std::size_t(i)];
    light.lamp = lampTowards(-d);
    ExactOptions options;
    options.kind = ContourKind::LimitAngle;
    options.limitAngle = kLimitAngle;
    TrueLight right = light;
    right.lamp = lampTowards(d);
    Frame& f = scene.frames[std::size_t(i)];
    f.highlights = *exactHighlights(*makeAnalytic(sphere(0.5)), f.camera, right, Material{}, options);
    for (Highlight& h : f.highlights) h.light = light.id, h.fromScene = true;
  }
  EXPECT_THAT(findingsOf(scene), ElementsAre(HasSubstr("with directions reversed 10 do")));
}

TEST(KnownLampCheck, NamesOffByOneFrameAreNamed) {
  Scene scene = ballUnderDome();
  for (int i = 0; i + 1 < kLamps; ++i) scene.frames[std::size_t(i)].lightsOn = {nameOfLamp(i + 1)};
  scene.frames.back().lightsOn = {nameOfLamp(0)};
  for (Frame& f : scene.frames)
    for (Highlight& h : f.highlights) h.light.clear();
  EXPECT_THAT(findingsOf(scene), ElementsAre(HasSubstr("with the names of the frame before")));
}

TEST(KnownLampCheck, TwoSwappedLampsAreNamedOneByOne) {
  Scene scene = ballUnderDome();
  std::swap(scene.lights[3].lamp, scene.lights[4].lamp);
  EXPECT_THAT(findingsOf(scene), ElementsAre(AllOf(HasSubstr("frame v3"), HasSubstr("lamp dome-4 does")),
                                             AllOf(HasSubstr("frame v4"), HasSubstr("lamp dome-3 does"))));
}

TEST(KnownLampCheck, WithoutKnownLampsThereIsNoCheck) {
  Scene scene = ballUnderDome();
  for (TrueLight& l : scene.lights) l.known = false;
  EXPECT_FALSE(checkKnownLamps(scene));
}

}  // namespace
}  // namespace glint::known_lamp_check_tests

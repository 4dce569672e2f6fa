// SPDX-License-Identifier: BSD-3-Clause
// Predictions for cameras that are in no scene, against exact contours of those cameras.
#include "core/pipeline/live_prediction.h"

#include <gmock/gmock.h>

#include <random>

#include "tests/core/pipeline/exact_scene.h"

namespace glint::live_prediction_tests {
namespace {
using namespace testing_support;
using testing::HasSubstr;

const NamedLight kLamp{"lamp", {0.1, 0.2, 1.4}};

InspectionRequest levelSets() {
  InspectionRequest request;
  request.models = {"limit-angle"};
  request.train = "first:6";
  return request;
}

/// A camera between those of the scene.
Camera between() { return lookingAt({0.35, -0.1, 1.6}, {0.02, 0.03, 0}); }

/// Farthest vertex from the exact contour, px.
double farthestFrom(const AnalyticSpec& spec, const Camera& camera, const LiveAnswer& answer) {
  const std::vector<Highlight> exact = exactContours(spec, camera, kLamp);
  double worst = answer.highlights.size() == 1 && answer.highlights[0].prediction.highlights().size() == exact.size() ? 0 : 1e9;
  for (const LiveHighlights& of : answer.highlights)
    for (const PredictedHighlight& h : of.prediction.highlights())
      for (const Pixel& p : h.contour.points) worst = std::max(worst, distance(exact.front().contour, p));
  return worst;
}

TEST(LivePredictor, IsExactForACameraOfNoFrame) {
  const AnalyticSpec spec = sphere(1.0);
  const LivePredictor live(exactScene(spec, 6), levelSets());
  ASSERT_FALSE(live.failure());
  const auto answer = live.predict("new", between().camFromWorld, std::nullopt);
  ASSERT_TRUE(answer);
  EXPECT_FALSE(answer->frame);
  EXPECT_LT(farthestFrom(spec, between(), *answer), 0.01);  // the exact contour is a chain of chords, too
  // Other intrinsics, given with the pose: a camera of twice the size.
  Camera twice = between();
  twice.pixelFromRay.topRows<2>() *= 2;
  twice.width *= 2;
  twice.height *= 2;
  const auto larger = live.predict("new", twice.camFromWorld, twice);
  ASSERT_TRUE(larger);
  EXPECT_LT(farthestFrom(spec, twice, *larger), 0.02);
}

TEST(LivePredictor, OnNoisyContoursItIsAsGoodAsTheyAre) {
  const AnalyticSpec spec = sphere(1.0);
  const auto scene = exactScene(spec, 6);
  std::mt19937_64 rng(3);
  std::normal_distribution<double> gauss(0, 0.3);
  for (Frame& f : scene->frames)
    for (Highlight& h : f.highlights)
      for (Pixel& p : h.contour.points) p += Pixel(gauss(rng), gauss(rng));
  const LivePredictor live(scene, levelSets());
  const auto answer = live.predict("new", between().camFromWorld, std::nullopt);
  ASSERT_TRUE(answer);
  EXPECT_LT(farthestFrom(spec, between(), *answer), 0.3);  // as the noise of one point; measured 0.08
}

TEST(LivePredictor, AFrameIsKnownByItsIdItsSurfaceAndItsLights) {
  const auto scene = exactScene(sphere(1.0), {kLamp, {"other", {-0.6, 0.1, 1.4}}}, 7, [](int frame) {
    return frame == 6 ? std::vector<std::string>{"other"} : std::vector<std::string>{"lamp", "other"};
  });
  const LivePredictor live(scene, levelSets());
  const Camera& camera = scene->frames[6].camera;
  const auto named = live.predict("v6", camera.camFromWorld, std::nullopt);
  const auto anonymous = live.predict("v7", camera.camFromWorld, std::nullopt);
  ASSERT_TRUE(named && anonymous);
  EXPECT_EQ(named->frame, 6);
  ASSERT_EQ(named->highlights.size(), 1u);  // the lamp that is off in this frame is not predicted
  EXPECT_EQ(named->highlights[0].light, "other");
  EXPECT_EQ(anonymous->highlights.size(), 2u);
}

TEST(LivePredictor, WhatIsNotKnownIsNamed) {
  const auto scene = exactScene(sphere(1.0), 7);
  scene->frames[6].camera.width = 600;  // cameras differ
  scene->surfaces["another"] = sphere(0.9);
  scene->frames[6].surface = "another";  // and so do surfaces
  const LivePredictor live(scene, levelSets());
  const auto without = live.predict("new", between().camFromWorld, std::nullopt);
  ASSERT_FALSE(without);
  EXPECT_EQ(without.failure().reason, Reason::NotSupported);
  EXPECT_THAT(without.failure().detail, HasSubstr("needs a camera"));
  const auto with = live.predict("new", between().camFromWorld, between());
  ASSERT_TRUE(with);
  ASSERT_EQ(with->highlights.size(), 1u);
  ASSERT_TRUE(with->highlights[0].prediction.failure());
  EXPECT_EQ(with->highlights[0].prediction.failure()->reason, Reason::NoSurface);

  const auto dark = exactScene(sphere(1.0), 6);
  for (Frame& f : dark->frames) f.highlights.clear();
  EXPECT_TRUE(LivePredictor(dark, levelSets()).failure());
}

/// 1.96 sigma hold the exact contour of a camera that is in no scene, in nine of ten vertices or more over several draws of the
/// noise: correlated along a contour, so a single draw says little.
TEST(LivePredictor, BandsHoldTheExactContour) {
  const AnalyticSpec spec = sphere(1.0);
  InspectionRequest request = levelSets();
  request.settings.set("predict.band", true);
  const Polyline exact = exactContours(spec, between(), kLamp).front().contour;
  double inside = 0, all = 0, widest = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const auto scene = exactScene(spec, 6);
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> gauss(0, 0.3);
    for (Frame& f : scene->frames)
      for (Highlight& h : f.highlights)
        for (Pixel& p : h.contour.points) p += Pixel(gauss(rng), gauss(rng));
    const auto answer = LivePredictor(scene, request).predict("new", between().camFromWorld, std::nullopt);
    ASSERT_TRUE(answer && answer->highlights.size() == 1);
    const PredictedHighlight& h = answer->highlights[0].prediction.highlights().front();
    ASSERT_EQ(h.sigmaPx.size(), h.contour.points.size());
    for (std::size_t i = 0; i < h.sigmaPx.size(); ++i) {
      ASSERT_GT(h.sigmaPx[i], 0);
      inside += distance(exact, h.contour.points[i]) <= 1.96 * h.sigmaPx[i];
      widest = std::max(widest, h.sigmaPx[i]);
      ++all;
    }
  }
  EXPECT_GT(inside / all, 0.9);
  EXPECT_LT(widest, 0.3);  // a contour of six views with 72 points and more each is known better than one of its points
}

TEST(LivePredictor, BandsAreThoseOfTheSceneAndCostNothingUnlessAskedFor) {
  const auto scene = exactScene(sphere(1.0), 7);
  std::mt19937_64 rng(5);
  std::normal_distribution<double> gauss(0, 0.3);
  for (Frame& f : scene->frames)
    for (Highlight& h : f.highlights)
      for (Pixel& p : h.contour.points) p += Pixel(gauss(rng), gauss(rng));
  InspectionRequest request = levelSets();
  const auto plain = LivePredictor(scene, request).predict("v6", scene->frames[6].camera.camFromWorld, std::nullopt);
  ASSERT_TRUE(plain);
  EXPECT_TRUE(plain->highlights[0].prediction.highlights().front().sigmaPx.empty());
  request.settings.set("predict.band", true);
  const LivePredictor live(scene, request);
  const auto banded = live.predict("v6", scene->frames[6].camera.camFromWorld, std::nullopt);
  ASSERT_TRUE(banded);
  const Inspection whole = inspect(scene, request);
  const std::vector<FrameComparison>& frames = whole.models.at("limit-angle").frames;
  const auto ofFrame = std::find_if(frames.begin(), frames.end(), [](const FrameComparison& c) { return c.frame == 6; });
  ASSERT_NE(ofFrame, frames.end());
  const PredictedHighlight &a = banded->highlights[0].prediction.highlights().front(),
                           &b = ofFrame->prediction.highlights().front();
  EXPECT_FALSE(b.sigmaPx.empty());
  EXPECT_EQ(a.sigmaPx, b.sigmaPx);
  EXPECT_EQ(live.inspection().models.at("limit-angle").fits[0].bandRemarks, whole.models.at("limit-angle").fits[0].bandRemarks);
}

}  // namespace
}  // namespace glint::live_prediction_tests

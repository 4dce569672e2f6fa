// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/second_lobe_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

#include "core/pipeline/inspection.h"
#include "core/scene/scene.h"
#include "tests/core/pipeline/painted_scene.h"
#include "tests/shared_data.h"

/// Pictures of a ball whose light is written down pixel by pixel: shading, a lobe, its tail, and a second lobe. Then frames of
/// another program.
namespace glint::second_lobe_tests {
namespace {

using namespace testing_support;

constexpr double kNarrow = 0.06;  // rad, half angle at half of the peak

struct Shine {
  double share = 0, timesWider = 6;
  double shading = 0.3, noise = 0, metres = 1;
  bool longTail = false;  ///< GGX instead of a Gaussian
  int views = 6;
};

struct Seen {
  TexturePanel panel;
  std::vector<PointSamples> points;
  Light light;

  std::optional<SecondLobe> found() const { return secondLobeOf(panel, points, light, kNarrow); }
};

double lobe(const Shine& s, double alpha) {
  const double x = std::pow(alpha / kNarrow, 2);
  return s.longTail ? std::pow(1 + (std::sqrt(2.0) - 1) * x, -2) : std::exp2(-x);
}

Seen seenWith(const Shine& s) {
  const AnalyticSpec ball = sphere(0.5 * s.metres);
  const std::shared_ptr<const Surface> surface = makeAnalytic(ball);
  const Eigen::Vector3d lamp = s.metres * Eigen::Vector3d(0.2, -0.4, 1.6);
  std::mt19937 engine(1);
  std::normal_distribution<double> gauss(0, s.noise > 0 ? s.noise : 1);
  std::vector<TextureView> views;
  for (Camera camera : arc(s.views, 90)) {
    camera.camFromWorld.translation() *= s.metres;
    TextureView view;
    view.frame = static_cast<int>(views.size());
    view.camera = camera;
    view.stride = 2;
    view.value = Image(camera.width, camera.height, 1, std::numeric_limits<float>::quiet_NaN());
    view.distance = Image((camera.width + 1) / 2, (camera.height + 1) / 2, 1, std::numeric_limits<float>::quiet_NaN());
    const Eigen::Vector3d eye = camera.centreInWorld();
    double area = 0;
    Pixel middle(0, 0);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const Outcome<SurfacePoint> hit = surface->firstHit(camera.ray(Pixel(x, y)));
        if (!hit) continue;
        const Eigen::Vector3d n = hit->normal, l = (lamp - hit->position).normalized(), v = (eye - hit->position).normalized();
        const double alpha = std::acos(std::min(1.0, n.dot((l + v).normalized())));
        if (alpha < kNarrow) middle += Pixel(x, y), ++area;
        double value = s.shading * std::max(0.0, n.dot(l)) + lobe(s, alpha);
        value += s.share * std::exp2(-std::pow(alpha / (s.timesWider * kNarrow), 2));
        if (s.noise > 0) value += gauss(engine);
        view.value.at(x, y) = static_cast<float>(value);
        if (x % 2 == 0 && y % 2 == 0) view.distance.at(x / 2, y / 2) = static_cast<float>((hit->position - eye).norm());
      }
    EXPECT_GT(area, 20);
    LobeSpot spot;
    spot.centre = middle / area;
    spot.inverse = Eigen::Matrix2d::Identity() * (M_PI / area);
    spot.peak = 1;
    view.spots = {spot};
    views.push_back(std::move(view));
  }
  Seen seen{TexturePanel(std::move(views), surface), {}, Light::at(lamp)};
  seen.points = brightSightings(seen.panel);
  return seen;
}

TEST(SecondLobe, IsFoundWithItsShareAndItsWidth) {
  for (const double share : {0.1, 0.6})
    for (const double wider : {5.0, 9.0}) {
      const std::optional<SecondLobe> found = seenWith({.share = share, .timesWider = wider}).found();
      ASSERT_TRUE(found) << share << " " << wider;
      EXPECT_NEAR(found->share, share, 0.3 * share) << wider;
      EXPECT_LT(std::abs(std::log(found->timesWider / wider)), std::log(1.45)) << found->timesWider << " for " << wider;
    }
}

TEST(SecondLobe, OverBlackMetalToo) {
  const std::optional<SecondLobe> found = seenWith({.share = 0.3, .shading = 0}).found();
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->share, 0.3, 0.1);
}

TEST(SecondLobe, AtAThousandTimesTheSizeTheSame) {
  const std::optional<SecondLobe> small = seenWith({.share = 0.2}).found(),
                                  large = seenWith({.share = 0.2, .metres = 1000}).found();
  ASSERT_TRUE(small && large);
  EXPECT_NEAR(small->share, large->share, 1e-4);
}

TEST(SecondLobe, NoiseHidesAWeakOneAndMakesNone) {
  EXPECT_TRUE(seenWith({.share = 0.2, .noise = 0.005}).found());
  EXPECT_FALSE(seenWith({.share = 0, .shading = 0.05, .noise = 0.02}).found());
}

TEST(SecondLobe, NothingIsSaidOfOneLobe) {
  for (const double shading : {0.0, 0.3})
    for (const bool longTail : {false, true}) {
      const std::optional<SecondLobe> found = seenWith({.shading = shading, .longTail = longTail}).found();
      EXPECT_FALSE(found) << shading << " " << longTail << ": " << found->share << " " << found->timesWider;
    }
}

TEST(SecondLobe, TwoViewsTellNothing) { EXPECT_FALSE(seenWith({.share = 0.3, .views = 2}).found()); }

/// The same question through the pipeline. @param folder  below the shared data
std::string remarksOf(const std::string& folder) {
  InspectionRequest request;
  request.models = {"reflectance"};
  request.train = "spread:6";
  request.source = FrameSource::Image;
  const Inspection r = inspect(
      std::make_shared<Scene>(readScene(std::filesystem::path(GLINT_SHARED_DIR) / "data" / folder / "scene.json")), request);
  std::string all;
  for (const ModelResult::Fit& fit : r.models.at("reflectance").fits)
    if (fit.fit)
      for (const std::string& remark : fit.fit->remarks) all += remark + "\n";
  return all;
}

TEST(SecondLobe, IsNamedUnderACoatOfAnotherProgram) {
  GLINT_NEEDS_SHARED_DATA();
  EXPECT_NE(remarksOf("exact/coat").find("a second lobe lies under the highlights"), std::string::npos);
  EXPECT_EQ(remarksOf("cycles/sphere").find("second lobe"), std::string::npos);
}

}  // namespace
}  // namespace glint::second_lobe_tests

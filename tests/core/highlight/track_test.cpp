// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/surface/analytic.h"
#include "core/surface/brightest_point.h"

namespace glint {
namespace {

/// Ten cameras on an arc around a sphere, two lights; the peaks are the mirror points.
struct TwoLights {
  std::shared_ptr<const Surface> surface;
  std::vector<TrackedFrame> frames;
  std::vector<std::vector<std::string>> truth;

  explicit TwoLights(double noisePx) {
    AnalyticSpec spec;
    spec.type = "sphere";
    spec.radius = 0.4;
    surface = makeAnalytic(spec);
    const std::pair<std::string, Light> lights[] = {{"left", Light::at({1.2, 0.8, 1.5})}, {"right", Light::at({-0.3, 1.5, 1.1})}};
    std::mt19937 random(7);
    std::normal_distribution<double> normal(0, 1);
    for (int i = 0; i < 10; ++i) {
      const double a = 0.2 + 0.13 * i;
      const Eigen::Vector3d eye(1.8 * std::cos(a), 1.8 * std::sin(a), 0.9),
          forward = -eye.normalized(), right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
      TrackedFrame frame;
      frame.camera.width = 640;
      frame.camera.height = 480;
      frame.camera.pixelFromRay << 800, 0, 319.5, 0, 800, 239.5, 0, 0, 1;
      frame.camera.camFromWorld.linear().row(0) = right;
      frame.camera.camFromWorld.linear().row(1) = forward.cross(right);
      frame.camera.camFromWorld.linear().row(2) = forward;
      frame.camera.camFromWorld.translation() = -frame.camera.camFromWorld.linear() * eye;
      frame.surface = surface.get();
      truth.emplace_back();
      for (const auto& [id, light] : lights) {
        if (id == "right" && i == 3) continue;  // off in one frame
        const Outcome<std::vector<BrightestPoint>> points = predictedBrightestPoints(*surface, frame.camera, light);
        if (!points) continue;
        frame.lightsOn.push_back(id);
        Highlight h;
        h.peak = points->front().pixel + noisePx * Pixel(normal(random), normal(random));
        frame.highlights.push_back(h);
        truth.back().push_back(id);
      }
      if (i % 2) {  // detection gives no order
        std::reverse(frame.highlights.begin(), frame.highlights.end());
        std::reverse(truth.back().begin(), truth.back().end());
      }
      frames.push_back(frame);
    }
  }
};

TEST(AssignLights, NominalAndNoise) {
  for (const double noise : {0.0, 0.5}) {
    TwoLights scene(noise);
    EXPECT_EQ(assignLights(scene.frames), 2);
    for (std::size_t f = 0; f < scene.frames.size(); ++f) {
      ASSERT_EQ(scene.frames[f].highlights.size(), scene.truth[f].size());
      for (std::size_t i = 0; i < scene.truth[f].size(); ++i)
        EXPECT_EQ(scene.frames[f].highlights[i].light, scene.truth[f][i]) << f << " " << noise;
    }
  }
}

TEST(AssignLights, AHighlightOfNeitherLightKeepsNone) {
  TwoLights scene(0);
  Highlight stray;
  stray.peak = Pixel(330, 330);
  scene.frames[5].highlights.push_back(stray);
  assignLights(scene.frames);
  EXPECT_EQ(scene.frames[5].highlights.back().light, "");
}

TEST(AssignLights, OneLightTakesAll) {
  TwoLights scene(0);
  for (TrackedFrame& frame : scene.frames) frame.lightsOn = {"lamp"};
  EXPECT_EQ(assignLights(scene.frames), 0);
  for (const TrackedFrame& frame : scene.frames)
    for (const Highlight& h : frame.highlights) EXPECT_EQ(h.light, "lamp");
  for (TrackedFrame& frame : scene.frames) frame.lightsOn.clear();
  assignLights(scene.frames);
  EXPECT_EQ(scene.frames.front().highlights.front().light, "light");
}

TEST(AssignLights, DegenerateInputs) {
  std::vector<TrackedFrame> none;
  EXPECT_EQ(assignLights(none), 0);
  TwoLights scene(0);
  for (TrackedFrame& frame : scene.frames) frame.surface = nullptr;
  EXPECT_EQ(assignLights(scene.frames), 0);
  EXPECT_EQ(scene.frames.front().highlights.front().light, "");
}

}  // namespace
}  // namespace glint

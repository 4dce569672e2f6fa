// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>

#include "core/surface/analytic.h"
#include "core/surface/brightest_point.h"
#include "core/surface/posed_surface.h"

namespace glint {
namespace {

/// Ten cameras on an arc around a sphere, two lights; the peaks are the mirror points.
struct TwoLights {
  std::shared_ptr<const Surface> surface;
  std::vector<TrackedFrame> frames;
  std::vector<std::vector<std::string>> truth;

  explicit TwoLights(double noisePx, double scale = 1, const std::string& shape = "sphere") {
    AnalyticSpec spec;
    spec.type = shape;
    spec.radius = spec.majorRadius = 0.4 * scale;
    spec.minorRadius = 0.15 * scale;
    surface = makeAnalytic(spec);
    const std::pair<std::string, Light> lights[] = {{"left", Light::at(scale * Eigen::Vector3d(1.2, 0.8, 1.5))},
                                                    {"right", Light::at(scale * Eigen::Vector3d(-0.3, 1.5, 1.1))}};
    std::mt19937 random(7);
    std::normal_distribution<double> normal(0, 1);
    for (int i = 0; i < 10; ++i) {
      const double a = 0.2 + 0.13 * i;
      const Eigen::Vector3d eye = scale * Eigen::Vector3d(1.8 * std::cos(a), 1.8 * std::sin(a), 0.9), forward = -eye.normalized(),
                            right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
      TrackedFrame frame;
      frame.camera.width = 640;
      frame.camera.height = 480;
      frame.camera.pixelFromRay << 800, 0, 319.5, 0, 800, 239.5, 0, 0, 1;
      frame.camera.camFromWorld.linear().row(0) = right;
      frame.camera.camFromWorld.linear().row(1) = forward.cross(right);
      frame.camera.camFromWorld.linear().row(2) = forward;
      frame.camera.camFromWorld.translation() = -frame.camera.camFromWorld.linear() * eye;
      truth.emplace_back();
      for (const auto& [id, light] : lights) {
        if (id == "right" && i == 3) continue;  // off in one frame
        const Outcome<std::vector<BrightestPoint>> points = predictedBrightestPoints(*surface, frame.camera, light);
        if (!points) continue;
        frame.lightsOn.push_back(id);
        for (const BrightestPoint& point : *points) {
          Highlight h;
          h.peak = point.pixel + noisePx * Pixel(normal(random), normal(random));
          frame.highlights.push_back(h);
          truth.back().push_back(id);
        }
      }
      if (i % 2) {  // detection gives no order
        std::reverse(frame.highlights.begin(), frame.highlights.end());
        std::reverse(truth.back().begin(), truth.back().end());
      }
      frames.push_back(frame);
    }
  }

  int assign() {
    return assignLights(frames, [&](std::size_t) { return surface; });
  }
};

/// Nothing is stated: which name goes with which light is open, but every highlight of one light has the same.
void expectToldApart(const TwoLights& scene, const std::string& what) {
  std::map<std::string, std::string> name;
  for (std::size_t f = 0; f < scene.frames.size(); ++f)
    for (std::size_t i = 0; i < scene.truth[f].size(); ++i) {
      const std::string& given = scene.frames[f].highlights[i].light;
      EXPECT_EQ(name.emplace(scene.truth[f][i], given).first->second, given) << what << ", frame " << f;
    }
  EXPECT_EQ(name.size(), 2u) << what;
  EXPECT_EQ(std::set<std::string>({name["left"], name["right"]}), std::set<std::string>({"light", "light-2"})) << what;
}

TEST(AssignLights, StatedNowhereTheHighlightsProveTheLights) {
  for (const double noise : {0.0, 0.5}) {
    TwoLights scene(noise);
    for (TrackedFrame& frame : scene.frames) frame.lightsOn.clear();
    EXPECT_EQ(scene.assign(), 2);
    expectToldApart(scene, "noise " + std::to_string(noise));
  }
}

/// The right lamp moves with the camera: it stands still in the camera's coordinates, where the left one does not.
TEST(AssignLights, ALightMayStandStillInOtherCoordinates) {
  for (const bool fromCamera : {false, true}) {  // which coordinates come first must not matter
    TwoLights scene(0.2);
    const Light carried = Light::at({0.3, -0.4, 0.1});
    for (std::size_t f = 0; f < scene.frames.size(); ++f) {
      TrackedFrame& frame = scene.frames[f];
      const Eigen::Isometry3d toWorld = frame.camera.camFromWorld.inverse();
      const Outcome<std::vector<BrightestPoint>> seen =
          predictedBrightestPoints(*scene.surface, frame.camera, Light::at(toWorld * carried.position()));
      ASSERT_TRUE(seen);
      for (std::size_t i = 0; i < scene.truth[f].size(); ++i)
        if (scene.truth[f][i] == "right") frame.highlights[i].peak = seen->front().pixel;
      frame.lightsOn.clear();
      frame.elsewhereFromHere = frame.camera.camFromWorld;
    }
    if (fromCamera) {
      std::vector<std::shared_ptr<const Surface>> moved;
      for (TrackedFrame& frame : scene.frames) {
        moved.push_back(movedTo(frame.camera.camFromWorld, scene.surface));
        frame.elsewhereFromHere = frame.camera.camFromWorld.inverse();
        frame.camera.camFromWorld.setIdentity();
      }
      EXPECT_EQ(assignLights(scene.frames, [&](std::size_t f) { return moved[f]; }), 2);
    } else {
      EXPECT_EQ(scene.assign(), 2);
    }
    expectToldApart(scene, fromCamera ? "the camera's coordinates" : "the world's");
  }
}

TEST(AssignLights, Scale) {
  for (const double scale : {1e-3, 1e3}) {
    TwoLights scene(0.2, scale);
    for (TrackedFrame& frame : scene.frames) frame.lightsOn.clear();
    EXPECT_EQ(scene.assign(), 2);
    expectToldApart(scene, "scale " + std::to_string(scale));
  }
}

/// A torus shows a light on its outside and in its hollow: the mirror points of the frames say which, whatever their number.
TEST(AssignLights, ALightMayHaveSeveralHighlightsInAFrame) {
  TwoLights scene(0.2, 1, "torus");
  ASSERT_GT(scene.frames[0].highlights.size(), 2u);
  EXPECT_EQ(scene.assign(), 2);
  for (std::size_t f = 0; f < scene.frames.size(); ++f)
    for (std::size_t i = 0; i < scene.truth[f].size(); ++i)
      EXPECT_EQ(scene.frames[f].highlights[i].light, scene.truth[f][i]) << f;
  TwoLights one(0.2, 1, "torus");
  for (std::size_t f = 0; f < one.frames.size(); ++f) {
    one.frames[f].lightsOn.clear();
    std::vector<Highlight> kept;
    for (std::size_t i = 0; i < one.truth[f].size(); ++i)
      if (one.truth[f][i] == "left") kept.push_back(one.frames[f].highlights[i]);
    one.frames[f].highlights = kept;
  }
  ASSERT_GT(one.frames[0].highlights.size(), 1u);
  EXPECT_EQ(one.assign(), 0);
  for (const TrackedFrame& frame : one.frames)
    for (const Highlight& h : frame.highlights) EXPECT_EQ(h.light, "light");
}

/// Circle about a pixel.
Polyline circle(const Pixel& centre, double radius) {
  Polyline line;
  for (int i = 0; i < 48; ++i) line.points.push_back(centre + radius * Pixel(std::cos(i * M_PI / 24), std::sin(i * M_PI / 24)));
  return line;
}

TEST(AssignLights, AHighlightOfBothBelongsToNeither) {
  TwoLights scene(0);
  std::vector<Highlight>& both = scene.frames[4].highlights;
  ASSERT_EQ(both.size(), 2u);
  // One contour around both peaks, brightest at the first; the frame's second highlight has gone into it.
  both[0].contour = circle(both[0].peak, 1.2 * (both[1].peak - both[0].peak).norm());
  both.pop_back();
  EXPECT_EQ(scene.assign(), 2);
  EXPECT_EQ(both[0].light, "");
  EXPECT_EQ(scene.frames[3].highlights[0].light, scene.truth[3][0]);
}

TEST(AssignLights, LightsTooCloseToSeparateAreOne) {
  TwoLights scene(0);
  for (std::size_t f = 0; f < scene.frames.size(); ++f) {
    scene.frames[f].lightsOn = {"left", "right"};
    std::vector<Highlight> kept;
    for (std::size_t i = 0; i < scene.truth[f].size(); ++i)
      if (scene.truth[f][i] == "left") kept.push_back(scene.frames[f].highlights[i]);
    scene.frames[f].highlights = kept;
  }
  EXPECT_EQ(scene.assign(), 1);
  for (const TrackedFrame& frame : scene.frames) EXPECT_EQ(frame.highlights[0].light, scene.frames[0].highlights[0].light);
}

TEST(AssignLights, NominalAndNoise) {
  for (const double noise : {0.0, 0.5}) {
    TwoLights scene(noise);
    EXPECT_EQ(scene.assign(), 2);
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
  scene.assign();
  EXPECT_EQ(scene.frames[5].highlights.back().light, "");
}

TEST(AssignLights, OneLightTakesAll) {
  TwoLights scene(0);
  for (TrackedFrame& frame : scene.frames) frame.lightsOn = {"lamp"};
  EXPECT_EQ(scene.assign(), 0);
  for (const TrackedFrame& frame : scene.frames)
    for (const Highlight& h : frame.highlights) EXPECT_EQ(h.light, "lamp");
  for (TrackedFrame& frame : scene.frames) {
    frame.lightsOn.clear();
    frame.highlights.resize(1);
    frame.highlights.front().light.clear();
  }
  EXPECT_EQ(scene.assign(), 0);
  EXPECT_EQ(scene.frames.front().highlights.front().light, "light");
}

/// Half of ten frames under two lamps, half under two others; nobody states which.
std::vector<TrackedFrame> switchedLamps(double noisePx, bool alone) {
  const TwoLights scene(0);
  const Light lights[] = {Light::at({1.2, 0.8, 1.5}), Light::at({-0.3, 1.5, 1.1}), Light::at({1.4, 1.6, 0.4}),
                          Light::at({0.2, 0.4, 2})};
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 1);
  std::vector<TrackedFrame> frames = scene.frames;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    frames[f].lightsOn.clear();
    frames[f].highlights.clear();
    const std::size_t first = f % 2 ? 2 : 0;
    for (std::size_t l = first; l < first + (alone && f % 2 ? 1 : 2); ++l) {
      Highlight h;
      h.peak = predictedBrightestPoints(*scene.surface, frames[f].camera, lights[l])->front().pixel +
               noisePx * Pixel(normal(random), normal(random));
      frames[f].highlights.push_back(h);
    }
  }
  const auto surface = scene.surface;
  assignLights(frames, [&](std::size_t) { return surface; });
  return frames;
}

TEST(AssignLights, LampsThatAreSwitchedProveEachOther) {
  for (const double noise : {0.0, 0.5}) {
    const std::vector<TrackedFrame> frames = switchedLamps(noise, false);
    std::set<std::string> names;
    for (std::size_t f = 0; f < frames.size(); ++f)
      for (std::size_t l = 0; l < 2; ++l) {
        const std::string& given = frames[f].highlights[l].light;
        EXPECT_EQ(given, frames[f % 2].highlights[l].light) << noise << ", frame " << f;
        names.insert(given);
      }
    EXPECT_EQ(names, std::set<std::string>({"light", "light-2", "light-3", "light-4"})) << noise;
  }
  // A lamp that is alone wherever it is on may be a badly placed camera's view of another.
  const std::vector<TrackedFrame> frames = switchedLamps(0, true);
  for (std::size_t f = 1; f < frames.size(); f += 2) EXPECT_EQ(frames[f].highlights[0].light, "") << f;
}

TEST(AssignLights, DegenerateInputs) {
  std::vector<TrackedFrame> none;
  EXPECT_EQ(assignLights(none, [](std::size_t) { return nullptr; }), 0);
  TwoLights scene(0);
  scene.surface = nullptr;
  EXPECT_EQ(scene.assign(), 0);
  EXPECT_EQ(scene.frames.front().highlights.front().light, "");
}

}  // namespace
}  // namespace glint

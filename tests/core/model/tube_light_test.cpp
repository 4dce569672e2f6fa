// SPDX-License-Identifier: BSD-3-Clause
// limit-angle with the extent of the light, on exact radiance contours of tubes and points.
#include <gtest/gtest.h>

#include <cmath>

#include "core/evaluate/metrics.h"
#include "core/model/models.h"
#include "tests/core/model/exact_views.h"

namespace glint {
namespace {

using namespace test;

struct Outcomes {
  double errorPct = 0;  ///< mean over the held-out views
  std::optional<Eigen::Matrix3d> extent;
  double limit = 0;
};

Outcomes heldOutError(const TrueLight& light, int orders, double scale = 1, double noise = 0, const std::string& solver = "bundle") {
  Synthetic s = ellipsoidScene(11);
  s.light = light;
  s = moved(s, Eigen::Isometry3d::Identity(), 1);
  const auto surface = makeAnalytic([&] {
    AnalyticSpec spec = s.surface;
    spec.semiAxes *= scale;
    return spec;
  }());
  TrueLight lamp = light;
  if (lamp.position) *lamp.position *= scale;
  if (lamp.segment)
    for (Eigen::Vector3d& end : *lamp.segment) end *= scale;
  lamp.radius *= scale;
  ExactOptions options;
  Material material;
  material.roughness = 0.12;
  Settings settings;
  settings.set("light.limit_orders", orders);
  settings.set("light.solver", solver);
  std::vector<TrainingView> views;
  std::vector<std::pair<Camera, Highlight>> heldOut;
  for (std::size_t i = 0; i < s.cameras.size(); ++i) {
    Camera camera = s.cameras[i];
    camera.camFromWorld.translation() *= scale;
    const Outcome<std::vector<Highlight>> found = exactHighlights(*surface, camera, lamp, material, options);
    if (!found) throw std::runtime_error(found.failure().message());
    if (i % 2) {
      heldOut.emplace_back(camera, found->front());
      continue;
    }
    FrameEvidence evidence;
    evidence.frame = int(i);
    evidence.highlights = {withNoise(found->front(), noise, 3, int(i), 0)};
    views.push_back(trainingView(evidence, 0, camera, surface));
  }
  FitInput input;
  input.views = views;
  const Outcome<LightEstimate> estimate = estimateLight(views, settings);
  if (!estimate) throw std::runtime_error(estimate.failure().message());
  input.light = *estimate;
  const HighlightModel& model = modelByName("limit-angle");
  const Outcome<ModelFit> fit = model.fit(input, settings);
  if (!fit) throw std::runtime_error(fit.failure().message());
  Outcomes result;
  result.extent = fit->extent;
  result.limit = *fit->limitAngle;
  for (const auto& [camera, highlight] : heldOut) {
    const Prediction p = model.predict(*fit, camera, surface.get(), settings);
    if (p.highlights.size() != 1) throw std::runtime_error("no prediction");
    const PredictedHighlight& h = p.highlights[0];
    result.errorPct += compareContours(highlight.contour, h.contour, h.gaps, h.ellipse, highlight.peak, h.brightest.pixel).contourErrorPct /
                       double(heldOut.size());
    if (noise > 0) {
      const std::vector<double> sigma = model.bandSigmaPx(*fit, h, camera, surface.get(), settings);
      EXPECT_EQ(sigma.size(), h.contour.points.size());
      for (const double x : sigma) EXPECT_TRUE(std::isfinite(x) && x > 0 && x < 5) << x;
    }
  }
  return result;
}

TrueLight tube(double length) {
  TrueLight light;
  light.id = "tube";
  const Eigen::Vector3d middle(1.2, -1.0, 2.2), half = 0.5 * length * Eigen::Vector3d(0.6, 0.8, 0);
  light.segment = {Eigen::Vector3d(middle - half), Eigen::Vector3d(middle + half)};
  light.radius = 0.02;
  return light;
}

TEST(TubeLight, TheExtentExplainsWhatOneLimitAngleCannot) {
  const Outcomes constant = heldOutError(tube(0.8), 0), directed = heldOutError(tube(0.8), 1);
  RecordProperty("constant_pct", std::to_string(constant.errorPct));
  RecordProperty("directed_pct", std::to_string(directed.errorPct));
  EXPECT_FALSE(constant.extent);
  ASSERT_TRUE(directed.extent);
  EXPECT_LT(directed.errorPct, 0.5 * constant.errorPct);
  // Longest along the tube: -2 log q times length^2 / 12 there.
  const Eigen::Vector3d axis(0.6, 0.8, 0);
  EXPECT_NEAR(axis.dot(*directed.extent * axis) / (2 * std::log(2.0) * 0.8 * 0.8 / 12), 1, 0.35);
}

TEST(TubeLight, TheViewsChooseTheOrder) {
  EXPECT_TRUE(heldOutError(tube(0.8), -1).extent);
  EXPECT_FALSE(heldOutError(lampAt({1.2, -1.0, 2.2}), -1, 1, 1.0).extent) << "noise alone gives no reason for an extent";
}

TEST(TubeLight, Scale) {
  const Outcomes here = heldOutError(tube(0.8), 1), small = heldOutError(tube(0.8), 1, 1e-3), large = heldOutError(tube(0.8), 1, 1e3);
  EXPECT_NEAR(small.errorPct / here.errorPct, 1, 1e-2);
  EXPECT_NEAR(large.errorPct / here.errorPct, 1, 1e-2);
  EXPECT_LT((*large.extent * 1e-6 - *here.extent).norm(), 1e-3 * here.extent->norm());
}

TEST(TubeLight, NoiseAndBand) {
  const Outcomes noisy = heldOutError(tube(0.8), 1, 1, 0.3);
  EXPECT_LT(noisy.errorPct, heldOutError(tube(0.8), 0, 1, 0.3).errorPct);
}

TEST(TubeLight, DegenerateATriangulatedLightHasNoExtent) {
  EXPECT_FALSE(heldOutError(tube(0.8), 1, 1, 0, "triangulated").extent);
}

}  // namespace
}  // namespace glint

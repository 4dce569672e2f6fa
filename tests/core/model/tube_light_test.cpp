// SPDX-License-Identifier: BSD-3-Clause
// limit-angle with the extent of the light, on exact radiance contours of tubes and points.
#include <gtest/gtest.h>

#include <cmath>

#include "core/light/directed_limit.h"
#include "core/light/estimate.h"
#include "core/model/models.h"
#include "core/pipeline/metrics.h"
#include "tests/core/model/exact_views.h"

namespace glint {
namespace {

using namespace test;

struct Outcomes {
  double errorPct = 0;  ///< mean over the held-out views
  std::optional<Eigen::Matrix3d> extent;
  double limit = 0;
  Light light;
};

Outcomes heldOutError(const TrueLight& light, int orders, double scale = 1, double noise = 0,
                      const std::string& solver = "bundle") {
  Synthetic s = ellipsoidScene(11);
  s.light = light;
  s = moved(s, Eigen::Isometry3d::Identity(), 1);
  const auto surface = makeAnalytic([&] {
    AnalyticSpec spec = s.surface;
    spec.semiAxes *= scale;
    return spec;
  }());
  TrueLight lamp = light;
  lamp.lamp = transformed(lamp.lamp, scale, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
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
  result.extent = fit->as<LimitAngleFit>()->extent;
  result.limit = *fit->limitAngle();
  result.light = *fit->lightEstimate;
  for (const auto& [camera, highlight] : heldOut) {
    const Prediction p = model.predict(*fit, camera, surface.get(), settings);
    if (p.highlights().size() != 1) throw std::runtime_error("no prediction");
    const PredictedHighlight& h = p.highlights()[0];
    result.errorPct +=
        compareContours(highlight.contour, h.contour, h.gaps, h.ellipse, highlight.peak, h.brightest.pixel).contourErrorPct /
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
  light.lamp = segmentLamp(Eigen::Vector3d(middle - half), Eigen::Vector3d(middle + half));
  light.lamp = withRadius(light.lamp, 0.02);
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
  EXPECT_FALSE(heldOutError(trueLampAt({1.2, -1.0, 2.2}), -1, 1, 1.0).extent) << "noise alone gives no reason for an extent";
}

TEST(TubeLight, Scale) {
  const Outcomes here = heldOutError(tube(0.8), 1), small = heldOutError(tube(0.8), 1, 1e-3),
                 large = heldOutError(tube(0.8), 1, 1e3);
  EXPECT_NEAR(small.errorPct / here.errorPct, 1, 1e-2);
  EXPECT_NEAR(large.errorPct / here.errorPct, 1, 1e-2);
  EXPECT_LT((*large.extent * 1e-6 - *here.extent).norm(), 1e-3 * here.extent->norm());
}

TEST(TubeLight, NoiseAndBand) {
  const Outcomes noisy = heldOutError(tube(0.8), 1, 1, 0.3);
  EXPECT_LT(noisy.errorPct, heldOutError(tube(0.8), 0, 1, 0.3).errorPct);
}

// Six cameras within 28 degrees and 4 px of noise: one of the lights that explain the contours best is under the sphere. No
// estimate may be there, whether or not the extent was asked for.
TEST(TubeLight, NoLightBehindAHighlightPasses) {
  AnalyticSpec spec;
  spec.type = "sphere";
  spec.radius = 0.5;
  const auto surface = makeAnalytic(spec);
  TrueLight lamp;
  lamp.id = "lamp";
  lamp.lamp = segmentLamp(Eigen::Vector3d(0.2, -1.3, 2.05), Eigen::Vector3d(0.2, -1.0, 2.2));
  lamp.lamp = withRadius(lamp.lamp, 0.015);
  Material material;
  std::vector<FrameEvidence> frames;
  std::vector<Camera> cameras;
  for (int i = 0; i < 6; ++i) {
    const double a = -1.2 + 0.48 * i / 7;
    cameras.push_back(lookAt({1.9 * std::cos(a), 1.9 * std::sin(a), 0.9}, {0, 0, 0}));
    const Outcome<std::vector<Highlight>> found = exactHighlights(*surface, cameras.back(), lamp, material, ExactOptions{});
    ASSERT_TRUE(found);
    FrameEvidence evidence;
    evidence.frame = i;
    evidence.highlights = {found->front()};
    frames.push_back(evidence);
  }
  int answers = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::vector<TrainingView> views;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      FrameEvidence noisy = frames[i];
      noisy.highlights[0] = withNoise(noisy.highlights[0], 4.0, seed, int(i), 0);
      views.push_back(trainingView(noisy, 0, cameras[i], surface));
    }
    for (const int orders : {0, 1}) {
      Settings settings;
      settings.set("light.limit_orders", orders);
      const Outcome<LightEstimate> light = estimateLight(views, settings);
      if (!light) continue;
      ++answers;
      for (const TrainingView& v : views) {
        const Eigen::Vector3d p = v.seen->brightest.point.position;  // on the sphere about the origin: its own normal
        EXPECT_GT(p.dot(light->light.homogeneous().head<3>() - light->light.homogeneous().w() * p), 0) << seed << " " << orders;
      }
    }
  }
  EXPECT_GT(answers, 4) << "refusing everything is no answer";
}

/// The tube seen under the same angles from a distance `times` as large.
TrueLight distantTube(double length, double times) {
  TrueLight light = tube(length);
  light.lamp = transformed(light.lamp, times, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  return light;
}

// A tube at 27 km, or at 2.7 million km, is one at infinity; its length is an angle: 0.8 m at 2.7 m.
TEST(TubeLight, FarAwayTheExtentIsAnAngle) {
  for (const double times : {1e4, 1e9}) {
    const Outcomes constant = heldOutError(distantTube(0.8, times), 0), directed = heldOutError(distantTube(0.8, times), 1);
    ASSERT_TRUE(directed.extent) << times;
    EXPECT_LT(directed.errorPct, 0.5 * constant.errorPct) << times;
    const Eigen::Vector4d l = directed.light.homogeneous();
    const double toAngles = directed.light.atInfinity() ? 1 : l.w() * l.w() / l.head<3>().squaredNorm();
    const double angle = 0.8 / Eigen::Vector3d(1.2, -1.0, 2.2).norm();
    const Eigen::Vector3d axis(0.6, 0.8, 0);
    EXPECT_NEAR(toAngles * axis.dot(*directed.extent * axis) / (2 * std::log(2.0) * angle * angle / 12), 1, 0.35) << times;
  }
}

/// Contours on which alpha is the directed limit angle of a light at infinity, by bisection from the mirror point outwards.
std::vector<BundleView> viewsOfAnExtentAtInfinity(const std::shared_ptr<const Surface>& surface, const Eigen::Vector3d& direction,
                                                  const Eigen::Matrix3d& extent, double limit, int n) {
  Synthetic s = ellipsoidScene(n);
  s.light.lamp = lampTowards(direction);
  const Light light = Light::towards(direction);
  std::vector<BundleView> views;
  for (const Camera& camera : s.cameras) {
    const Eigen::Vector3d eye = camera.centreInWorld();
    const Pixel peak = exactHighlightsOf(s, camera).front().peak;
    const auto outside = [&](const Pixel& p) {
      const Outcome<SurfacePoint> hit = surface->firstHit(camera.ray(p));
      if (!hit) return true;
      const SurfacePoint at = facing(*hit, eye);
      const Eigen::Vector3d v = (eye - at.position).normalized();
      return incidentAngle(at.normal, direction, v) >
             directedLimit(limit, extent, at.position, at.normal, v, light.homogeneous());
    };
    BundleView view{camera, surface.get(), {}, *observedBrightestPoint(*surface, camera, peak)};
    for (int k = 0; k < 72; ++k) {
      const Pixel along(std::cos(k * M_PI / 36), std::sin(k * M_PI / 36));
      double in = 0, out = 1;
      while (!outside(peak + out * along)) out *= 1.5;
      for (int b = 0; b < 60; ++b) (outside(peak + 0.5 * (in + out) * along) ? out : in) = 0.5 * (in + out);
      view.contour.push_back(peak + in * along);
    }
    views.push_back(std::move(view));
  }
  return views;
}

TEST(TubeLight, AtInfinityTheExtentIsFound) {
  const Eigen::Vector3d direction = Eigen::Vector3d(1.2, -1.0, 2.2).normalized(), axis = direction.unitOrthogonal();
  const Eigen::Matrix3d extent =
      0.02 * axis * axis.transpose();  // rad^2, against a limit of 0.1 rad: twice as wide along the axis
  const auto surface = makeAnalytic(ellipsoidScene(1).surface);
  const std::vector<BundleView> views = viewsOfAnExtentAtInfinity(surface, direction, extent, 0.1, 8);
  BundleOptions options;
  options.limitOrders = 1;
  const Outcome<Bundle> bundle = bundleLight(views, Light::towards(direction + Eigen::Vector3d(0.02, 0.01, -0.03)), options);
  ASSERT_TRUE(bundle) << bundle.failure().message();
  ASSERT_TRUE(bundle->extent);
  // The reluctance against an extent pulls by one pixel among 576.
  EXPECT_LT(bundle->rmsPx, 0.05);
  const Eigen::Vector4d l = bundle->light.homogeneous();
  EXPECT_LT(l.head<3>().normalized().cross(direction).norm(), 1e-3);
  EXPECT_LT(l.w(), 1e-2) << "at infinity, or so far that the eight views see no difference";
  const double toAngles = bundle->light.atInfinity() ? 1 : l.w() * l.w() / l.head<3>().squaredNorm();
  EXPECT_NEAR(toAngles * axis.dot(*bundle->extent * axis), 0.02, 0.02 * 0.05);
  EXPECT_NEAR(bundle->limitAngle, 0.1, 0.1 * 0.02);
}

TEST(TubeLight, DegenerateATriangulatedLightHasNoExtent) {
  EXPECT_FALSE(heldOutError(tube(0.8), 1, 1, 0, "triangulated").extent);
}

}  // namespace
}  // namespace glint

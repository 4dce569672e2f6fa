// SPDX-License-Identifier: BSD-3-Clause
// Joint refinement of light and poses: what it gains where poses are off, and that it does no harm where they are not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/light/estimate.h"
#include "tests/core/model/coverage_trials.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using namespace test;

/// Turned by sigma / f about each axis and shifted by sigma Z / f along each.
Camera disturbed(Camera c, double sigmaPx, std::mt19937_64& engine) {
  std::normal_distribution<double> gauss;
  const double focal = c.pixelFromRay(0, 0), depth = c.centreInWorld().norm();
  Eigen::Vector3d turn, shift;
  for (int i = 0; i < 3; ++i) turn(i) = sigmaPx / focal * gauss(engine), shift(i) = sigmaPx / focal * depth * gauss(engine);
  Eigen::Isometry3d by = Eigen::Isometry3d::Identity();
  if (turn.norm() > 0) by.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  by.translation() = shift;
  c.camFromWorld = by * c.camFromWorld;
  return c;
}

struct Errors {
  double plain, refined;  ///< median over seeds of the light's error as a share of its distance
};

Errors lightErrors(const Synthetic& s, double poseSigma, double noise, int seeds, double priorPx) {
  const auto surface = makeAnalytic(s.surface);
  std::vector<Highlight> exact;
  for (const Camera& c : s.cameras) exact.push_back(exactHighlightsOf(s, c)[0]);
  std::vector<double> plain, refined;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937_64 engine(seed);
    std::vector<BundleView> views;
    for (std::size_t i = 0; i < s.cameras.size(); ++i)
      views.push_back({disturbed(s.cameras[i], poseSigma, engine),
                       surface.get(),
                       withNoise(exact[i], noise, seed, int(i), 0).contour.points,
                       {}});
    const Light start = Light::at(s.light.lamp.position() * 1.1);
    const Outcome<Bundle> b = bundleLight(views, start);
    const Outcome<PoseRefinement> r = refinePoses(views, start, priorPx);
    if (!b || !r) throw std::runtime_error("no light");
    const double distance = s.light.lamp.position().norm();
    plain.push_back((b->light.position() - s.light.lamp.position()).norm() / distance);
    refined.push_back((r->bundle.light.position() - s.light.lamp.position()).norm() / distance);
  }
  std::sort(plain.begin(), plain.end());
  std::sort(refined.begin(), refined.end());
  return {plain[seeds / 2], refined[seeds / 2]};
}

// Measured, 15 seeds, poses off by 0.5 px: the light's median error on the ellipsoid 2.2 % with the given poses, 0.5 % with
// refined ones. A sphere may turn with light and cameras, so its contours cannot tell: 4.2 % and 4.8 %.
TEST(RefinePoses, GainsWherePosesAreOff) {
  const Errors ellipsoid = lightErrors(ellipsoidScene(6), 0.5, 0.1, 15, 0.5),
               sphere = lightErrors(sphereScene(6), 0.5, 0.1, 15, 0.5);
  RecordProperty("ellipsoid_plain", std::to_string(ellipsoid.plain));
  RecordProperty("ellipsoid_refined", std::to_string(ellipsoid.refined));
  EXPECT_LT(ellipsoid.refined, 0.5 * ellipsoid.plain);
  EXPECT_LT(sphere.refined, 1.3 * sphere.plain);
}

TEST(RefinePoses, DoesNoHarmWherePosesAreExact) {
  for (const double noise : {0.0, 0.3}) {
    const Errors e = lightErrors(ellipsoidScene(6), 0, noise, 15, 0.3);
    EXPECT_DOUBLE_EQ(e.refined, e.plain) << "nothing speaks against the poses: they stay";
  }
}

TEST(RefinePoses, Scale) {
  const Synthetic here = ellipsoidScene(5);
  std::mt19937_64 engine(4);
  std::vector<Camera> off;
  for (const Camera& c : here.cameras) off.push_back(disturbed(c, 0.5, engine));
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  for (const double scale : {1.0, 1e-3, 1e3}) {
    const Synthetic s = moved(here, Eigen::Isometry3d::Identity(), scale);
    const auto surface = makeAnalytic(s.surface);
    std::vector<BundleView> views;
    for (std::size_t i = 0; i < off.size(); ++i) {
      Camera c = off[i];
      c.camFromWorld.translation() *= scale;
      views.push_back({c, surface.get(), exactHighlightsOf(here, here.cameras[i])[0].contour.points, {}});
    }
    const Outcome<PoseRefinement> r = refinePoses(views, Light::at(1.1 * s.light.lamp.position()), 0.3);
    ASSERT_TRUE(r) << scale;
    EXPECT_EQ(r->cameras.size(), views.size());
    EXPECT_GT(r->movedPx, 0.01);
    if (scale == 1) first = r->bundle.light.position();
    EXPECT_LT((r->bundle.light.position() / scale - first).norm(), 1e-4)
        << scale;  // both stop when a step moves less than 1e-4 sigma
  }
}

TEST(RefinePoses, DegenerateInputsKeepTheBundlesReasons) {
  const auto surface = makeAnalytic(sphere(0.5));
  EXPECT_EQ(refinePoses({}, Light::at({0, 0, 1}), 0.3).failure().reason, Reason::TooFewPoints);
  const Camera camera = lookAt({2, 0, 0}, {0, 0, 0});
  EXPECT_EQ(refinePoses({{camera, surface.get(), {{-900, -900}, {-901, -900}, {-900, -901}}, {}}}, Light::at({0, 0, 1}), 0.3)
                .failure()
                .reason,
            Reason::PeakOffSurface);
  EXPECT_THROW((void)refinePoses({}, Light::at({0, 0, 1}), 0), std::invalid_argument);
}

}  // namespace
}  // namespace glint

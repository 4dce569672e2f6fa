// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/refine_normals.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry/polyline.h"
#include "core/surface/mesh.h"
#include "tests/core/model/bumpy_mesh.h"
#include "tests/core/model/exact_views.h"
#include "tests/sanitizers/cases.h"

namespace glint {
namespace {

using namespace test;

constexpr double kSlope = 0.005, kLength = 0.15;  // of the bumps: a third of a degree, an eighth of the shape
constexpr double kPrior = 0.01;
constexpr double kFacets =
    5e-3;  // of the light's distance: what flat triangles under interpolated normals cost, twice as much as measured

/// Exact contours of the true shape, seen on a mesh of it that has bumps.
struct Case {
  Synthetic scene;
  std::shared_ptr<const Surface> mesh;
  std::vector<BundleView> views;

  Case(Synthetic s, double slope, double scale = 1, double noisePx = 0, unsigned seed = 1, unsigned bumps = 5)
      : scene(std::move(s)) {
    mesh = makeMesh(bumpyMesh(scene.surface, slope, kLength * scale, bumps), NormalPolicy::Interpolated);
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
      Highlight h = exactHighlightsOf(scene, scene.cameras[i])[0];
      h.contour.points = resample(h.contour, 72);
      h = withNoise(h, noisePx, seed, int(i), 0);
      views.push_back({scene.cameras[i], mesh.get(), h.contour.points, {}});
    }
  }
  Light start() const { return Light::at(1.05 * scene.light.lamp.position()); }
  /// RMS angle between the true shape's normals and a mesh's along the contours, each pixel's own: what a highlight there is off
  /// by.
  double normalsOff(const Surface& other) const {
    const std::shared_ptr<const Surface> truth = makeAnalytic(scene.surface);
    double sum = 0, count = 0;
    for (const BundleView& v : views)
      for (const Pixel& p : v.contour) {
        const Outcome<SurfacePoint> a = truth->firstHit(v.camera.ray(p)), b = other.firstHit(v.camera.ray(p));
        if (!a || !b) continue;
        sum += a->normal.cross(b->normal).squaredNorm();
        ++count;
      }
    return std::sqrt(sum / count);
  }
  double lightError(const Light& light) const {
    return (light.position() - scene.light.lamp.position()).norm() / scene.light.lamp.position().norm();
  }
};

// Measured: normals along the contours 6.4 -> 1.6 mrad off, residual 0.51 -> 0.02 px, light 3.7 -> 2.2 % off.
TEST(RefineNormals, Nominal) {
  const Case c(ellipsoidScene(8), kSlope);
  const Outcome<Bundle> plain = bundleLight(c.views, c.start());
  const Outcome<NormalRefinement> r = refineNormals(c.views, c.start(), kPrior);
  ASSERT_TRUE(plain && r) << (r ? "" : r.failure().message());
  EXPECT_GT(r->plainRmsPx, 0.3) << "the test could not fail";
  EXPECT_LT(r->rmsPx, 0.1 * r->plainRmsPx);
  ASSERT_TRUE(r->correction.changesAnything());
  const Outcome<std::shared_ptr<const Surface>> corrected = correctedMesh(*c.mesh, NormalPolicy::Interpolated, r->correction);
  ASSERT_TRUE(corrected);
  EXPECT_LT(c.normalsOff(**corrected), 0.5 * c.normalsOff(*c.mesh));
  EXPECT_LT(c.lightError(r->light), 0.8 * c.lightError(plain->light)) << "a tilt that all views share is nearly a moved light";
  EXPECT_NEAR(r->limitAngle, c.scene.limitAngle, 0.02 * c.scene.limitAngle);
  // The corrected mesh keeps what was promised: the plain bundle on it leaves as little.
  std::vector<BundleView> again = c.views;
  for (BundleView& v : again) v.surface = corrected->get();
  const Outcome<Bundle> after = bundleLight(again, r->light);
  ASSERT_TRUE(after);
  EXPECT_LT(after->rmsPx, 0.15 * plain->rmsPx);
  ASSERT_TRUE(r->uncertainty);
  EXPECT_EQ(r->uncertainty->root.rows(), 5);
}

// Nominal has one set of bumps, on which the light gains, too. On others the normals gain (measured on four sets: 0.28 of their
// error, geometric mean), but the light may lose, 2.4 times as far off as before on the fourth: a tilt that all views share is
// nearly a moved light. The remark says so.
TEST(RefineNormals, NormalsGainWhateverTheBumpsTheLightMayNot) {
  double logNormals = 0;
  const std::vector<unsigned> all = testing_support::cases<unsigned>({1, 2, 3, 4});
  for (const unsigned bumps : all) {
    const Case c(ellipsoidScene(8), kSlope, 1, 0, 1, bumps);
    const Outcome<Bundle> plain = bundleLight(c.views, c.start());
    const Outcome<NormalRefinement> r = refineNormals(c.views, c.start(), kPrior);
    ASSERT_TRUE(plain && r && r->correction.changesAnything()) << bumps;
    EXPECT_LT(r->rmsPx, 0.15 * r->plainRmsPx) << bumps;
    const Outcome<std::shared_ptr<const Surface>> corrected = correctedMesh(*c.mesh, NormalPolicy::Interpolated, r->correction);
    ASSERT_TRUE(corrected);
    logNormals += std::log(c.normalsOff(**corrected) / c.normalsOff(*c.mesh)) / double(all.size());
    RecordProperty("bumps_" + std::to_string(bumps),
                   std::to_string(c.normalsOff(**corrected) / c.normalsOff(*c.mesh)) + " normals, " +
                       std::to_string(c.lightError(r->light) / c.lightError(plain->light)) + " light");
  }
  if (!testing_support::kSanitized) {
    EXPECT_LT(std::exp(logNormals), 0.6);
  }
}

TEST(RefineNormals, Scale) {
  const Case one(ellipsoidScene(8), kSlope);
  const Outcome<NormalRefinement> reference = refineNormals(one.views, one.start(), kPrior);
  ASSERT_TRUE(reference && reference->correction.changesAnything());
  for (const double scale : {1e-4, 1e4}) {
    const Case c(moved(ellipsoidScene(8), Eigen::Isometry3d::Identity(), scale), kSlope, scale);
    const Outcome<NormalRefinement> r = refineNormals(c.views, c.start(), kPrior);
    ASSERT_TRUE(r) << scale;
    // The contours are traced anew at every scale, to 1e-9 px; where a centre is chosen among near equals the sum is the same,
    // not its parts.
    EXPECT_NEAR(r->slope, reference->slope, 1e-3 * reference->slope) << scale;
    EXPECT_NEAR(r->correction.length / scale, reference->correction.length, 1e-6) << scale;
    EXPECT_LT((r->light.position() / scale - reference->light.position()).norm(), 1e-3) << scale;
  }
}

// Measured on four seeds: normals along the contours 6.4 -> 2.0 mrad off.
TEST(RefineNormals, Noise) {
  double before = 0, after = 0;
  constexpr unsigned kSeeds = 4;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const Case c(ellipsoidScene(8), kSlope, 1, 0.3, seed);
    const Outcome<NormalRefinement> r = refineNormals(c.views, c.start(), kPrior);
    ASSERT_TRUE(r && r->correction.changesAnything()) << seed;
    EXPECT_NEAR(r->rmsPx, 0.3, 0.03) << "what remains is the noise";
    const Outcome<std::shared_ptr<const Surface>> corrected = correctedMesh(*c.mesh, NormalPolicy::Interpolated, r->correction);
    ASSERT_TRUE(corrected);
    before += c.normalsOff(*c.mesh);
    after += c.normalsOff(**corrected);
  }
  EXPECT_LT(after, 0.6 * before);
}

TEST(RefineNormals, ACleanMeshStaysAsItIs) {
  for (const double noise : {0.0, 0.3}) {
    const Case c(ellipsoidScene(8), 0, 1, noise);
    const Outcome<NormalRefinement> r = refineNormals(c.views, c.start(), kPrior);
    ASSERT_TRUE(r);
    EXPECT_FALSE(r->correction.changesAnything()) << noise;
    EXPECT_EQ(r->slope, 0) << noise;
    // Nothing but light and limit angle was estimated.
    EXPECT_LT(c.lightError(r->light), noise > 0 ? 0.02 : kFacets) << noise;
  }
}

// Contours of another angle in every second view: a model that expects them explains all there is, so that nothing is left for
// the normals.
TEST(RefineNormals, WhatTheModelExpectsBendsNothing) {
  constexpr double kMore = 0.01;  // rad
  Case c(ellipsoidScene(8), 0);
  Synthetic wider = c.scene;
  wider.limitAngle += kMore;
  for (std::size_t i = 1; i < c.views.size(); i += 2)
    c.views[i].contour = resample(exactHighlightsOf(wider, wider.cameras[i])[0].contour, 72);
  const Outcome<NormalRefinement> constant = refineNormals(c.views, c.start(), kPrior);
  ASSERT_TRUE(constant);
  EXPECT_GT(constant->plainRmsPx, 0.5) << "the test could not fail";
  const Outcome<NormalRefinement> told =
      refineNormals(c.views, c.start(), kPrior, {}, [&](std::size_t view, const Pixel&) { return view % 2 ? kMore : 0.0; });
  ASSERT_TRUE(told);
  EXPECT_LT(told->plainRmsPx, 0.05);
  EXPECT_FALSE(told->correction.changesAnything());
  EXPECT_NEAR(told->limitAngle, c.scene.limitAngle, 1e-4);
  EXPECT_LT(c.lightError(told->light), kFacets);
}

TEST(RefineNormals, Degenerate) {
  EXPECT_EQ(refineNormals({}, Light::at({0, 0, 1}), kPrior).failure().reason, Reason::TooFewPoints);
  EXPECT_THROW((void)refineNormals({}, Light::at({0, 0, 1}), 0), std::invalid_argument);
  Case broken(ellipsoidScene(3), kSlope);
  broken.views[1].contour[3].x() = std::nan("");
  EXPECT_EQ(refineNormals(broken.views, broken.start(), kPrior).failure().reason, Reason::NotFinite);
  const Case c(ellipsoidScene(8), kSlope);
  EXPECT_EQ(
      refineNormals(c.views, c.start(), kPrior, {}, [](std::size_t, const Pixel&) { return std::nullopt; }).failure().reason,
      Reason::TooFewPoints);
  // Identical views: nothing tells a bump from a moved light, so that a common tilt stays open; the answer is finite.
  Synthetic same = ellipsoidScene(8);
  same.cameras.assign(4, same.cameras[3]);
  const Case one(same, kSlope);
  const Outcome<NormalRefinement> r = refineNormals(one.views, one.start(), kPrior);
  if (r) {
    EXPECT_TRUE(r->light.homogeneous().allFinite());
    EXPECT_TRUE(r->correction.weights.allFinite());
    EXPECT_GT(r->openTilt, 0.6);
  }
  // Two views: none can be left out and leave three errors to compare, so that nothing is refined.
  Synthetic two = ellipsoidScene(8);
  two.cameras.resize(2);
  const Case few(two, kSlope);
  const Outcome<NormalRefinement> unsure = refineNormals(few.views, few.start(), kPrior);
  EXPECT_TRUE(!unsure || !unsure->correction.changesAnything());
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// light.smooth_mesh through the pipeline: a scanned mesh answers, an exact one is left alone.
#include "core/pipeline/smoothed_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "core/app/session.h"
#include "core/choice/choice_ground.h"
#include "core/pipeline/summary.h"
#include "tests/core/model/bumpy_mesh.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {

using namespace testing_support;

constexpr int kScans = 12;

/// Exact contours of a ball of 1 m, with a mesh of it whose vertices are off at random.
class SmoothedMeshTest : public testing::Test {
 protected:
  std::shared_ptr<Scene> scanned(double noise) {
    auto scene = exactScene(sphere(0.5), kScans);
    TriangleMesh mesh = makeAnalytic(sphere(0.5))->tessellate(Eigen::AlignedBox3d(), 100);
    std::mt19937 rng(3);
    std::normal_distribution<double> gauss;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) mesh.vertices[i] += noise * gauss(rng) * mesh.normals[i];
    mesh.normals.clear();
    const std::filesystem::path file = folder_.path() / ("scan" + std::to_string(noise) + ".ply");
    test::writePly(mesh, file);
    scene->surfaces["body"] = MeshFile{{file}};
    return scene;
  }
  static InspectionRequest request(const char* smooth) {
    InspectionRequest q;
    q.train = "spread:6";
    q.models = {"limit-angle"};
    q.settings.set("light.bundle_points", 36);
    q.settings.set("light.smooth_mesh", std::string(smooth));
    return q;
  }
  /// Mean over the held-out frames, % of the diameter; 1000 where one has no answer.
  static double errorPct(const Inspection& r) {
    double sum = 0, count = 0;
    for (const FrameComparison& c : r.models.at("limit-angle").frames) {
      if (!r.isHeldOut(c.frame)) continue;
      ++count;
      sum += c.rows.size() == 1 && c.rows[0].metrics ? c.rows[0].metrics->contourErrorPct : 1000;
    }
    return sum / count;
  }
  TemporaryFolder folder_;
};

// The truth is the ball's own contours.
TEST_F(SmoothedMeshTest, AScanAnswersAndSaysItsNoise) {
  constexpr double kNoise = 0.002;
  const auto scene = scanned(kNoise);
  const Inspection plain = inspect(scene, request("off")), smooth = inspect(scene, request("auto"));
  EXPECT_TRUE(plain.corrections.empty());
  ASSERT_EQ(smooth.corrections.count({"lamp"}), 1u);
  ASSERT_TRUE(smooth.corrections.at({"lamp"}).smoothed);
  const SmoothedMesh& mesh = *smooth.corrections.at({"lamp"}).smoothed;
  EXPECT_NEAR(mesh.noise, kNoise, 0.1 * kNoise);
  EXPECT_LT(errorPct(smooth), 2);
  EXPECT_LT(errorPct(smooth), 0.25 * errorPct(plain));
  for (const TrainingView& v : smooth.views) EXPECT_EQ(v.surface, mesh.mesh);
  for (int frame = 0; frame < kScans; ++frame) EXPECT_EQ(*surfaceFor(smooth, frame, "lamp"), mesh.mesh);
  const std::vector<std::string>& remarks = smooth.models.at("limit-angle").fits.at(0).fit->remarks;
  EXPECT_EQ(std::count(remarks.begin(), remarks.end(), mesh.remark()), 1);
  // Left-out views do not choose again.
  std::vector<Fold> folds = foldsOf(smooth, LeaveOut::Place);
  ASSERT_TRUE(fitFold(folds.front(), modelByName("limit-angle"), smooth.request.settings));
  EXPECT_EQ(folds.front().leftSurface, mesh.mesh);
  // Results that are taken over are those of a fresh run.
  EXPECT_EQ(digestOf(inspect(scene, request("auto"), {}, &plain)), digestOf(smooth));
  EXPECT_EQ(digestOf(inspect(scene, request("off"), {}, &smooth)), digestOf(plain));
}

// The automatic choice starts from evidence alone. It smooths the scan once, for all views.
TEST_F(SmoothedMeshTest, AChoiceSmoothsOnce) {
  const auto scene = scanned(0.002);
  InspectionRequest evidence = request("auto");
  evidence.models.clear();
  ChoiceGround ground(inspect(scene, evidence), 4);
  for (int i = 0; i < 2; ++i) ground.findLights({});
  EXPECT_EQ(ground.inspection.work.lights, 1);
  ASSERT_EQ(ground.inspection.corrections.count({"lamp"}), 1u);
  const SmoothedMesh& mesh = *ground.inspection.corrections.at({"lamp"}).smoothed;
  EXPECT_EQ(mesh.radius, inspect(scene, request("auto")).corrections.at({"lamp"}).smoothed->radius) << "as a model alone";
  ASSERT_EQ(ground.folds.size(), 6u);
  for (const std::size_t i : {0u, 5u}) {
    ASSERT_TRUE(fitFold(ground.folds[i], modelByName("limit-angle"), evidence.settings));
    EXPECT_EQ(ground.folds[i].leftSurface, mesh.mesh);
  }
  ASSERT_EQ(ground.views.size(), 4u);
  for (const ViewToPredict& view : ground.views) EXPECT_EQ(view.surface, mesh.mesh);
}

TEST_F(SmoothedMeshTest, WhatTheHighlightsDoNotContradictStays) {
  EXPECT_TRUE(inspect(scanned(0), request("auto")).corrections.empty()) << "an exact mesh";
  EXPECT_TRUE(inspect(exactScene(sphere(0.5), kScans), request("auto")).corrections.empty()) << "an exact shape";
  InspectionRequest facets = request("auto");
  facets.settings.set("surface.normals", std::string("facet"));
  EXPECT_TRUE(inspect(scanned(0.002), facets).corrections.empty()) << "facets have no normals of vertices";
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// light.refine_normals through the pipeline: who uses the corrected mesh, and when there is one.
#include "core/pipeline/refined_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/app/session.h"
#include "core/choice/leave_one_out.h"
#include "core/pipeline/summary.h"
#include "core/surface/mesh_policy.h"
#include "tests/core/model/bumpy_mesh.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {

using namespace testing_support;

constexpr int kPhotographs = 12;

/// Exact contours of a ball, with a mesh of it that has bumps of 10 mrad, half as wide as the ball.
class RefinedNormalsTest : public testing::Test {
 protected:
  std::shared_ptr<Scene> bumpy(double slope = 0.01) {
    auto scene = exactScene(sphere(0.5), kPhotographs);
    const std::filesystem::path file = folder_.path() / ("ball" + std::to_string(slope) + ".ply");
    test::writePly(test::bumpyMesh(sphere(0.5), slope, 0.12, 7, 200), file);
    scene->surfaces["body"] = MeshFile{{file}};
    return scene;
  }
  static InspectionRequest request(bool refine) {
    InspectionRequest q;
    q.train = "spread:6";
    q.models = {"limit-angle"};
    q.settings.set("light.bundle_points", 36);
    q.settings.set("fit.lobe", std::string("torrance-sparrow"));  // one lobe instead of four: the tests are quicker
    if (refine) q.settings.set("light.refine_normals", true);
    return q;
  }
  /// Mean over the held-out frames, % of the diameter; 1000 where one has no answer.
  static double errorPct(const Inspection& r, const std::string& model) {
    double sum = 0, count = 0;
    for (const FrameComparison& c : r.models.at(model).frames) {
      if (!r.isHeldOut(c.frame)) continue;
      ++count;
      sum += c.rows.size() == 1 && c.rows[0].metrics ? c.rows[0].metrics->contourErrorPct : 1000;
    }
    return sum / count;
  }
  TemporaryFolder folder_;
};

// The truth is the ball's own contours. Measured: limit-angle 1.85 -> 0.11 %, canonical 1.92 -> 0.58 %, reflectance 2.10 -> 0.11
// %.
TEST_F(RefinedNormalsTest, HeldOutFramesGainForEveryModel) {
  const auto scene = bumpy();
  InspectionRequest without = request(false), with = request(true);
  without.models = with.models = {"limit-angle", "canonical", "reflectance"};
  const Inspection plain = inspect(scene, without), refined = inspect(scene, with);
  EXPECT_TRUE(plain.corrections.empty());
  ASSERT_EQ(refined.corrections.count({"lamp"}), 1u);
  for (const std::string& model : with.models) {
    EXPECT_LT(errorPct(refined, model), 0.5 * errorPct(plain, model)) << model;
    const std::vector<std::string>& remarks = refined.models.at(model).fits.at(0).fit->remarks;
    EXPECT_TRUE(std::any_of(remarks.begin(), remarks.end(), [](const std::string& r) {
      return r.find("light.refine_normals") != std::string::npos;
    })) << model;
  }
  const RefinedNormals& r = *refined.corrections.at({"lamp"}).normals;
  EXPECT_EQ(r.surface, "body");
  EXPECT_LT(r.refinedPx, 0.2 * r.plainPx);
  for (const TrainingView& v : refined.views) EXPECT_EQ(v.surface, r.mesh);
  for (int frame = 0; frame < kPhotographs; ++frame) EXPECT_EQ(*surfaceFor(refined, frame, "lamp"), r.mesh);
}

TEST_F(RefinedNormalsTest, IncrementalEqualsFresh) {
  const auto scene = bumpy();
  InspectionRequest finer = request(true), wider = request(true), lobe = request(true);
  lobe.settings.set("fit.lobe", std::string("ggx"));  // reflectance may tell what the angles are
  finer.settings.set("predict.directions", 24);
  wider.settings.set("light.normal_sigma", 0.1);
  finer.models = {"canonical"};
  const Inspection off = inspect(scene, request(false)), on = inspect(scene, request(true));
  const auto expectFresh = [&](const InspectionRequest& after, const Inspection& before, const char* what) {
    EXPECT_EQ(digestOf(inspect(scene, after, {}, &before)), digestOf(inspect(scene, after))) << what;
  };
  EXPECT_EQ(digestOf(inspect(scene, request(true), {}, &off)), digestOf(on)) << "turned on";
  EXPECT_EQ(digestOf(inspect(scene, request(false), {}, &on)), digestOf(off)) << "turned off";
  EXPECT_EQ(digestOf(inspect(scene, request(true), {}, &on)), digestOf(on)) << "nothing changed";
  expectFresh(finer, on, "a model that was not there");
  expectFresh(wider, on, "another prior");
  expectFresh(lobe, on, "another lobe");
}

// Nothing is corrected that is not a mesh with normals of its own, seen by all views.
TEST_F(RefinedNormalsTest, WhatHasNoNormalsToTurnStays) {
  EXPECT_TRUE(inspect(exactScene(sphere(0.5), kPhotographs), request(true)).corrections.empty()) << "an exact shape";
  EXPECT_TRUE(inspect(bumpy(0), request(true)).corrections.empty()) << "a mesh without bumps";
  const auto scene = bumpy();
  InspectionRequest facets = request(true), triangulated = request(true);
  facets.settings.set("surface.normals", std::string("facet"));
  triangulated.settings.set("light.solver", std::string("triangulated"));
  EXPECT_TRUE(inspect(scene, facets).corrections.empty());
  EXPECT_TRUE(inspect(scene, triangulated).corrections.empty());
  // A frame that does not train and sees another surface keeps it; one that trains keeps all meshes as they are.
  AnalyticSpec other = sphere(0.5);
  scene->surfaces["other"] = other;
  scene->frames[1].surface = "other";
  const Inspection mixed = inspect(scene, request(true));
  ASSERT_EQ(mixed.corrections.count({"lamp"}), 1u);
  EXPECT_NE(*surfaceFor(mixed, 1, "lamp"), mixed.corrections.at({"lamp"}).normals->mesh);
  EXPECT_EQ(*surfaceFor(mixed, 3, "lamp"), mixed.corrections.at({"lamp"}).normals->mesh);
  scene->frames[2].surface = "other";
  EXPECT_TRUE(inspect(scene, request(true)).corrections.empty());
}

// What is left out must not have helped to correct the surface that it is predicted on.
TEST_F(RefinedNormalsTest, AFoldCorrectsTheMeshItself) {
  const Inspection refined = inspect(bumpy(), request(true));
  const std::shared_ptr<const Surface> ofAll = refined.corrections.at({"lamp"}).normals->mesh;
  const std::shared_ptr<const Surface> given = *refined.surfaces->surfaceOf(0, meshPolicy(refined.request.settings));
  std::vector<Fold> folds = foldsOf(refined, LeaveOut::Place);
  ASSERT_EQ(folds.size(), 6u);
  Fold& fold = folds.front();
  EXPECT_EQ(fold.left.surface, given);
  for (const TrainingView& v : fold.others) EXPECT_EQ(v.surface, given);
  ASSERT_TRUE(fitFold(fold, modelByName("limit-angle"), refined.request.settings));
  ASSERT_TRUE(fold.light && fold.light->correction.normals);
  EXPECT_EQ(fold.leftSurface, fold.light->correction.normals->mesh);
  EXPECT_NE(fold.leftSurface, ofAll);
}

}  // namespace
}  // namespace glint

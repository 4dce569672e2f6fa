// SPDX-License-Identifier: BSD-3-Clause
// Whether the automatic choice walks on local quadrics. On planes, spheres and cylinders a local quadric is the surface itself
// (Eq. (quadric)); elsewhere the curvature's variation over the highlight decides, then the rule of the choice.
#include <gmock/gmock.h>

#include <fstream>
#include <numbers>

#include "core/choice/selection.h"
#include "core/model/star.h"
#include "core/pipeline/summary.h"
#include "core/report/report.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;

struct Chosen {
  Inspection evidence;
  Selection selection;
};

Chosen patchChoiceOn(std::shared_ptr<const Scene> scene, std::optional<double> goodEnough = {},
                     const std::string& train = "spread:6", double noisePx = 0,
                     const std::vector<std::pair<std::string, std::string>>& settings = {}) {
  InspectionRequest request;
  request.models.clear();
  request.train = train;
  request.noisePx = noisePx;
  for (const auto& [key, value] : settings) request.settings.setFromText(key, value);
  Chosen c{inspect(std::move(scene), request), {}};
  c.selection = selectModel(c.evidence, goodEnough);
  return c;
}

std::string queryOf(const Chosen& c) { return chosenRequest(c.evidence.request, c.selection).settings.text("predict.query"); }

/// Seen on its flank, 40 degrees from the outer equator, where its curvature changes along the tube.
AnalyticSpec torus(double minor) {
  AnalyticSpec spec;
  spec.type = "torus";
  spec.majorRadius = 0.5;
  spec.minorRadius = minor;
  const double a = 40 * std::numbers::pi / 180;
  const Eigen::Vector3d normal(std::cos(a), 0, std::sin(a));
  spec.worldFromSurface.linear() = Eigen::Quaterniond::FromTwoVectors(normal, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  spec.worldFromSurface.translation() = -(spec.worldFromSurface.linear() * (Eigen::Vector3d(0.5, 0, 0) + minor * normal));
  return spec;
}

/// Touches the plane z = 0 at the origin, away from its vertices.
AnalyticSpec flatterEllipsoid(double ratio) {
  AnalyticSpec spec;
  spec.type = "ellipsoid";
  spec.semiAxes = {0.6, 0.6 * ratio, 0.6 * ratio};
  const double x = 0.4, z = 0.6 * ratio * std::sqrt(1 - x * x / 0.36);
  const Eigen::Vector3d normal = Eigen::Vector3d(x / 0.36, 0, z / (0.36 * ratio * ratio)).normalized();
  spec.worldFromSurface.linear() = Eigen::Quaterniond::FromTwoVectors(normal, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  spec.worldFromSurface.translation() = -(spec.worldFromSurface.linear() * Eigen::Vector3d(x, 0, z));
  return spec;
}

/// A tolerance that `limit-angle`, which walks, is the first to meet. Without one `reflectance`, which does not walk, would be
/// tried, and chosen where the two disagree on frames that nobody observed.
constexpr double kWalks = 0.02;

// Nominal: exact there, so taken, and the frames to predict lose nothing that the rule does not allow.
TEST(PatchChoice, Nominal) {
  for (const AnalyticSpec& spec : {sphere(0.5), cylinder(0.4)}) {
    const Chosen c = patchChoiceOn(exactScene(spec, 8));
    ASSERT_EQ(c.selection.model, "limit-angle") << selectionTable(c.selection);
    ASSERT_TRUE(c.selection.patches);
    const PatchChoice& p = *c.selection.patches;
    EXPECT_TRUE(p.goodEnough) << p.why;
    EXPECT_LT(p.variation, 1e-9) << spec.type;
    EXPECT_EQ(p.views, 6);
    EXPECT_EQ(p.others, 2);
    EXPECT_GT(p.predictUs, 0);
    EXPECT_GT(p.exactUs, 0);
    EXPECT_GT(p.timeUs, 0) << "what it cost to find out is told";
    EXPECT_THAT(p.why, HasSubstr("good enough"));
    EXPECT_EQ(queryOf(c), "local-quadric");
    const Inspection result = inspect(c.evidence.scene, chosenRequest(c.evidence.request, c.selection), {}, &c.evidence);
    EXPECT_LT(summarise(result, result.models.at("limit-angle")).contourErrorPct.mean, kNegligiblePct);
    ReportContext report;
    report.selection = c.selection;
    EXPECT_THAT(evaluationJson(result, report), HasSubstr("\"local_quadric\""));
  }
}

// A thin tube bends several times more than the criterion allows (docs/performance.md).
TEST(PatchChoice, ABentSurfaceKeepsExactWalks) {
  for (const double minor : {0.1, 0.2}) {
    const auto scene = exactScene(torus(minor), 6);
    for (Frame& f : scene->frames) {  // the one on the flank; another is on the inner wall
      const Pixel middle = *f.camera.project(Eigen::Vector3d::Zero());
      const auto nearest = std::min_element(
          f.highlights.begin(), f.highlights.end(),
          [&](const Highlight& a, const Highlight& b) { return (a.peak - middle).norm() < (b.peak - middle).norm(); });
      f.highlights = {*nearest};
    }
    const Chosen c = patchChoiceOn(scene);
    ASSERT_EQ(c.selection.model, "limit-angle") << selectionTable(c.selection);
    ASSERT_TRUE(c.selection.patches);
    const PatchChoice& p = *c.selection.patches;
    EXPECT_FALSE(p.goodEnough) << p.why;
    EXPECT_GT(p.variation, kLargestVariation) << minor;
    EXPECT_THAT(p.why, HasSubstr("the curvature varies"));
    EXPECT_TRUE(std::isnan(p.predictUs)) << "nothing is timed once the answer is known";
    EXPECT_EQ(queryOf(c), "exact");
  }
}

// Seen from v3 the light is not mirrored where the others say: no model predicts that highlight. It counts against none, and a
// contour that is off by fifteen diameters is no answer to it: `primal` would have been the only one to answer every view.
TEST(PatchChoice, AUselessContourIsNoAnswer) {
  const Chosen c = patchChoiceOn(exactScene(torus(0.1), 6), {}, "spread:6", 0,
                                 {{"fit.lobe", "phong"}, {"fit.light_size", "point"}, {"light.bundle_points", "12"}});
  EXPECT_EQ(c.selection.model, "limit-angle") << selectionTable(c.selection);
  EXPECT_LT(c.selection.candidates[0].answered, 12);
  EXPECT_GE(c.selection.candidates[0].tried, 1);
  EXPECT_LT(c.selection.candidates.back().tried, 12) << "it cannot become the best: not all of its views are tried";
  EXPECT_THAT(c.selection.candidates.back().remark, HasSubstr("given up"));
}

// Under the criterion the rule still decides: a patch that costs a quarter of a percent is taken only where noise hides that or a
// tolerance allows it.
TEST(PatchChoice, TheRuleDecidesBelowTheCriterion) {
  const auto scene = exactScene(flatterEllipsoid(0.8), 8);
  const Chosen exact = patchChoiceOn(scene);
  ASSERT_EQ(exact.selection.model, "limit-angle") << selectionTable(exact.selection);
  ASSERT_TRUE(exact.selection.patches);
  EXPECT_LT(exact.selection.patches->variation, kLargestVariation);
  EXPECT_GT(exact.selection.patches->variation, 1e-3);
  EXPECT_FALSE(exact.selection.patches->goodEnough) << exact.selection.patches->why;
  EXPECT_THAT(exact.selection.patches->why, HasSubstr("that the rule allows"));
  const double onPatches = exact.selection.patches->meanPct;
  EXPECT_GT(onPatches, kNegligiblePct);

  // Both tolerances are below what any simpler model reaches.
  const Chosen allowed = patchChoiceOn(scene, 1.02 * onPatches), tight = patchChoiceOn(scene, 0.98 * onPatches);
  ASSERT_EQ(allowed.selection.model, "limit-angle") << selectionTable(allowed.selection);
  EXPECT_TRUE(allowed.selection.patches->goodEnough) << allowed.selection.patches->why;
  ASSERT_EQ(tight.selection.model, "limit-angle") << selectionTable(tight.selection);
  EXPECT_FALSE(tight.selection.patches->goodEnough) << tight.selection.patches->why;
}

// Noise: it hides what the patch neglects.
TEST(PatchChoice, Noise) {
  const Chosen c = patchChoiceOn(exactScene(flatterEllipsoid(0.9), 10), {}, "spread:8", 1.0);
  ASSERT_TRUE(c.selection.patches) << selectionTable(c.selection);
  EXPECT_EQ(c.selection.model, "limit-angle") << selectionTable(c.selection);
  EXPECT_TRUE(c.selection.patches->goodEnough) << c.selection.patches->why;
  EXPECT_LT(c.selection.patches->variation, kLargestVariation);
}

// Cameras and surfaces of the frames to predict are known beforehand: where they see a bent surface, what the training views
// show does not count.
TEST(PatchChoice, FramesToPredictMustAllowIt) {
  auto scene = exactScene(sphere(0.5), 6);
  scene->surfaces["tube"] = torus(0.1);
  const auto more = exactScene(sphere(0.5), 4);
  for (Frame f : more->frames) {
    f.id += "tube";
    f.surface = "tube";
    f.highlights.clear();
    scene->frames.push_back(f);
  }
  const Chosen c = patchChoiceOn(scene, kWalks, "0-5");
  ASSERT_EQ(c.selection.model, "limit-angle") << selectionTable(c.selection);
  EXPECT_FALSE(c.selection.patches->goodEnough);
  EXPECT_GT(c.selection.patches->variation, kLargestVariation);
  EXPECT_THAT(c.selection.patches->why, HasSubstr("tube"));
}

// The patch goes on where a sheet ends.
TEST(PatchChoice, ABorderKeepsExactWalks) {
  auto scene = exactScene(sheet(0.5), 8);
  scene->surfaces["strip"] = sheet(0.5);
  scene->surfaces["strip"].analytic()->length = 0.08;
  scene->surfaces["strip"].analytic()->width = 2.0;
  for (int i = 6; i < 8; ++i) scene->frames[i].surface = "strip";
  const Chosen c = patchChoiceOn(scene, kWalks, "0-5");
  ASSERT_TRUE(c.selection.patches) << selectionTable(c.selection);
  EXPECT_FALSE(c.selection.patches->goodEnough) << selectionTable(c.selection);
}

TEST(PatchChoice, Degenerate) {
  // Nothing walks: nothing is looked at.
  const Chosen plane = patchChoiceOn(exactScene(sheet(0), 8));
  EXPECT_EQ(plane.selection.model, "primal");
  EXPECT_FALSE(plane.selection.patches);
  // The user's walks are on patches already.
  const Chosen already = patchChoiceOn(exactScene(sphere(0.5), 8), {}, "spread:6", 0, {{"predict.query", "local-quadric"}});
  EXPECT_EQ(already.selection.model, "limit-angle");
  EXPECT_FALSE(already.selection.patches);
  EXPECT_EQ(queryOf(already), "local-quadric");
  // Nothing was chosen.
  const Chosen one = patchChoiceOn(exactScene(sphere(0.5), 4), {}, "0");
  EXPECT_FALSE(one.selection.patches);
  EXPECT_TRUE(chosenRequest(one.evidence.request, one.selection).models.empty());
}

// Flat triangles have no curvature: a named reason, not a guess.
TEST(PatchChoice, FacetsHaveNoPatches) {
  const TriangleMesh mesh = makeAnalytic(sphere(0.5))->tessellate(Eigen::AlignedBox3d(), 300);
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "ball.ply";
  std::ofstream ply(file);
  ply << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Eigen::Vector3d& v : mesh.vertices) ply << v.x() << " " << v.y() << " " << v.z() << "\n";
  for (const Eigen::Vector3i& t : mesh.triangles) ply << "3 " << t.x() << " " << t.y() << " " << t.z() << "\n";
  ply.close();
  auto scene = exactScene(sphere(0.5), 6);
  scene->surfaces["facets"] = MeshFile{{file}};
  scene->frames[5].surface = "facets";
  for (const bool flat : {true, false}) {
    const Chosen c = patchChoiceOn(scene, kWalks, "0-4", 0, {{"surface.normals", flat ? "facet" : "interpolated"}});
    ASSERT_TRUE(c.selection.patches) << selectionTable(c.selection);
    EXPECT_EQ(c.selection.patches->goodEnough, !flat) << c.selection.patches->why;
    if (flat) {
      EXPECT_THAT(c.selection.patches->why, HasSubstr(scene->frames[5].id));
    }
  }
}

}  // namespace
}  // namespace glint

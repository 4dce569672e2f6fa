// SPDX-License-Identifier: BSD-3-Clause
// Exact contours: no frame matters. One contour moved: that frame harms, and nothing else does.
#include "core/advise/influence.h"

#include <gmock/gmock.h>

#include <atomic>

#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {
using namespace testing_support;

Inspection inspected(std::shared_ptr<const Scene> scene, std::vector<std::string> models = {"limit-angle"}) {
  InspectionRequest request;
  request.models = std::move(models);
  request.train = "0-4";
  return inspect(std::move(scene), request);
}

TEST(Influence, NominalOnExactContoursNoFrameMatters) {
  const Inspection inspection = inspected(exactScene(sphere(0.5), 8), {"canonical", "limit-angle"});
  const Influence influence = measureInfluence(inspection);
  ASSERT_EQ(influence.frames.size(), 5u);
  EXPECT_EQ(influence.trainingFrames, 5);
  EXPECT_EQ(influence.probes, (std::vector<int>{5, 6, 7}));
  for (const FrameInfluence& f : influence.frames) {
    const ModelInfluence& m = f.models.at("limit-angle");
    ASSERT_TRUE(m.leftOutPct && m.changePct && m.lightShift);
    EXPECT_LT(*m.leftOutPct, 0.05);
    EXPECT_NEAR(*m.changePct, 0, 0.05);
    EXPECT_LT(*m.lightShift, 1e-3);
    EXPECT_FALSE(m.axesChange) << "limit-angle has no ellipsoid";
    EXPECT_TRUE(f.models.at("canonical").axesChange);
  }
}

TEST(Influence, AMovedContourIsFound) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 8);
  for (Pixel& p : scene->frames[2].highlights[0].contour.points) p.x() += 12;
  scene->frames[2].highlights[0].peak.x() += 12;
  const Influence influence = measureInfluence(inspected(scene));
  double worst = 0;
  int frame = -1;
  for (const FrameInfluence& f : influence.frames) {
    const std::optional<double> change = influenceOf(influence, f.frame, "limit-angle");
    ASSERT_TRUE(change) << f.frame;
    if (*change < worst) worst = *change, frame = f.frame;
  }
  EXPECT_EQ(frame, 2) << "predictions get better without it";
  const auto of = [&](int i) { return influence.frames[std::size_t(i)].models.at("limit-angle"); };
  EXPECT_LT(*of(2).heldOutPct, 0.1);  // the others are exact
  EXPECT_GT(*of(2).leftOutPct, 3);    // and predict it where it should be
  EXPECT_GT(*of(2).lightShift, *of(0).lightShift);
  EXPECT_NEAR(*of(2).heldOutPct - *of(2).changePct, influence.baselinePct.at("limit-angle"), 1e-12);  // sums of the same errors
}

TEST(Influence, WithoutHeldOutFramesTheFrameItselfTells) {
  const Inspection inspection = inspected(exactScene(sphere(0.5), 5));
  const Influence influence = measureInfluence(inspection);
  EXPECT_TRUE(influence.probes.empty());
  const std::optional<double> v = influenceOf(influence, 3, "limit-angle");
  ASSERT_TRUE(v);
  EXPECT_EQ(*v, *influence.frames[3].models.at("limit-angle").leftOutPct);
  EXPECT_FALSE(influenceOf(influence, 77, "limit-angle"));
  EXPECT_FALSE(influenceOf(influence, 3, "primal"));
}

TEST(Influence, DegenerateTooFewViewsWithoutIt) {
  InspectionRequest request;
  request.models = {"dual"};
  request.train = "0-2";
  request.settings.setFromText("fit.solver", "linear");
  const Influence influence = measureInfluence(inspect(exactScene(sphere(0.5), 6), request));
  ASSERT_EQ(influence.frames.size(), 3u);
  for (const FrameInfluence& f : influence.frames) {
    ASSERT_TRUE(f.models.at("dual").failure);
    EXPECT_EQ(f.models.at("dual").failure->reason, Reason::TooFewViews);
    EXPECT_FALSE(influenceOf(influence, f.frame, "dual"));
  }
}

TEST(Influence, StopsWhenAsked) {
  const Inspection inspection = inspected(exactScene(sphere(0.5), 8));
  std::atomic<int> calls{0};
  EXPECT_THROW(measureInfluence(inspection, [&](const StageEvent&) { return ++calls < 3; }), Stopped);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// The measurement on an exact scene: its numbers are those of `evaluate`, and it can be stopped and resumed.
#include "core/app/trial_measure.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "core/app/tradeoff_run.h"
#include "core/pipeline/summary.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;

class MeasureTradeoff : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene_ = exactScene(sphere(0.5), {{"lamp", {0.4, -0.6, 2.0}}}, 12, [](int) { return std::vector<std::string>{"lamp"}; });
  }
  static void TearDownTestSuite() { scene_.reset(); }
  static InspectionRequest request() {
    InspectionRequest r;
    r.models = {"limit-angle", "dual"};  // not in the order from simple to rich
    r.train = "spread:4";
    return r;
  }
  static TradeoffOptions few() {
    TradeoffOptions o;
    o.repeats = 1;
    o.search.maxTrials = 6;
    return o;
  }
  inline static std::shared_ptr<const Scene> scene_;
};

TEST_F(MeasureTradeoff, GivesTheNumbersOfEvaluate) {
  const Tradeoff t = measureTradeoff(scene_, request(), few());
  ASSERT_GE(t.points.size(), 2u);
  EXPECT_EQ(t.train, (std::vector<int>{0, 3, 6, 9}));
  for (const TradeoffPoint& p : t.points) {
    InspectionRequest q = request();
    q.models = {p.model};
    q.settings = p.settings;
    const Inspection r = inspect(scene_, q);
    const ModelSummary s = summarise(r, r.models.at(p.model));
    EXPECT_EQ(p.contourErrorPct, s.contourErrorPct.mean) << p.model;
    EXPECT_EQ(p.iou, s.iou.mean);
    EXPECT_EQ(p.frames, 8);
    EXPECT_EQ(p.predicted, s.predicted);
    EXPECT_GT(p.predictUs, 0);
    EXPECT_GT(p.fitUs, 0);
    EXPECT_GT(p.peakMb, 1);
  }
  ASSERT_TRUE(t.chosen);
  EXPECT_EQ(t.points[t.presets.at("exact")].model, "limit-angle") << "the model that made the contours";
}

TEST_F(MeasureTradeoff, PerSurfaceCountsEveryFrame) {
  InspectionRequest q = request();
  q.train = "per-surface";
  q.models = {"limit-angle"};
  const Tradeoff t = measureTradeoff(scene_, q, few());
  ASSERT_FALSE(t.points.empty());
  EXPECT_EQ(t.points[0].frames, 12);
}

TEST_F(MeasureTradeoff, ResumesWhereItWasStopped) {
  const TemporaryFolder folder, inputs;
  const auto scene = std::make_shared<Scene>(*scene_);
  scene->file = inputs.write("scene.json", "{}");  // work belongs to files with their contents
  TradeoffOptions options = few();
  options.workFile = folder / "work";
  options.program = "test";
  const auto countTo = [](int limit) {
    return [limit](const StageEvent& e) { return e.stage.rfind("tradeoff: try", 0) != 0 || e.done < limit; };
  };
  EXPECT_THROW(measureTradeoff(scene, request(), options, countTo(4)), Stopped);
  const std::string kept = contentOf(options.workFile);
  EXPECT_NE(kept.find("\"error_pct\""), std::string::npos);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator()), 1)
      << "nothing half written";

  // The resumed run must not measure again what is there: a number that no measurement gives survives.
  std::string marked = kept;
  const std::string key = "\"us\": ";
  const std::size_t at = marked.find(key) + key.size();
  marked.replace(at, marked.find_first_of(",\n", at) - at, "123456789.25");
  folder.write("work", marked);
  const Tradeoff resumed = measureTradeoff(scene, request(), options);
  EXPECT_NE(contentOf(options.workFile).find("123456789.25"), std::string::npos);
  EXPECT_GE(resumed.points.size(), 2u);

  InspectionRequest other = request();
  other.train = "spread:5";
  EXPECT_THROW(measureTradeoff(scene, other, options, countTo(3)), Stopped);
  EXPECT_EQ(contentOf(options.workFile).find("123456789.25"), std::string::npos) << "another request starts anew";
  folder.write("work", marked);
  inputs.write("scene.json", "{ }");
  EXPECT_THROW(measureTradeoff(scene, request(), options, countTo(3)), Stopped);
  EXPECT_EQ(contentOf(options.workFile).find("123456789.25"), std::string::npos) << "so does a changed input";
}

TEST_F(MeasureTradeoff, TooFewViewsLeavesNoPointAndAReason) {
  InspectionRequest q = request();
  q.train = "0";
  q.models = {"dual"};
  const Tradeoff t = measureTradeoff(scene_, q, few());
  EXPECT_TRUE(t.points.empty());
  EXPECT_FALSE(t.chosen);
  ASSERT_FALSE(t.pruned.empty());
  EXPECT_THAT(t.pruned[0].reason, testing::HasSubstr("too few views"));
}

// 64 MB that are touched and freed again must be in the peak, and no longer after a restart.
TEST(PeakMemory, SeesAnAllocationUntilItIsRestarted) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer keeps freed memory";
#endif
  if (!restartPeakMemory()) GTEST_SKIP() << "the system does not allow resetting the mark";
  const double before = peakMemoryMb();
  {
    std::vector<char> block(64 << 20, 1);
    ASSERT_EQ(block[block.size() / 2], 1);
  }
  EXPECT_GT(peakMemoryMb(), before + 60);
  restartPeakMemory();
  EXPECT_LT(peakMemoryMb(), before + 30);
}

}  // namespace
}  // namespace glint

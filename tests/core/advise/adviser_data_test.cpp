// SPDX-License-Identifier: BSD-3-Clause
// Real and path-traced sequences: the verdict names what the table of held-out errors shows best, and no remedy is worse
// than what is there.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "core/advise/diagnosis.h"
#include "core/base/solver_trace.h"
#include "core/model/model.h"
#include "core/pipeline/summary.h"

namespace glint::adviser_data_tests {

class AdviserData : public testing::TestWithParam<const char*> {};

/// The best of each by `glint evaluate`, whose table is computed apart from the adviser: mean contour errors over held-out
/// highlights.
TEST_P(AdviserData, NamesTheBestHeldOutModelAtOnce) {
  const std::filesystem::path file = std::filesystem::path(GLINT_SOURCE_DIR) / GetParam() / "scene.json";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no data in " << file;
  const auto scene = std::make_shared<const Scene>(readScene(file.string()));
  const Inspection inspection = inspect(scene, {});
  std::string best;
  double least = 1e9;
  for (const auto& [model, result] : inspection.models) {
    const ModelSummary s = summarise(inspection, result);
    if (s.answered && s.missed == 0 && s.contourErrorPct.mean < least) best = model, least = s.contourErrorPct.mean;
  }
  DiagnoseOptions options;
  options.present = best == "primal" ? "dual" : "primal";
  options.mostTried = 0;
  options.askAuto = false;
  Diagnosis d = diagnose(inspection, options);
  for (const auto& [present, result] : inspection.models) {
    SCOPED_TRACE(present);
    adviseFor(d, present);
    EXPECT_EQ(d.best, best);
    for (const Remedy& r : d.remedies) {
      const ModelSummary after = summarise(inspection, inspection.models.at(r.change.model.value()));
      EXPECT_NE(r.change.model, present);
      EXPECT_LT(after.wrongPct, summarise(inspection, result).wrongPct) << flagsOf(r.change);
    }
    if (present == best) {
      EXPECT_TRUE(d.remedies.empty());
      continue;
    }
    ASSERT_FALSE(d.remedies.empty()) << d.verdict;
    EXPECT_EQ(d.remedies.front().change.model, best);
    EXPECT_NE(d.verdict.find("Use " + best), std::string::npos) << d.verdict;
  }
}

/// No lobe of one width explains the pixels of brushed metal. To find that out takes as long as a fit that succeeds.
class AdviserUnexplained : public testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path file = std::filesystem::path(GLINT_SOURCE_DIR) / "../shared/data/ladder/brushed/scene.json";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no data in " << file;
    scene_ = std::make_shared<const Scene>(readScene(file.string()));
  }
  std::shared_ptr<const Scene> scene_;
};

TEST_F(AdviserUnexplained, PixelsThatNoLobeExplainsAreNotWaitedFor) {
  const Inspection inspection = inspect(scene_, {});
  std::vector<Diagnosis> said;
  DiagnoseOptions options;
  options.soFar = [&](const Diagnosis& d) { said.push_back(d); };
  EXPECT_THROW(diagnose(inspection, options, [&](const StageEvent&) { return said.empty() || said.back().remedies.empty(); }),
               Stopped);
  ASSERT_FALSE(said.empty());
  const Diagnosis& d = said.back();
  ASSERT_FALSE(d.remedies.empty());
  EXPECT_EQ(d.present, "reflectance");
  // It is offered as it was measured: with its settings, other frames train by contours.
  const Remedy& best = d.remedies.front();
  EXPECT_FALSE(best.change.alsoSet.empty()) << flagsOf(best.change);
  InspectionRequest request = with(inspection.request, best.change, *scene_);
  request.models = {best.change.model.value_or(d.present)};
  const Inspection after = inspect(scene_, request);
  const ModelSummary now = summarise(inspection, inspection.models.at(d.present)),
                     then = summarise(after, after.models.begin()->second);
  EXPECT_DOUBLE_EQ(then.wrongPct, d.measured.back().error.pct());
  EXPECT_LT(then.wrongPct, now.wrongPct);
}

TEST_F(AdviserUnexplained, PixelsThatNoLobeExplainsAreFittedOnce) {
  const auto fitsOf = [&](const char* model) {
    InspectionRequest request;
    request.models = {model};
    request.train = "0-2";
    const SolverTrace trace;
    const Inspection r = inspect(scene_, request);
    EXPECT_FALSE(r.pixelFits.begin()->second);
    const ModelResult::Fit& fit = r.models.at(model).fits.at(0);
    if (std::string(model) == "reflectance") EXPECT_TRUE(fit.fit && fit.fit->solver == "contours");
    return std::count_if(trace.runs().begin(), trace.runs().end(),
                         [](const SolverRun& run) { return run.what.find("from pixels") != std::string::npos; });
  };
  const auto once = fitsOf("primal");  // takes no pixels: they are fitted for the background of its contours alone
  EXPECT_GT(once, 10);
  EXPECT_EQ(fitsOf("reflectance"), once);
}

INSTANTIATE_TEST_SUITE_P(, AdviserData,
                         testing::Values("../shared/data/cycles/torus", "sessions/vase", "../shared/data/ladder/panel",
                                         "../shared/data/ladder/plastic"));

}  // namespace glint::adviser_data_tests

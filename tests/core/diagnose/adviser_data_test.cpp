// SPDX-License-Identifier: BSD-3-Clause
// Real and path-traced sequences: the verdict names what the table of held-out errors shows best, quickly, and no remedy is worse
// than what is there.
#include <gtest/gtest.h>

#include <ctime>
#include <filesystem>
#include <map>

#include "core/diagnose/diagnosis.h"
#include "core/inspect/summary.h"
#include "core/model/model.h"

namespace glint::adviser_data_tests {

constexpr double kFirstRemedySeconds = 10;  // of processor time
double processorSeconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

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
  double first = -1;
  const double start = processorSeconds();
  options.soFar = [&](const Diagnosis& d) {
    if (first < 0 && !d.remedies.empty()) first = processorSeconds() - start;
  };
  Diagnosis d = diagnose(inspection, options);
  EXPECT_LT(first, kFirstRemedySeconds);
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

INSTANTIATE_TEST_SUITE_P(, AdviserData,
                         testing::Values("../shared/data/cycles/torus", "sessions/vase", "../shared/data/ladder/panel",
                                         "../shared/data/ladder/plastic"));

}  // namespace glint::adviser_data_tests

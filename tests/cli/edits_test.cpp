// SPDX-License-Identifier: BSD-3-Clause
// Highlights that a session ignores, merges or splits by hand count so in every command that takes it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"

namespace glint {
namespace edits_tests {
using namespace testing_support;
using Json = nlohmann::json;
namespace fs = std::filesystem;

/// The shipped session of two lamps; frame 1 is held out and shows both.
class Edits : public testing::Test {
 protected:
  void SetUp() override {
    fs::copy(GLINT_SOURCE_DIR "/sessions/two-lamps", folder_.path(), fs::copy_options::recursive);
    session_ = Json::parse(contentOf(folder_ / "two-lamps.glint"));
    session_.erase("results");
    const ProgramRun run = runGlint("detect '" + (folder_ / "two-lamps.glint").string() + "' --json -");
    ASSERT_EQ(run.code, 0) << run.err;
    const Json detected = Json::parse(run.out);
    for (const Json& h : detected["frames"][1]["highlights"]) peaks_.push_back(h["peak"]);
    ASSERT_EQ(peaks_.size(), 2U);
  }
  struct Count {
    int ok = 0, missed = 0, spurious = 0;
  };
  Count countWith(const Json& edits) {
    if (!edits.empty()) session_["request"]["what_if"]["edits"] = edits;
    folder_.write("edited.glint", session_.dump());
    const ProgramRun run = runGlint("evaluate '" + (folder_ / "edited.glint").string() + "' --models limit-angle --json -");
    EXPECT_EQ(run.code, 0) << run.err;
    Count count;
    if (run.code != 0) return count;
    const Json evaluation = Json::parse(run.out);
    for (const Json& row : evaluation["models"]["limit-angle"]["frames"]) {
      if (row["index"] != 1) continue;
      count.ok += row["status"] == "ok";
      count.missed += row["status"] == "missed";
      count.spurious += row["status"] == "spurious";
    }
    return count;
  }
  TemporaryFolder folder_;
  Json session_;
  std::vector<Json> peaks_;
};

TEST_F(Edits, WithoutThemBothHighlightsCount) {
  const Count count = countWith(Json::array());
  EXPECT_EQ(count.ok, 2);
  EXPECT_EQ(count.missed + count.spurious, 0);
}

TEST_F(Edits, AnIgnoredOneIsNeitherScoredNorMissedNorSpurious) {
  const Count count = countWith({{{"frame", 1}, {"kind", "ignore"}, {"places", {peaks_[0]}}}});
  EXPECT_EQ(count.ok, 1);
  EXPECT_EQ(count.missed + count.spurious, 0);
}

TEST_F(Edits, APlaceWithoutAHighlightChangesNothing) {
  const Count count = countWith({{{"frame", 1}, {"kind", "ignore"}, {"places", {{2.0, 2.0}}}}});
  EXPECT_EQ(count.ok, 2);
}

TEST_F(Edits, AnUnknownKindIsRefusedWithItsPlace) {
  session_["request"]["what_if"]["edits"] = {{{"frame", 1}, {"kind", "paint"}, {"places", {peaks_[0]}}}};
  folder_.write("edited.glint", session_.dump());
  const ProgramRun run = runGlint("evaluate '" + (folder_ / "edited.glint").string() + "' --models limit-angle");
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(run.errorLines(), 1) << run.err;
  EXPECT_THAT(run.err, testing::HasSubstr("request.what_if.edits[0].kind"));
}

}  // namespace edits_tests
}  // namespace glint

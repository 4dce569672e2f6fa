// SPDX-License-Identifier: BSD-3-Clause
// `glint diagnose`: its exit codes, its JSON, and that a remedy's flags do what they promise.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/cli/small_scene.h"

namespace glint {
namespace diagnose_tests {
using namespace testing_support;
using testing::HasSubstr;

class Diagnose : public SmallScene {
 protected:
  /// The given contour of one frame lies 8 px beside its place.
  void moveContour(int frame) {
    withHighlights();
    Json& h = scene_["frames"][std::size_t(frame)]["highlights"][0];
    for (Json& p : h["contour"]) p[0] = p[0].get<double>() + 8;
    h["peak"][0] = h["peak"][0].get<double>() + 8;
    writeScene();
  }
};

TEST_F(Diagnose, NamesTheFaultAndItsRemedyHoldsInEvaluate) {
  moveContour(2);
  const ProgramRun run = on("diagnose", "--models limit-angle --train 0-5 --json -");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json all = Json::parse(run.out);
  EXPECT_EQ(all["glint_diagnosis"], 1);
  const Json& d = all["models"]["limit-angle"];
  EXPECT_NE(d["status"], "ok");
  EXPECT_FALSE(d["cause"].get<std::string>().empty());
  ASSERT_EQ(d["evidence"].size(), 6U);
  for (const Json& e : d["evidence"]) {
    EXPECT_TRUE(e["residual_px"].is_number());
    EXPECT_TRUE(e["limit_angle_deg"].is_number());
    EXPECT_EQ(e["against"].empty(), e["index"] != 2) << e.dump();
  }
  ASSERT_FALSE(d["remedies"].empty());
  const Json& best = d["remedies"][0];
  EXPECT_EQ(best["exclude"], "0002");
  EXPECT_TRUE(best["model"].is_null() && best["train"].is_null() && best["set"].is_null());
  EXPECT_LT(best["effect"]["after_pct"].get<double>(), 0.5 * best["effect"]["before_pct"].get<double>());
  double previous = 0;
  for (const Json& r : d["remedies"]) {
    EXPECT_GE(r["effect"]["after_pct"].get<double>(), previous) << "best first";
    previous = r["effect"]["after_pct"];
  }
  // The flags, given to evaluate.
  const auto heldOut = [&](const std::string& flags) {
    const ProgramRun r = on("evaluate", "--models limit-angle --train 0-5 --json - " + flags);
    EXPECT_EQ(r.code, 0) << r.err;
    return Json::parse(r.out)["models"]["limit-angle"]["summary"]["contour_error_pct"]["mean"].get<double>();
  };
  EXPECT_LT(heldOut(best["flags"]), heldOut(""));
}

TEST_F(Diagnose, TextSaysBecauseAndTry) {
  moveContour(2);
  const ProgramRun run = on("diagnose", "--models limit-angle --train 0-5 --most 3");
  ASSERT_EQ(run.code, 0) << run.err;
  for (const char* words : {"limit-angle", "because ", "frame 0002", "--exclude 0002", " -> ", "as a command: glint evaluate "})
    EXPECT_THAT(run.out, HasSubstr(words));
}

TEST_F(Diagnose, AModelThatIsOkHasNoCauseAndNoRemedy) {
  withHighlights();
  writeScene();
  const ProgramRun run = on("diagnose", "--models limit-angle,reflectance --train 0-5 --json -");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json d = Json::parse(run.out)["models"]["limit-angle"];
  EXPECT_EQ(d["status"], "ok") << d.dump();
  EXPECT_EQ(d["cause"], "");
  EXPECT_TRUE(d["remedies"].empty());
}

TEST_F(Diagnose, WithoutAModelItWritesAllTheSameAndEndsWith3) {
  withHighlights();
  for (Json& f : scene_["frames"]) f["highlights"][0]["peak"] = {2.0, 2.0};  // off the body
  writeScene();
  const ProgramRun run = on("diagnose", "--models dual,limit-angle --json " + out("why.json"));
  EXPECT_EQ(run.code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("no model could be fitted"));
  const Json all = Json::parse(contentOf(folder_ / "why.json"));
  for (const char* model : {"dual", "limit-angle"}) {
    EXPECT_EQ(all["models"][model]["status"], "failed");
    EXPECT_FALSE(all["models"][model]["cause"].get<std::string>().empty());
    EXPECT_FALSE(all["models"][model]["evidence"][0]["against"].empty());
  }
}

TEST_F(Diagnose, EveryCommandThatTrainsExcludes) {
  for (const char* command :
       {"reconstruct", "evaluate", "diagnose", "tradeoff", "predict", "retexture", "render", "movie", "lights"}) {
    const ProgramRun help = runGlint(std::string(command) + " --help");
    EXPECT_THAT(help.out, HasSubstr("--exclude")) << command;
  }
  moveContour(2);
  const auto predicted = [&](const std::string& saved, const std::string& asked) {
    saveSession("--models limit-angle --train 0-5 " + saved);
    const ProgramRun run = onSession("predict", "--frames 7 --json - " + asked);
    EXPECT_EQ(run.code, 0) << run.err;
    std::filesystem::remove(folder_ / "run.glint");
    Json frames = Json::parse(run.out)["models"]["limit-angle"];
    for (Json& f : frames) f.erase("time_us");
    return frames.dump();
  };
  const std::string with = predicted("", ""), stored = predicted("--exclude 2", ""), asked = predicted("", "--exclude 2");
  EXPECT_EQ(asked, stored);
  EXPECT_NE(asked, with);
}

TEST_F(Diagnose, WrongRequestsAreOneLine) {
  for (const char* wrong :
       {"--models auto", "--models nothing", "--most -1", "--exclude 99", "--set fit.solver=best", "--level 2"}) {
    const ProgramRun run = on("diagnose", wrong);
    EXPECT_EQ(run.code, 2) << wrong;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
}

}  // namespace diagnose_tests
}  // namespace glint

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

/// Mean held-out contour error and missed and spurious highlights, as the table of errors has them.
struct Table {
  double pct = 0;
  int missed = 0, spurious = 0;
};
Table tableOf(const Json& evaluation, const std::string& model) {
  const Json& s = evaluation["models"][model]["summary"];
  return {s["contour_error_pct"]["mean"].is_number() ? s["contour_error_pct"]["mean"].get<double>() : 100.0, s["missed"],
          s["spurious"]};
}

TEST_F(Diagnose, NamesTheFaultAndEveryRemedyHoldsInEvaluate) {
  moveContour(2);
  const ProgramRun run = on("diagnose", "--models limit-angle --train 0-5 --most 2 --json -");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json all = Json::parse(run.out);
  EXPECT_EQ(all["glint_diagnosis"], 2);
  EXPECT_EQ(all["present"]["model"], "limit-angle");
  EXPECT_FALSE(all["verdict"].get<std::string>().empty());
  const Json& d = all["models"]["limit-angle"];
  ASSERT_EQ(d["evidence"].size(), 6U);
  for (const Json& e : d["evidence"]) {
    EXPECT_TRUE(e["residual_px"].is_number());
    EXPECT_TRUE(e["limit_angle_deg"].is_number());
    EXPECT_EQ(e["against"].empty(), e["index"] != 2) << e.dump();
  }
  ASSERT_FALSE(all["remedies"].empty());
  EXPECT_LE(all["remedies"].size(), 3U);
  const auto table = [&](const std::string& flags) {
    const bool model = flags.find("--model") != std::string::npos;
    const ProgramRun r =
        on("evaluate", std::string(model ? "" : "--models limit-angle ") +
                           (flags.find("--train") != std::string::npos ? "" : "--train 0-5 ") + "--json - " + flags);
    EXPECT_EQ(r.code, 0) << r.err;
    const Json evaluation = Json::parse(r.out);
    return tableOf(evaluation, evaluation["models"].begin().key());
  };
  const Table before = table("");
  EXPECT_NEAR(all["present"]["error"]["contour_error_pct"], before.pct, 1e-6);
  double previous = 0;
  for (const Json& r : all["remedies"]) {
    EXPECT_GE(r["effect"]["after_pct"].get<double>(), previous) << "best first";
    previous = r["effect"]["after_pct"];
    const Table after = table(r["flags"]);
    EXPECT_LE(after.pct, before.pct) << r["flags"];
    EXPECT_LE(after.missed, before.missed) << r["flags"];
  }
  EXPECT_LT(table(all["remedies"][0]["flags"]).pct, before.pct);
}

/// One verdict, wherever it is read, then the remedies, then what both stand on.
TEST_F(Diagnose, TextJsonAndPageSayTheSame) {
  moveContour(2);
  const ProgramRun run =
      on("diagnose", "--models limit-angle --train 0-5 --most 1 --json " + out("why.json") + " --html " + out("why.html"));
  ASSERT_EQ(run.code, 0) << run.err;
  // What is wrong with the input comes first: the moved contour does not show the lamp of the others.
  std::string said = run.out;
  ASSERT_TRUE(said.starts_with("finding: the highlights of 7 frames share one lamp")) << said;
  said.erase(0, said.find('\n') + 1);
  EXPECT_LT(said.find("the error is "), said.find('\n'));
  std::size_t at = 0;
  for (const char* words : {"the error is ", "\n  --", " -> ", "as a command: glint evaluate ", "Evidence, measured in",
                            "  limit-angle ", "against limit-angle: frame 0002"}) {
    at = said.find(words, at);
    ASSERT_NE(at, std::string::npos) << words << "\n" << said;
  }
  const std::string verdict = Json::parse(contentOf(folder_ / "why.json"))["verdict"];
  EXPECT_EQ(said.substr(0, said.find('\n')), verdict);
  EXPECT_THAT(contentOf(folder_ / "why.html"), HasSubstr("<p>" + verdict + "</p>"));
}

/// All models are asked for: the best of them is the state to beat, and it is the one that evaluate's table shows best.
TEST_F(Diagnose, TheBestModelIsThatOfEvaluate) {
  withHighlights();
  writeScene();
  const ProgramRun run = on("diagnose", "--train 0-5 --most 0 --json -");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json d = Json::parse(run.out), e = Json::parse(on("evaluate", "--train 0-5 --json -").out);
  std::string best;
  for (const auto& [model, value] : e["models"].items()) {
    const Table t = tableOf(e, model);
    if (t.missed == 0 && (best.empty() || t.pct < tableOf(e, best).pct)) best = model;
  }
  EXPECT_EQ(d["best_model"], best);
  EXPECT_EQ(d["present"]["model"], best);
  for (const Json& r : d["remedies"]) EXPECT_NE(r["model"], best);
}

TEST_F(Diagnose, WithoutAModelItWritesAllTheSameAndEndsWith3) {
  withHighlights();
  for (Json& f : scene_["frames"]) f["highlights"][0]["peak"] = {2.0, 2.0};  // off the body
  writeScene();
  const ProgramRun run = on("diagnose", "--models dual,limit-angle --most 1 --json " + out("why.json"));
  EXPECT_EQ(run.code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("no model could be fitted"));
  const Json all = Json::parse(contentOf(folder_ / "why.json"));
  EXPECT_EQ(all["present"]["error"]["missed"], all["present"]["error"]["observed"]);
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

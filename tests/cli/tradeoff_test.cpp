// SPDX-License-Identifier: BSD-3-Clause
// `glint tradeoff` as a user runs it: the keys of docs/formats.md, "tradeoff --json", exit codes, sessions, presets,
// interruption.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/types.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "tests/cli/small_scene.h"
#include "tests/sanitizers/cases.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
namespace fs = std::filesystem;

class TradeoffCommand : public SmallScene {
 protected:
  /// Few trials suffice: the measurements are tested elsewhere.
  static constexpr const char* kFew = "--models dual,limit-angle --set fit.most_residual=10 --max-trials 6 --repeats 1 ";
  ProgramRun tradeoff(const std::string& more) const { return on("tradeoff", kFew + more); }
};

TEST_F(TradeoffCommand, WritesTheContract) {
  const ProgramRun run = tradeoff("--json - --html " + out("t.html"));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  ASSERT_TRUE(Json::accept(run.out));
  const Json j = Json::parse(run.out);
  EXPECT_EQ(j["glint_tradeoff"], 1);
  EXPECT_TRUE(j["input"].is_string());
  EXPECT_EQ(j["train"], (std::vector<int>{0, 1, 2, 3, 4, 5}));
  ASSERT_GE(j["points"].size(), 2u);
  std::vector<std::pair<double, double>> costs;
  for (const Json& p : j["points"]) {
    for (const char* key : {"model", "directions", "normals", "solver"}) EXPECT_TRUE(p["settings"].contains(key)) << key;
    for (const char* key : {"contour_error_pct", "iou", "coverage", "predict_us", "fit_us", "peak_mb"})
      EXPECT_TRUE(p[key].is_number()) << key;
    EXPECT_TRUE(p["pareto"].is_boolean());
    costs.emplace_back(p["ranked_error_pct"].get<double>(), p["predict_us"].get<double>());
  }
  // The front once more, from the numbers alone.
  for (std::size_t i = 0; i < costs.size(); ++i) {
    bool beaten = false;
    for (const auto& [error, us] : costs)
      beaten = beaten || (error <= costs[i].first && us <= costs[i].second && (error < costs[i].first || us < costs[i].second));
    EXPECT_EQ(j["points"][i]["pareto"].get<bool>(), !beaten) << i;
  }
  for (const char* preset : {"fast", "balanced", "exact"}) {
    ASSERT_TRUE(j["presets"][preset].is_number_integer()) << preset;
    EXPECT_TRUE(j["points"][j["presets"][preset].get<std::size_t>()]["pareto"].get<bool>()) << preset;
  }
  EXPECT_EQ(j["chosen"], j["presets"]["balanced"]);
  EXPECT_FALSE(j["reason"].get<std::string>().empty());
  EXPECT_THAT(contentOf(folder_ / "t.html"), HasSubstr("<svg"));
  EXPECT_FALSE(fs::exists(folder_ / "t.html.work"));
}

TEST_F(TradeoffCommand, BoundsChooseOrEndWithCodeThree) {
  const ProgramRun rich = tradeoff("--budget-us 1e9 --json " + out("rich.json"));
  ASSERT_EQ(rich.code, 0) << rich.err;
  const Json j = Json::parse(contentOf(folder_ / "rich.json"));
  EXPECT_EQ(j["chosen"], j["presets"]["exact"]);
  EXPECT_THAT(rich.out, HasSubstr("The most accurate setting within 1e+09 us per frame is "));
  const ProgramRun poor = tradeoff("--budget-us 1e-3 --json " + out("poor.json") + " -o " + out("poor.glint"));
  EXPECT_EQ(poor.code, 3);
  EXPECT_EQ(poor.errorLines(), 1) << poor.err;
  EXPECT_THAT(poor.err, HasSubstr("not reached: No measured setting predicts a frame within 0.001 us; the fastest is "));
  EXPECT_TRUE(Json::parse(contentOf(folder_ / "poor.json"))["chosen"].is_null());
  EXPECT_FALSE(fs::exists(folder_ / "poor.glint"));
  const ProgramRun strict = tradeoff("--max-error-pct 1e-9");
  EXPECT_EQ(strict.code, 3);
  EXPECT_THAT(strict.err, HasSubstr("No measured setting has an error of at most 1e-09 %; the most accurate is "));
}

TEST_F(TradeoffCommand, WrongRequestsAreCodeTwo) {
  for (const char* wrong :
       {"--budget-us 1 --max-error-pct 1", "--budget-us fast", "--budget-us -3", "--max-error-pct 0", "--max-error-pct nan",
        "--models auto", "--models none", "--repeats 0", "--max-trials 0", "--preset fast"}) {
    const ProgramRun run = on("tradeoff", wrong);
    EXPECT_EQ(run.code, 2) << wrong;
    EXPECT_EQ(run.errorLines(), 1) << run.err;
  }
}

TEST_F(TradeoffCommand, NothingThatAnswersIsCodeThreeWithTheReason) {
  const ProgramRun run = on("tradeoff", "--models dual --train 0 --json " + out("t.json"));
  EXPECT_EQ(run.code, 3);
  EXPECT_EQ(run.errorLines(), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("too few views"));
  EXPECT_EQ(Json::parse(contentOf(folder_ / "t.json"))["points"].size(), 0u);
}

TEST_F(TradeoffCommand, WithoutAHeldOutFrameItIsRefusedBeforeTheFirstTrial) {
  const std::string file = out("t.json");
  for (const char* train : {"first:8", "0-7"}) {
    const ProgramRun run = tradeoff("--train " + std::string(train) + " --json " + file);
    EXPECT_EQ(run.code, 2) << run.err;
    EXPECT_EQ(run.errorLines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr("each of the 8 is a training frame or excluded"));
    EXPECT_THAT(run.err, HasSubstr("for example --train first:4"));
    EXPECT_THAT(run.err, testing::Not(HasSubstr("try settings"))) << "nothing was tried";
    EXPECT_FALSE(fs::exists(folder_ / "t.json"));
    EXPECT_FALSE(fs::exists(folder_ / "t.json.work"));
  }
  // The default takes six: a scene of six gets the same message, and its suggestion works.
  scene_["frames"].erase(scene_["frames"].begin() + 6, scene_["frames"].end());
  writeScene();
  const ProgramRun six = tradeoff("--json " + file);
  EXPECT_EQ(six.code, 2);
  EXPECT_THAT(six.err, HasSubstr("--train first:6: no frame is left to measure the error on"));
  const ProgramRun four = tradeoff("--train first:4 --json " + file);
  EXPECT_EQ(four.code, 0) << four.err;
}

TEST_F(TradeoffCommand, TheSessionThatItReadsStaysAsItIs) {
  saveSession("--model limit-angle");
  const std::string before = contentOf(folder_ / "run.glint");
  const ProgramRun run = onSession("tradeoff", std::string(kFew) + "--budget-us 1e9");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(onSession("tradeoff", std::string(kFew) + "--budget-us 1e9 --json " + out("t.json")).code, 0);
  EXPECT_EQ(contentOf(folder_ / "run.glint"), before);
  EXPECT_EQ(onSession("tradeoff", std::string(kFew) + "-o " + out("run.glint")).code, 2) << "it is an input";
  EXPECT_EQ(contentOf(folder_ / "run.glint"), before);
}

TEST_F(TradeoffCommand, PresetsFindItInTheSessionThatItWrites) {
  saveSession("--model limit-angle");
  ProgramRun none = onSession("evaluate", "--preset fast");
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("the session has no trade-off"));
  EXPECT_EQ(on("evaluate", "--preset fast").code, 2) << "a scene has none either";

  const ProgramRun run = onSession("tradeoff", std::string(kFew) + "--budget-us 1e9 -o " + out("best.glint"));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json now = Json::parse(contentOf(folder_ / "best.glint"));
  EXPECT_EQ(now["glint_session"], 3);
  const Json& t = now["tradeoff"];
  EXPECT_EQ(t["glint_tradeoff"], 1);
  const auto onBest = [&](const std::string& command, const std::string& more) {
    return runGlint(command + " " + out("best.glint") + " " + more);
  };
  const ProgramRun replayed = onBest("replay", "--exact");
  EXPECT_EQ(replayed.code, 0) << replayed.err << replayed.out;

  const Json fast = t["points"][t["presets"]["fast"].get<std::size_t>()];
  const ProgramRun evaluated = onBest("evaluate", "--preset fast --json -");
  ASSERT_EQ(evaluated.code, 0) << evaluated.err;
  const Json models = Json::parse(evaluated.out)["models"];
  ASSERT_EQ(models.size(), 1u);
  ASSERT_TRUE(models.contains(fast["settings"]["model"].get<std::string>()));
  EXPECT_EQ(models.begin().value()["summary"]["contour_error_pct"]["mean"], fast["contour_error_pct"])
      << "the point's error is that of evaluate";
  EXPECT_EQ(onBest("predict", "--preset chosen --json -").code, 0);
  EXPECT_EQ(onBest("predict", "--preset quick").code, 2);
  EXPECT_EQ(onBest("reconstruct", "--preset exact -o " + out("exact.glint")).code, 0);

  // A session of version 1 is one without.
  Json first = Json::parse(contentOf(folder_ / "run.glint"));
  first["glint_session"] = 1;
  folder_.write("run.glint", first.dump());
  EXPECT_EQ(onSession("replay", "--exact").code, 0);
}

TEST_F(TradeoffCommand, WritesASessionOfTheChoice) {
  const ProgramRun run = tradeoff("--budget-us 1e9 -o " + out("best.glint"));
  ASSERT_EQ(run.code, 0) << run.err;
  const Json s = Json::parse(contentOf(folder_ / "best.glint"));
  const Json chosen = s["tradeoff"]["points"][s["tradeoff"]["chosen"].get<std::size_t>()];
  EXPECT_EQ(s["request"]["models"], Json::array({chosen["settings"]["model"]}));
  EXPECT_EQ(s["request"]["settings"]["predict.directions"], chosen["settings"]["directions"]);
  EXPECT_EQ(runGlint("replay " + out("best.glint") + " --exact").code, 0);
}

TEST_F(TradeoffCommand, StopsQuicklyAndResumes) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const std::string json = (folder_ / "t.json").string(), input = folder_.path().string();
    if (!std::freopen("/dev/null", "w", stderr)) _exit(99);
    execl(GLINT_PROGRAM, "glint", "tradeoff", input.c_str(), "--json", json.c_str(), static_cast<char*>(nullptr));
    _exit(99);
  }
  const fs::path work = folder_ / "t.json.work";
  for (int i = 0; i < testing_support::kWaitMs / 50 && !fs::exists(work); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_TRUE(fs::exists(work)) << "no work was kept in time";
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_FALSE(fs::exists(folder_ / "t.json"));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path()))
    EXPECT_NE(entry.path().filename().string()[0], '.') << "an unfinished file: " << entry.path();
  ASSERT_TRUE(Json::accept(contentOf(work)));
  const std::size_t kept = Json::parse(contentOf(work))["coarse"].size();
  EXPECT_GT(kept, 0u);
  // Few trials suffice to see that the file is taken over and removed at the end.
  const ProgramRun resumed = on("tradeoff", "--max-trials 2 --models limit-angle --json " + out("t.json"));
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_FALSE(fs::exists(work));
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// A person is told of a frame by its id, never by its place: in a scene of every second photograph, "0007" is frame 3.
#include <gmock/gmock.h>

#include <regex>

#include "tests/cli/small_scene.h"

namespace glint::frame_names_tests {

using namespace testing_support;
using testing::HasSubstr;
namespace fs = std::filesystem;

class FrameNames : public SmallScene {
 protected:
  void SetUp() override {
    SmallScene::SetUp();
    for (int i = 0; i < kFrames; ++i) scene_["frames"][i]["id"] = idOf(i);
    writeScene();
  }
  /// Ids 0001, 0003, ..., 0015: some equal the number of another frame.
  static std::string idOf(int frame) { return std::string(frame < 5 ? "000" : "00") + std::to_string(2 * frame + 1); }
  static Json idsOf(const std::vector<int>& frames) {
    Json ids = Json::array();
    for (const int frame : frames) ids.push_back(idOf(frame));
    return ids;
  }
  /// Every place where a text names a frame, or several: each must be an id.
  static void expectIds(const std::string& what, std::string text, int least = 1) {
    text = std::regex_replace(text, std::regex("<(style|script)>[^<]*</(style|script)>|base64,[A-Za-z0-9+/=]*"), "");
    const std::regex named(
        "[Ff]rames?( id)?(</b>|</title>|:)? ((?:(?:, | and )?[0-9]+(?![0-9.]*( of | px|%| %| more| frame| held| train| "
        "high)))+)");
    int found = 0;
    for (std::sregex_iterator it(text.begin(), text.end(), named), end; it != end; ++it) {
      const std::string list = (*it)[3];
      const std::regex number("[0-9]+");
      for (std::sregex_iterator n(list.begin(), list.end(), number); n != end; ++n, ++found)
        EXPECT_TRUE(n->str().size() == 4 && std::stoi(n->str()) % 2 == 1) << what << ": " << it->str();
    }
    EXPECT_GE(found, least) << what << " names no frame: " << text.substr(0, 2000);
  }
  /// Its highlight is cut off at a value; all others lie far below.
  void overexpose(int frame) const {
    cv::Mat m = cv::imread(radiance(frame).string(), cv::IMREAD_UNCHANGED);
    double top = 0;
    cv::minMaxLoc(m.reshape(1), nullptr, &top);
    writeRadiance(frame, m * (1e4 / top));
  }
};

TEST_F(FrameNames, EvaluationNamesIds) {
  overexpose(2);
  overexpose(6);
  writeRadiance(1, cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(0.1)));
  const ProgramRun run =
      on("evaluate",
         "--models primal,dual,limit-angle --train 0-3 --exclude 7 --set detect.clip=6000 --all-warnings --json - --csv " +
             out("e.csv") + " --html " + out("e.html"));
  EXPECT_THAT(run.err, HasSubstr("clipped (saturated) highlights in training frame 0005 and other frame 0013"));
  expectIds("warnings", run.err, 2);
  expectIds("page", contentOf(folder_ / "e.html"), 6);
  const Json j = Json::parse(run.out);
  EXPECT_EQ(j["train"], Json({0, 1, 2, 3})) << "positions stay";
  EXPECT_EQ(j["train_ids"], idsOf({0, 1, 2, 3}));
  EXPECT_EQ(j["excluded"], Json({7}));
  EXPECT_EQ(j["excluded_ids"], idsOf({7}));
  for (const auto& [name, model] : j["models"].items())
    for (const Json& fit : model["fits"]) EXPECT_EQ(fit["training_ids"], idsOf(fit["training_frames"])) << name;
  expectIds("warnings of the file", j["warnings"].dump(), 2);
  EXPECT_THAT(contentOf(folder_ / "e.html"), HasSubstr("training <code>0001-0007</code> (4 of 8 frames)"));
  EXPECT_THAT(on("evaluate", "--models limit-angle --train 0,2,3").out, HasSubstr("trained on 3 of 8 frames (0001,0005-0007)"));
  EXPECT_THAT(on("evaluate", "--models limit-angle --train first:3").out, HasSubstr("(first:3, 0001-0005)"));
}

TEST_F(FrameNames, FailuresNameIds) {
  writeRadiance(7, cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(0.1)));
  const ProgramRun run = on("evaluate", "--models dual,limit-angle --train 7 --json -");
  EXPECT_EQ(run.code, 3);
  expectIds("error", run.err);
  EXPECT_THAT(run.err, HasSubstr("frame 0015: no highlight"));
  const ProgramRun unknown = on("evaluate", "--train 0007,99");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("frame 99 does not exist"));
}

TEST_F(FrameNames, SessionsPredictAndDiagnoseByIds) {
  saveSession("--train 0-3 --models dual,limit-angle");
  const ProgramRun table = onSession("predict");
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_THAT(table.out, testing::ContainsRegex("limit-angle +0015 +"));
  EXPECT_THAT(table.out, testing::Not(testing::ContainsRegex("limit-angle +[0-7] "))) << "no column of places";
  ASSERT_EQ(onSession("predict", "--frames 0003,4 --out " + out("pictures")).code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "pictures/0003.png"));
  EXPECT_TRUE(fs::exists(folder_ / "pictures/0009.png")) << "of the frame at position 4";
  EXPECT_FALSE(fs::exists(folder_ / "pictures/0004.png"));
  ASSERT_EQ(on("detect", "--out " + out("detected")).code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "detected/0015.png"));
  EXPECT_FALSE(fs::exists(folder_ / "detected/0000.png"));
  ASSERT_EQ(onSession("predict", "--masks " + out("masks")).code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "masks/masks/dual/lamp/0015.png") || fs::exists(folder_ / "masks/masks/dual/light/0015.png"));
  const ProgramRun diagnosis = on("diagnose", "--models dual --train 0-3 --json " + out("why.json"));
  expectIds("diagnosis", diagnosis.out);
  EXPECT_EQ(Json::parse(contentOf(folder_ / "why.json"))["train_ids"], idsOf({0, 1, 2, 3}));
}

TEST_F(FrameNames, ATradeOffNamesWhatTrained) {
  const ProgramRun run =
      on("tradeoff",
         "--models dual --set fit.most_residual=10 --max-trials 2 --repeats 1 --train 0-3 --json - --html " + out("t.html"));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(Json::parse(run.out)["train_ids"], idsOf({0, 1, 2, 3}));
  EXPECT_THAT(contentOf(folder_ / "t.html"), HasSubstr("0001, 0003, 0005, 0007"));
}

}  // namespace glint::frame_names_tests

// SPDX-License-Identifier: BSD-3-Clause
// Output of the command line besides reports: movies, comparisons of two sessions, masks.
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/cli/small_scene.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
namespace fs = std::filesystem;

class Leaving : public SmallScene {};

TEST_F(Leaving, ThroughACameraTheSceneIsDrawnWhereTheCameraSays) {
  // A small ball at the origin; the principal point far from the middle of the 160 x 120 px, pixels that are not square.
  scene_["surfaces"] = Json::parse(R"({"body": {"analytic": {"type": "ellipsoid", "semi_axes": [0.08, 0.08, 0.08]}}})");
  const double fx = 200, fy = 180, cx = 112, cy = 33;
  const Json camera = {{"width", 160}, {"height", 120}, {"fx", fx}, {"fy", fy}, {"cx", cx}, {"cy", cy}};
  scene_["camera"] = camera;
  for (Json& frame : scene_["frames"])
    if (frame.contains("camera")) frame["camera"] = camera;
  writeScene();
  const ProgramRun run =
      on("render", "--through --frame 3 --models limit-angle --layers=none,+surface --size 640x480 -o " + out("a.png"));
  ASSERT_EQ(run.code, 0) << run.err;
  const cv::Mat picture = cv::imread((folder_ / "a.png").string());
  ASSERT_EQ(picture.cols, 640);
  const Json& pose = scene_["frames"][3]["camera_from_world"];
  const auto at = [&](int row) { return pose[std::size_t(row)][3].get<double>(); };  // of the origin
  const double x = 4 * (fx * at(0) / at(2) + cx + 0.5) - 0.5, y = 4 * (fy * at(1) / at(2) + cy + 0.5) - 0.5;
  const cv::Vec3b background = picture.at<cv::Vec3b>(470, 630);
  const auto steps = [&](int dx, int dy) {  // from the expected centre to the ball's edge
    int n = 0;
    cv::Point p(int(std::lround(x)), int(std::lround(y)));
    while (cv::Rect(0, 0, 640, 480).contains(p) && cv::norm(picture.at<cv::Vec3b>(p), background) > 24)
      p += cv::Point(dx, dy), ++n;
    return n;
  };
  const double wide = 4 * fx * 0.08 / at(2), high = 4 * fy * 0.08 / at(2);
  EXPECT_NEAR(steps(-1, 0), wide, 2.5);
  EXPECT_NEAR(steps(1, 0), wide, 2.5);
  EXPECT_NEAR(steps(0, -1), high, 2.5);
  EXPECT_NEAR(steps(0, 1), high, 2.5);
}

TEST_F(Leaving, AMovieOfTheTimelineAsPictures) {
  saveSession("--model limit-angle");
  const ProgramRun run = onSession("movie", "--frames 2-4 --size 320x240 -o " + out("m.png"));
  ASSERT_EQ(run.code, 0) << run.err;
  cv::Mat before;
  for (const char* name : {"m_0000.png", "m_0001.png", "m_0002.png"}) {
    const cv::Mat picture = cv::imread((folder_ / name).string());
    ASSERT_EQ(picture.cols, 320) << name;
    ASSERT_EQ(picture.rows, 240) << name;
    if (!before.empty()) {
      EXPECT_GT(cv::norm(picture, before, cv::NORM_L1) / double(picture.total()), 0.1) << name;
    }
    before = picture;
  }
  EXPECT_FALSE(fs::exists(folder_ / "m_0003.png"));
}

TEST_F(Leaving, WrongMoviesNameWhatIsWrong) {
  for (const auto& [flags, expected] :
       std::initializer_list<std::pair<const char*, const char*>>{{"-o m.gif", "the name of a movie must end in .mp4"},
                                                                  {"--size 321x240 -o m.mp4", "must be even"},
                                                                  {"--fps 1000 -o m.mp4", "--fps: "},
                                                                  {"--of turntable --seconds 0 -o m.mp4", "--seconds: "},
                                                                  {"--frames 99 -o m.mp4", "--frames 99: "},
                                                                  {"--of dance -o m.mp4", "--of: "}}) {
    const ProgramRun run = on("movie", flags);
    EXPECT_EQ(run.code, 2) << flags;
    EXPECT_THAT(run.err, HasSubstr(expected)) << flags;
  }
}

TEST_F(Leaving, ComparesTwoSessions) {
  saveSession("--model limit-angle,canonical");
  fs::copy_file(folder_ / "run.glint", folder_ / "before.glint");
  saveSession("--model limit-angle,canonical --train first:4 --set detect.level=0.4");
  const ProgramRun text = runGlint("compare " + out("before.glint") + " " + out("run.glint"));
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("detect.level"));
  EXPECT_THAT(text.out, testing::Not(HasSubstr("predict.directions")));
  const ProgramRun json = runGlint("compare --json - " + out("before.glint") + " " + out("run.glint"));
  const Json j = Json::parse(json.out);
  EXPECT_EQ(j["frames"]["common"], 8);
  EXPECT_EQ(j["models"]["limit-angle"]["common"], 2);  // held out in both: the last two of eight
  const ProgramRun same = runGlint("compare " + out("run.glint") + " " + out("run.glint"));
  EXPECT_THAT(same.out, HasSubstr("0 differences"));
  EXPECT_EQ(runGlint("compare " + out("run.glint") + " " + out("none.glint")).code, 2);
}

/// JSON holds UTF-8 only: under another name nothing would be found when the session is opened.
TEST_F(Leaving, ASessionThatCouldNotNameItsSceneIsNotWritten) {
  const std::filesystem::path odd = folder_ / "u\xff";
  std::filesystem::copy(spec().parent_path() / "scene", odd, std::filesystem::copy_options::recursive);
  const ProgramRun run =
      runGlint("reconstruct " + inQuotes(odd / "scene.json") + " --model limit-angle -o " + inQuotes(folder_ / "u.glint"));
  EXPECT_EQ(run.code, 2) << run.err;
  EXPECT_THAT(run.err, HasSubstr("whose path is not UTF-8"));
  EXPECT_EQ(run.errorLines(), 1) << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "u.glint"));
}

TEST_F(Leaving, PredictionsHaveBandsUnlessSaidOtherwise) {
  saveSession("--model limit-angle");
  const auto highlights = [&](const std::string& more) {
    const ProgramRun run = onSession("predict", "--json - " + more);
    EXPECT_EQ(run.code, 0) << run.err;
    std::vector<Json> all;
    const Json document = Json::parse(run.out);
    for (const Json& frame : document["models"]["limit-angle"])
      for (const Json& highlight : frame["highlights"]) all.push_back(highlight);
    return all;
  };
  std::vector<Json> with = highlights("");
  const std::vector<Json> without = highlights("--set predict.band=false");
  ASSERT_EQ(with.size(), without.size());
  ASSERT_GE(with.size(), 1u);
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_EQ(with[i].erase("sigma_px"), 1u);
    EXPECT_EQ(with[i], without[i]) << "the contour is the same";
  }
}

TEST_F(Leaving, MasksInANewFolder) {
  saveSession("--model limit-angle");
  ASSERT_EQ(onSession("predict", "--masks " + out("labels")).code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "labels/masks.json"));
  EXPECT_TRUE(fs::exists(folder_ / "labels/labels_limit-angle.json"));
  const ProgramRun again = onSession("predict", "--masks " + out("labels"));
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.err, HasSubstr("not empty"));
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "tests/cli/run_program.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
namespace fs = std::filesystem;

/// For the shell.
std::string quoted(const fs::path& p) {
  std::string text = p.string();
  text.insert(text.begin(), '\'');
  text.push_back('\'');
  return text;
}

// A plugin is code: only an option --plugin of this line loads one, never another option's value or a word behind "--".
TEST(CommandLine, OnlyTheOptionItselfNamesAPlugin) {
  const auto tried = [](const std::string& arguments) {
    return runGlint(arguments).err.rfind("glint: /nowhere.so: no such file", 0) == 0;
  };
  EXPECT_TRUE(tried("info x --plugin /nowhere.so"));
  EXPECT_TRUE(tried("info x --plugin=/nowhere.so"));
  EXPECT_FALSE(tried("info -- --plugin=/nowhere.so"));
  EXPECT_FALSE(tried("info x --json --plugin=/nowhere.so"));
  EXPECT_FALSE(tried("info x --no-such-option --plugin=/nowhere.so"));
}

TEST(CommandLine, VersionAndHelpAreDone) {
  EXPECT_EQ(runGlint("--version").out, "glint 0.1.0\n");
  for (const char* arguments : {"", "--help", "info --help", "convert --help", "settings --help", "help", "help convert"}) {
    const ProgramRun run = runGlint(arguments);
    EXPECT_EQ(run.code, 0) << arguments;
    EXPECT_EQ(run.err, "") << arguments;
    EXPECT_THAT(run.out, HasSubstr("Usage: ")) << arguments;
    EXPECT_THAT(run.out, HasSubstr("Exit codes: ")) << arguments;
  }
  EXPECT_EQ(runGlint("help convert").out, runGlint("convert --help").out);
  EXPECT_EQ(runGlint("help convrt").code, 2);
}

TEST(CommandLine, WrongRequestsAreCodeTwoAndOneLine) {
  for (const char* arguments :
       {"bogus", "info", "info --nonsense x", "info /nonexistent", "convert /nonexistent -o x.json", "convert x"}) {
    const ProgramRun run = runGlint(arguments);
    EXPECT_EQ(run.code, 2) << arguments;
    EXPECT_EQ(run.errorLines(), 1) << arguments << ": " << run.err;
    EXPECT_THAT(run.err, StartsWith("glint: ")) << arguments;
    EXPECT_EQ(run.out, "") << arguments;
  }
}

TEST(CommandLine, AMistypedNameIsAnsweredWithTheNearestOne) {
  for (const auto& [arguments, meant] : std::initializer_list<std::pair<const char*, const char*>>{
           {"evalaute x", "'evalaute' is not a command; did you mean 'evaluate'? (see glint --help)"},
           {"help evalaute", "'evalaute' is not a command; did you mean 'evaluate'?"},
           {"--versoin", "'--versoin' is not an option; did you mean '--version'? (see glint --help)"},
           {"evaluate x --modles=dual", "did you mean '--models'?"},
           {"evaluate x --models canonicl", "unknown model; did you mean 'canonical'? Known: primal, dual, canonical"},
           {"evaluate x --set predict.direction=9", "unknown setting; did you mean 'predict.directions'?"}}) {
    const ProgramRun run = runGlint(arguments);
    EXPECT_EQ(run.code, 2) << arguments;
    EXPECT_EQ(run.errorLines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(meant)) << arguments;
  }
  EXPECT_THAT(runGlint("bogus").err, Not(HasSubstr("did you mean")));
}

TEST(CommandLine, SettingsListsEveryKey) {
  const ProgramRun run = runGlint("settings");
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, HasSubstr("predict.directions = 36"));
}

TEST(CommandLine, FullStandardOutputIsAnError) {
  const ProgramRun run = runGlint("settings > /dev/full");
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(run.errorLines(), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("No space left"));
}

/// A sphere at the origin seen from 2 m, 64 x 48, with one float image per frame.
class SceneOnDisk : public testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string text_ = R"({"glint_scene": 1,
  "camera": {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 31.5, "cy": 23.5},
  "frames": [{"id": "a", "radiance": "a.tiff", "camera_from_world": [[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]]},
             {"id": "b", "radiance": "b.tiff", "camera_from_world": [[1,0,0,0.1],[0,1,0,0],[0,0,1,2],[0,0,0,1]]}],
  "surfaces": {"ball": {"analytic": {"type": "sphere", "radius": 0.4}}}})";
  void SetUp() override {
    writeImage("a.tiff", cv::Mat(48, 64, CV_32FC1, cv::Scalar(1)));
    writeImage("b.tiff", cv::Mat(48, 64, CV_32FC1, cv::Scalar(1)));
    folder_.write("scene.json", text_);
  }
  void writeImage(const std::string& name, const cv::Mat& m) const {
    ASSERT_TRUE(cv::imwrite((folder_ / name).string(), m, {cv::IMWRITE_TIFF_COMPRESSION, 1}));
  }
  void rewrite(const std::string& from, const std::string& to) const { folder_.write("scene.json", with(text_, from, to)); }
  ProgramRun info(const std::string& more = "") const { return runGlint("info " + quoted(folder_.path()) + " " + more); }
};

TEST_F(SceneOnDisk, InfoSaysWhatItIs) {
  const ProgramRun run = info();
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("analytic sphere"));
  EXPECT_THAT(run.out, HasSubstr("no highlight was found in any of 2 frames"));  // its images are of one value
  EXPECT_THAT(run.out, Not(HasSubstr("no problems found")));
}

TEST_F(SceneOnDisk, InfoJsonGoesToStandardOutputAloneAndHasNoNan) {
  const ProgramRun run = info("--json -");
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, StartsWith("{"));
  EXPECT_EQ(run.out.find("nan"), std::string::npos);
  EXPECT_EQ(run.err, "");
}

TEST_F(SceneOnDisk, BadImagesAreFindingsOfTheirFrame) {
  fs::remove(folder_ / "a.tiff");
  EXPECT_THAT(info().out, HasSubstr("1 of 2 frames have a file that cannot be used; first: " + (folder_ / "a.tiff").string() +
                                    ": cannot be read: No such file"));
  folder_.write("a.tiff", "");
  EXPECT_THAT(info().out, HasSubstr((folder_ / "a.tiff").string() + ": the file is empty (0 bytes)"));
  writeImage("a.tiff", cv::Mat(24, 64, CV_32FC1, cv::Scalar(1)));
  EXPECT_THAT(info().out, HasSubstr("the image has 64 x 24 pixels, the camera 64 x 48"));
  cv::Mat bad(48, 64, CV_32FC1, cv::Scalar(1));
  bad.at<float>(3, 4) = std::numeric_limits<float>::quiet_NaN();
  bad.at<float>(3, 5) = -1;
  writeImage("a.tiff", bad);
  const ProgramRun run = info();
  EXPECT_THAT(run.out, HasSubstr("1 of 2 frames contain NaN or infinite values; first: frame a"));
  EXPECT_THAT(run.out, HasSubstr("1 of 2 frames contain negative values; first: frame a"));
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.err, "");
}

TEST_F(SceneOnDisk, BadFilesAreCodeTwoWithFilePlaceAndReasonOnOneLine) {
  struct Row {
    const char *from, *to, *expected;
  };
  for (const Row& row :
       {Row{"[0,1,0,0]", "[0,NaN,0,0]", "scene.json: frames[0].camera_from_world[1][1]: must be a finite number"},
        Row{"\"fx\": 80", "\"fx\": 0", "scene.json: camera.fx: must be positive"},
        Row{"\"width\": 64", "\"width\": \"wide\"", "scene.json: camera.width: must be a finite number, is text"},
        Row{"\"id\": \"b\"", "\"id\": \"a\"", "scene.json: frames[1].id: duplicate id 'a'"},
        Row{"\"frames\": [", "\"frames\": [[", "scene.json: line "},
        Row{"\"analytic\": {\"type\": \"sphere\", \"radius\": 0.4}", "\"mesh\": \"body.ply\"",
            "scene.json: surfaces.ball.mesh: file '"}}) {
    rewrite(row.from, row.to);
    const ProgramRun run = info();
    EXPECT_EQ(run.code, 2) << row.to;
    EXPECT_EQ(run.errorLines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(row.expected));
    EXPECT_EQ(run.out, "");
  }
}

TEST_F(SceneOnDisk, TruncatedMeshIsCodeTwo) {
  rewrite("\"analytic\": {\"type\": \"sphere\", \"radius\": 0.4}", "\"mesh\": \"body.ply\"");
  folder_.write("body.ply",
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
                "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n");
  const ProgramRun run = info();
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(run.errorLines(), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("body.ply: header: the PLY is truncated"));
}

TEST_F(SceneOnDisk, SurfaceThatNoCameraSeesIsCodeThree) {
  std::string away = with(text_, "[0,0,1,2]", "[0,0,1,-2]");
  folder_.write("scene.json", with(away, "[0,0,1,2]", "[0,0,1,-2]"));
  const ProgramRun run = info();
  EXPECT_EQ(run.code, 3);
  EXPECT_EQ(run.errorLines(), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("no camera sees a surface"));
  EXPECT_THAT(run.out, HasSubstr("they look away from it"));
}

TEST_F(SceneOnDisk, ATriangleWhoseCornersLieOutsideOfTheImageIsSeen) {
  rewrite("\"analytic\": {\"type\": \"sphere\", \"radius\": 0.4}", "\"mesh\": \"body.ply\"");
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
      "1\nproperty list uchar int vertex_indices\nend_header\n";
  for (const bool before : {true, false}) {  // the cameras, which stand at z = -2 and look along z
    const std::string z = before ? " 0\n" : " -9\n";
    folder_.write("body.ply", header + "-50 -50" + z + "50 -50" + z + "0 80" + z + "3 0 1 2\n");
    const ProgramRun run = info();
    EXPECT_EQ(run.code, before ? 0 : 3) << run.err;
    EXPECT_EQ(run.out.find("do not see their surface") == std::string::npos, before) << run.out;
  }
}

TEST_F(SceneOnDisk, EmptyFolderIsCodeTwo) {
  const TemporaryFolder empty;
  const ProgramRun run = runGlint("info " + quoted(empty.path()));
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(run.errorLines(), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("the folder is empty; supported: scene file, session, COLMAP model, NVM of VisualSFM, "
                                 "transforms.json of nerfstudio, TUM RGB-D sequence, Bundler, BOP scene"));
}

TEST_F(SceneOnDisk, ConvertWritesASceneThatReadsBack) {
  const ProgramRun run = runGlint("convert " + quoted(folder_.path()) + " -o " + quoted(folder_ / "new.json"));
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(runGlint("info " + quoted(folder_ / "new.json")).code, 0);
}

TEST_F(SceneOnDisk, OutputThatCannotBeWrittenIsCodeTwoAndLeavesNothing) {
  const TemporaryFolder target;
  const ProgramRun missing = runGlint("convert " + quoted(folder_.path()) + " -o " + quoted(target / "none/x.json"));
  EXPECT_EQ(missing.code, 2);
  EXPECT_EQ(missing.errorLines(), 1) << missing.err;
  // No file may grow: what a full disk does. (The messages' own file is empty before and may take one block.)
  const ProgramRun full = runGlint("info " + quoted(folder_.path()) + " --json " + quoted(target / "x.json"), "ulimit -f 0; ");
  EXPECT_EQ(full.code, 2);
  EXPECT_TRUE(fs::is_empty(target.path()));
}

}  // namespace
}  // namespace glint

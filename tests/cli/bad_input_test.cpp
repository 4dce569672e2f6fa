// SPDX-License-Identifier: BSD-3-Clause
// Wrong input from outside, through the program: the exit code, one line with file and place, nothing half written.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <map>

#include "tests/cli/small_scene.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

class BadInput : public SmallScene {
 protected:
  /// Every command that reads the scene, each with an output that an older run left.
  void everyCommandRefuses(int code, const std::string& message) {
    writeScene();
    for (const char* command : {"info", "detect", "evaluate", "reconstruct", "render", "convert"})
      refuses(command, code, message);
  }
  /// The output of an older run of the command: its kind tells that the command may replace it.
  static std::string oldOutputOf(const std::string& command) {
    static const std::map<std::string, std::string> keys = {{"info", "info"},           {"detect", "detection"},
                                                            {"evaluate", "evaluation"}, {"reconstruct", "session"},
                                                            {"convert", "scene"},       {"predict", "predictions"}};
    return command == "render" ? "\x89PNG\r\n\x1a\nold" : "{\"glint_" + keys.at(command) + "\": 1}";
  }
  void refuses(const std::string& command, int code, const std::string& message) {
    const bool flagO = command == "reconstruct" || command == "render" || command == "convert";
    const std::string name = command == "convert" ? "old.json" : "old", old = oldOutputOf(command);
    folder_.write(name, old);
    const ProgramRun run =
        on(command, (command == "render" ? "--view frame " : "") + std::string(flagO ? "-o " : "--json ") + out(name));
    EXPECT_EQ(run.code, code) << command;
    EXPECT_EQ(run.errorLines(), 1) << command << ": " << run.err;
    EXPECT_THAT(run.err, HasSubstr(message)) << command;
    EXPECT_EQ(run.out, "") << command;
    EXPECT_EQ(contentOf(folder_ / name), old) << command;
  }
  /// Frame 7 is held out: its reason stands in the results, the other frames are answered, and nothing fails.
  void frameSevenHasReason(const std::string& reason) {
    writeScene();
    const ProgramRun evaluated = on("evaluate", "--models limit-angle --json -");
    ASSERT_EQ(evaluated.code, 0) << evaluated.err;
    EXPECT_EQ(evaluated.err, "");
    const Json model = Json::parse(evaluated.out)["models"]["limit-angle"];
    for (const Json& row : model["frames"]) {
      if (row["index"] == 7) {
        EXPECT_THAT(row["reason"].get<std::string>(), HasSubstr(reason));
      }
      if (row["index"] == 6) {
        EXPECT_EQ(row["status"], "ok");
      }
    }
    EXPECT_EQ(model["frames"].size(), 2u);
    const ProgramRun detected = on("detect", "--json -");
    ASSERT_EQ(detected.code, 0) << detected.err;
    const Json frames = Json::parse(detected.out)["frames"];
    EXPECT_THAT(frames[7]["reason"].get<std::string>(), HasSubstr(reason));
    EXPECT_EQ(frames[6]["status"], "ok");
  }
};

TEST_F(BadInput, PoseWithNan) {
  scene_["frames"][3]["camera_from_world"][1][3] = nullptr;  // how this library writes NaN
  everyCommandRefuses(2, "scene.json: frames[3].camera_from_world[1][3]: must be a finite number");
}

TEST_F(BadInput, SingularCamera) {
  scene_["camera"]["fx"] = 0;
  everyCommandRefuses(2, "scene.json: camera.fx: must be positive");
}

TEST_F(BadInput, WrongType) {
  scene_["frames"][2]["surface"] = 5;
  everyCommandRefuses(2, "scene.json: frames[2].surface: must be text, is a number");
}

TEST_F(BadInput, IdsTwice) {
  scene_["frames"][2]["id"] = "0001";
  everyCommandRefuses(2, "scene.json: frames[2].id: duplicate id '0001'");
}

TEST_F(BadInput, EmptyFolder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path())) fs::remove_all(entry);
  for (const char* command : {"info", "detect", "evaluate"}) {
    const ProgramRun run = on(command);
    EXPECT_EQ(run.code, 2) << command;
    EXPECT_EQ(run.errorLines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(folder_.path().string() + ": the folder is empty; supported: scene file"));
  }
}

TEST_F(BadInput, TruncatedMesh) {
  scene_["surfaces"]["body"] = {{"mesh", "body.ply"}};
  folder_.write("body.ply",
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
                "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n");
  writeScene();
  // detect and convert do not read the mesh.
  for (const char* command : {"info", "evaluate", "reconstruct", "render"})
    refuses(command, 2, "body.ply: header: the PLY is truncated: its header declares 3 of element 'vertex'");
}

TEST_F(BadInput, ImageMissingEmptyTruncatedOrOfAnotherSize) {
  const std::string bytes = contentOf(radiance(7));
  const std::string file = radiance(7).string();
  fs::remove(radiance(7));
  frameSevenHasReason("frame unreadable: " + file + ": cannot be read: No such file");
  EXPECT_EQ(on("render", "--view frame --frame 7 --models limit-angle --size 320x240 -o " + out("a.png")).code, 0);
  folder_.write("radiance/0007.tiff", "");
  frameSevenHasReason(file + ": the file is empty (0 bytes)");
  folder_.write("radiance/0007.tiff", bytes.substr(0, bytes.size() / 2));
  frameSevenHasReason(file + ": the TIFF is truncated");
  writeRadiance(7, cv::Mat(60, 80, CV_32FC1, cv::Scalar(1)));
  frameSevenHasReason(file + ": the image has 80 x 60 pixels, the camera 160 x 120");
}

TEST_F(BadInput, RadianceNanNegativeOrWithoutHighlight) {
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -3.0f}) {
    cv::Mat m = blob();
    m.at<float>(70, 96) = value;
    writeRadiance(7, m);
    frameSevenHasReason("not finite: 1 pixels are negative or not finite, and the highlight touches them");
  }
  writeRadiance(7, cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(0.1)));
  frameSevenHasReason("no highlight: nothing rises above the background");
}

TEST_F(BadInput, TrainingFrameThatCannotBeUsedIsAWarningAndAReason) {
  fs::remove(radiance(1));
  const ProgramRun run = on("evaluate", "--models limit-angle --json -");
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.errorLines(), 1) << run.err;
  EXPECT_THAT(run.err,
              StartsWith("glint: warning: 1 of 6 training frames could not be used; first: frame 0001: frame unreadable: " +
                         radiance(1).string()));
  const Json training = Json::parse(run.out)["training"];
  ASSERT_EQ(training.size(), 6u);
  EXPECT_EQ(training[0]["status"], "ok");
  EXPECT_EQ(training[1]["status"], "failed");
  EXPECT_THAT(training[1]["reason"].get<std::string>(), HasSubstr("No such file"));
}

TEST_F(BadInput, PeakOffTheSurfaceIsAReasonOfItsFrame) {
  withHighlights();
  scene_["frames"][1]["highlights"][0]["peak"] = {5, 5};
  writeScene();
  const ProgramRun run = on("evaluate", "--models limit-angle --json -");
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.errorLines(), 1) << run.err;
  EXPECT_THAT(Json::parse(run.out)["training"][1]["reason"].get<std::string>(), StartsWith("peak off surface"));
  for (Json& frame : scene_["frames"]) frame["highlights"][0]["peak"] = {5, 5};
  writeScene();
  const ProgramRun none = on("reconstruct", "--model limit-angle -o " + out("x.glint"));
  EXPECT_EQ(none.code, 3);
  EXPECT_EQ(none.errorLines(), 1) << none.err;
  EXPECT_THAT(none.err, HasSubstr("no training frame could be used; frame 0000: peak off surface"));
  EXPECT_FALSE(fs::exists(folder_ / "x.glint"));
}

TEST_F(BadInput, NothingToSeeIsCodeThree) {
  saveSession("--model limit-angle");
  for (int i = 0; i < kFrames; ++i) fs::remove(radiance(i));
  for (const char* command : {"detect", "evaluate", "reconstruct", "render"}) {
    const bool flagO = command == std::string("reconstruct") || command == std::string("render");
    const ProgramRun run = on(command, flagO ? (command == std::string("render") ? "--view frame -o " : "-o ") + out("x") : "");
    EXPECT_EQ(run.code, 3) << command;
    EXPECT_EQ(run.errorLines(), 1) << command << ": " << run.err;
    EXPECT_THAT(run.err, HasSubstr("No such file")) << command;
    EXPECT_FALSE(fs::exists(folder_ / "x")) << command;
  }
  const ProgramRun predicted = onSession("predict");
  EXPECT_EQ(predicted.code, 3);
  EXPECT_EQ(predicted.errorLines(), 1) << predicted.err;
  EXPECT_THAT(predicted.err, HasSubstr("frame 0000: frame unreadable"));
}

TEST_F(BadInput, SurfaceThatNoCameraSees) {
  for (Json& frame : scene_["frames"]) {  // turned round about the vertical of the image
    Json& pose = frame["camera_from_world"];
    for (const int row : {0, 2})
      for (Json& v : pose[row]) v = -v.get<double>();
  }
  writeScene();
  const ProgramRun info = on("info");
  EXPECT_EQ(info.code, 3);
  EXPECT_EQ(info.err, "glint: no surface: " + (folder_ / "scene.json").string() + ": no camera sees a surface\n");
  refuses("reconstruct", 3, "no training frame could be used; frame 0000: peak off surface");
  const ProgramRun evaluated = on("evaluate", "--models limit-angle,canonical,dual");
  EXPECT_EQ(evaluated.code, 3);
  EXPECT_EQ(evaluated.errorLines(), 1) << evaluated.err;
}

TEST_F(BadInput, FullDiskLeavesTheOldFile) {
  saveSession("--model limit-angle");
  const auto oldName = [](const std::string& command) { return command + "-old" + (command == "convert" ? ".json" : ""); };
  const auto old = [&](const std::string& command) {
    folder_.write(oldName(command), oldOutputOf(command));
    return out(oldName(command));
  };
  const std::string limit = "ulimit -f 1; ";  // no file may grow beyond one block: what a full disk does
  std::vector<ProgramRun> runs{on("evaluate", "--models limit-angle --json " + old("evaluate"), limit),
                               on("detect", "--json " + old("detect"), limit),
                               on("reconstruct", "--model limit-angle -o " + old("reconstruct"), limit),
                               on("render", "--view frame --models limit-angle -o " + old("render"), limit),
                               on("convert", "-o " + old("convert"), limit),
                               onSession("predict", "--json " + old("predict"), limit),
                               onSession("predict", "--out " + out("predicted"), limit),
                               on("detect", "--out " + out("detected"), limit),
                               runGlint("synth " + inQuotes(spec()) + " -o " + out("synth"), limit)};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    EXPECT_EQ(runs[i].code, 2) << i;
    EXPECT_EQ(runs[i].errorLines(), 1) << i << ": " << runs[i].err;
    EXPECT_THAT(runs[i].err, HasSubstr("cannot be ")) << i;
  }
  for (const char* command : {"evaluate", "detect", "reconstruct", "render", "convert", "predict"})
    EXPECT_EQ(contentOf(folder_ / oldName(command)), oldOutputOf(command)) << command;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_.path()))
    EXPECT_THAT(entry.path().filename().string(), testing::Not(StartsWith("."))) << "an unfinished file";
}

TEST_F(BadInput, OutputThatCannotBeWritten) {
  saveSession("--model limit-angle");
  const auto expectRefused = [](const std::string& place, const ProgramRun& run) {
    EXPECT_EQ(run.code, 2) << place;
    EXPECT_EQ(run.errorLines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(place.substr(1, place.size() - 2) + ": cannot be written: "));
  };
  for (const std::string& place : {out("missing/x"), inQuotes("/dev/full"), inQuotes(folder_ / "radiance")})
    expectRefused(place, on("info", "--json " + place));
  const std::string place = inQuotes("/dev/full");  // the only one that is noticed at the write itself
  for (const ProgramRun& run : {on("detect", "--json " + place), on("evaluate", "--models limit-angle --csv " + place),
                                on("reconstruct", "--model limit-angle -o " + place), onSession("predict", "--json " + place),
                                on("render", "--view frame --models limit-angle --size 64x64 -o " + place)})
    expectRefused(place, run);
}

TEST_F(BadInput, ReplayTellsEqualDifferentAndChanged) {
  saveSession("--model limit-angle");
  const ProgramRun equal = onSession("replay", "--exact");
  EXPECT_EQ(equal.code, 0) << equal.err << equal.out;
  EXPECT_EQ(equal.err, "");
  Json session = Json::parse(contentOf(folder_ / "run.glint"));
  Json& stored = session["results"]["key_results"]["limit-angle.contour_error_pct.mean"];
  stored = stored.get<double>() * 1.01;
  folder_.write("run.glint", session.dump());
  const ProgramRun different = onSession("replay");
  EXPECT_EQ(different.code, 1) << different.err;
  EXPECT_EQ(different.err, "");
  EXPECT_THAT(different.out, HasSubstr("limit-angle.contour_error_pct.mean"));
  fs::remove(radiance(7));
  const ProgramRun changed = onSession("replay");
  EXPECT_EQ(changed.code, 2);
  EXPECT_EQ(changed.errorLines(), 1) << changed.err;
  EXPECT_THAT(changed.err, HasSubstr(radiance(7).string() + ": missing"));
}

TEST_F(BadInput, InterruptedWorkLeavesNoFile) {
  // A pipe that is opened and never written to: once the shell could open it, the program waits inside a system call.
  // SIGTERM, because a shell lets its background jobs ignore SIGINT; the program treats both alike.
  fs::remove(radiance(3));
  ASSERT_EQ(std::system(("mkfifo " + inQuotes(radiance(3))).c_str()), 0);
  for (const std::string& command : {"evaluate " + inQuotes(folder_.path()) + " --json " + out("x.json"),
                                     "reconstruct " + inQuotes(folder_.path()) + " -o " + out("x.glint")}) {
    const ProgramRun run =
        runGlint(command + " & child=$!; exec 3>" + inQuotes(radiance(3)) + "; kill -TERM $child; wait $child");
    EXPECT_EQ(run.code, 130) << run.err;
    EXPECT_EQ(run.err, "glint: stopped\n");
    for (const char* name : {"x.json", "x.glint"}) EXPECT_FALSE(fs::exists(folder_ / name));
  }
}

TEST(BadDepth, AnUnreadableDepthImageIsNamedWithItsFile) {
  const TemporaryFolder folder;
  folder.write("bad.tiff", std::string("II*\0garbage", 11));
  folder.write("scene.json", R"({"glint_scene": 1, "camera": {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 32, "cy": 24},
    "frames": [{"id": "a", "depth": "bad.tiff", "camera_from_world": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]],
    "highlights": [{"light": "l", "level": 0.5, "peak": [30, 20], "contour": [[30,10],[40,20],[30,30],[20,20],[22,14]]}]}]})");
  for (const std::string command : {"evaluate", "reconstruct"}) {
    const ProgramRun run = runGlint(command + " '" + (folder / "scene.json").string() + "' --train 0" +
                                    (command == "reconstruct" ? " --model dual -o '" + (folder / "o.glint").string() + "'" : ""));
    EXPECT_EQ(run.code, 3) << command;
    EXPECT_THAT(run.err, HasSubstr("bad.tiff")) << command;
  }
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// A scene whose mesh and pictures were moved: every command that reads one can be told where they are.
#include <gmock/gmock.h>

#include <sstream>

#include "tests/cli/small_scene.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
namespace fs = std::filesystem;

class RelinkedScene : public SmallScene {
 protected:
  /// The ellipsoid as a mesh; what `glint` computes with everything in place; then mesh and pictures lie elsewhere.
  void SetUp() override {
    SmallScene::SetUp();
    scene_["surfaces"]["body"] = {{"mesh", "shape/body.ply"}};
    writeScene();
    folder_.write("shape/body.ply", ellipsoid());
    inPlace_ = errors(on("evaluate", kRequest));
    ASSERT_EQ(inPlace_.size(), 2u);
    fs::create_directories(elsewhere_ / "shape");
    fs::rename(folder_ / "shape/body.ply", elsewhere_ / "shape/body.ply");
    fs::rename(folder_ / "radiance", elsewhere_ / "radiance");
  }

  static std::string ellipsoid() {
    constexpr int kRound = 128, kUp = 64;
    std::ostringstream vertices;  // std::to_string writes by the locale
    std::string faces;
    for (int j = 0; j <= kUp; ++j)
      for (int i = 0; i < kRound; ++i) {
        const double u = 2 * M_PI * i / kRound, v = M_PI * (j + 0.5 * (j == 0) - 0.5 * (j == kUp)) / kUp;
        vertices << 0.6 * std::sin(v) * std::cos(u) << " " << 0.35 * std::sin(v) * std::sin(u) << " " << 0.3 * std::cos(v)
                 << "\n";
      }
    for (int j = 0; j < kUp; ++j)
      for (int i = 0; i < kRound; ++i) {
        const int a = j * kRound + i, b = j * kRound + (i + 1) % kRound;
        faces += "4 " + std::to_string(a) + " " + std::to_string(a + kRound) + " " + std::to_string(b + kRound) + " " +
                 std::to_string(b) + "\n";
      }
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(kRound * (kUp + 1)) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(kRound * kUp) +
           "\nproperty list uchar int vertex_indices\nend_header\n" + vertices.str() + faces;
  }

  static std::vector<double> errors(const ProgramRun& run) {
    EXPECT_EQ(run.code, 0) << run.err;
    std::vector<double> all;
    if (run.code != 0) return all;
    const Json json = Json::parse(run.out);
    for (const Json& frame : json["models"]["limit-angle"]["frames"]) all.push_back(frame["contour_error_px"].get<double>());
    return all;
  }
  std::string mesh() const { return " --mesh shape/body.ply=" + inQuotes(elsewhere_ / "shape/body.ply"); }
  std::string meshes() const { return " --meshes " + inQuotes(elsewhere_.path()); }
  std::string photographs() const { return " --photographs " + inQuotes(elsewhere_.path()); }

  /// Fits contours with a smooth background: these tests are about places of files, and a fit to the pixels takes ten times as
  /// long.
  static constexpr const char* kQuick = " --models limit-angle --set detect.background=smooth --set fit.evidence=contours";
  static inline const std::string kRequest = std::string(kQuick) + " --json -";
  TemporaryFolder elsewhere_;
  std::vector<double> inPlace_;
};

TEST_F(RelinkedScene, IsEvaluatedAsInItsPlace) {
  const ProgramRun missing = on("evaluate", kRequest + photographs());
  EXPECT_EQ(missing.code, 2);
  EXPECT_EQ(missing.errorLines(), 1);
  EXPECT_THAT(missing.err, HasSubstr("scene.json: surfaces.body.mesh: file '" + (folder_ / "shape/body.ply").string()));
  EXPECT_EQ(errors(on("evaluate", kRequest + photographs() + mesh())), inPlace_);
  EXPECT_EQ(errors(on("evaluate", kRequest + photographs() + meshes())), inPlace_);
  fs::rename(elsewhere_ / "shape/body.ply", elsewhere_ / "other name.ply");
  EXPECT_EQ(on("evaluate", kRequest + photographs() + meshes()).code, 2) << "no file of that name";
  EXPECT_EQ(
      errors(on("evaluate", kRequest + photographs() + " --mesh shape/body.ply=" + inQuotes(elsewhere_ / "other name.ply"))),
      inPlace_);
}

TEST_F(RelinkedScene, ASessionRemembersThePlaces) {
  // Both below one folder, which then moves: the session's paths are relative to itself.
  const TemporaryFolder all;
  fs::rename(folder_.path(), all / "scene");
  fs::rename(elsewhere_.path(), all / "elsewhere");
  const auto session = [&](const fs::path& folder) { return inQuotes(folder / "scene/run.glint"); };
  const std::string there = inQuotes(all / "elsewhere");
  const ProgramRun made = runGlint("reconstruct " + inQuotes(all / "scene") + kQuick + " -o " + session(all.path()) +
                                   " --photographs " + there + " --meshes " + there);
  ASSERT_EQ(made.code, 0) << made.err;
  const TemporaryFolder moved;
  fs::rename(all / "scene", moved / "scene");
  fs::rename(all / "elsewhere", moved / "elsewhere");
  // They lie outside of the folders of the session and its scene, so a person has to say yes, every time.
  EXPECT_EQ(runGlint("replay " + session(moved.path())).code, 2);
  const std::string yes = " --allow-outside";
  const ProgramRun replayed = runGlint("replay " + session(moved.path()) + yes);
  EXPECT_EQ(replayed.code, 0) << replayed.err << replayed.out;
  EXPECT_EQ(errors(runGlint("evaluate " + session(moved.path()) + " --json -" + yes)), inPlace_);
  EXPECT_EQ(errors(runGlint("evaluate " + session(moved.path()) + " --json - --photographs " + inQuotes(moved / "elsewhere"))),
            inPlace_)
      << "or name the folder";
  // A session made from that session remembers them, too.
  EXPECT_EQ(runGlint("reconstruct " + session(moved.path()) + kQuick + " -o " + inQuotes(moved / "second.glint") + yes).code, 0);
  EXPECT_EQ(runGlint("replay " + inQuotes(moved / "second.glint") + yes).code, 0);
  // The given place counts, not the session's; a file other than the one it was made with is reported.
  fs::create_directories(moved / "third");
  fs::rename(moved / "elsewhere/shape/body.ply", moved / "third/b.ply");
  EXPECT_EQ(runGlint("replay " + session(moved.path()) + yes).code, 2);
  const std::string given = yes + " --mesh shape/body.ply=" + inQuotes(moved / "third/b.ply");
  EXPECT_EQ(errors(runGlint("evaluate " + session(moved.path()) + " --json -" + given)), inPlace_);
  EXPECT_EQ(runGlint("predict " + session(moved.path()) + given).err, "");
  moved.write("third/b.ply", contentOf(moved / "third/b.ply") + "\n");
  EXPECT_THAT(runGlint("predict " + session(moved.path()) + given).err,
              HasSubstr("b.ply differs from the mesh that the session was made with"));
}

TEST_F(RelinkedScene, IsAnInputOfEveryCommand) {
  for (const char* command : {"info", "detect"}) {
    EXPECT_EQ(on(command).code, 2) << command;
    EXPECT_EQ(on(command, photographs() + mesh()).code, 0) << command;
  }
  const std::string to = inQuotes(folder_ / "written.json");
  EXPECT_EQ(on("convert", photographs() + mesh() + " -o " + to).code, 0);
  EXPECT_EQ(errors(runGlint("evaluate " + to + " --allow-outside " + kRequest)), inPlace_) << "it names them where they are";
  EXPECT_EQ(
      on("render", std::string("--view frame --size 320x240") + kQuick + photographs() + mesh() + " -o " + out("x.png")).code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "x.png"));
}

TEST_F(RelinkedScene, FindsMasksWhereTheyAre) {
  scene_["frames"][0]["mask"] = "masks/0.png";
  writeScene();
  const std::string flags = photographs() + mesh();
  EXPECT_THAT(runGlint("detect " + inQuotes(folder_.path()) + flags + " --json -").out, HasSubstr("masks/0.png: "));
  fs::create_directories(folder_ / "masks");
  ASSERT_TRUE(cv::imwrite((folder_ / "masks/0.png").string(), cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(255))));
  const std::vector<double> inPlace = errors(on("evaluate", kRequest + flags));
  TemporaryFolder other;
  fs::rename(folder_ / "masks", other / "masks");
  const std::string masks = " --files masks=" + inQuotes(other.path());
  EXPECT_EQ(errors(on("evaluate", kRequest + flags + masks)), inPlace);
  const ProgramRun made = on("reconstruct", std::string(kQuick) + " -o " + out("masked.glint") + flags + masks);
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(made.err, "");
  EXPECT_EQ(errors(runGlint("evaluate " + out("masked.glint") + " --allow-outside --json -")), inPlace);
}

TEST_F(RelinkedScene, WrongPlacesNameTheFlag) {
  const auto refused = [&](const std::string& flags, const std::string& expected) {
    const ProgramRun run = on("evaluate", flags);
    EXPECT_EQ(run.code, 2) << flags;
    EXPECT_EQ(run.errorLines(), 1) << flags << ": " << run.err;
    EXPECT_THAT(run.err, HasSubstr(expected)) << flags;
  };
  for (const char* wrong : {"x", "=x", "x="})
    refused(std::string("--mesh ") + wrong, std::string("--mesh ") + wrong + ": expected NAME=FILE");
  refused("--meshes /nowhere", "--meshes /nowhere: this folder does not exist");
  refused("--mesh shape/body.ply=/nowhere/b.ply", "scene.json: surfaces.body.mesh: file '/nowhere/b.ply' does not exist");
  refused(meshes() + " --mesh body=x", "--mesh body=x: the scene has no mesh 'body'; known: shape/body.ply");
  refused(mesh() + " --photographs /nowhere", "--photographs /nowhere: this folder does not exist");
  refused(mesh() + " --photographs " + inQuotes(elsewhere_ / "shape"), "contains no photograph of this scene");
  refused(mesh() + " --files depth=" + inQuotes(elsewhere_.path()), "contains no such file of this scene");
  refused(mesh() + " --files masks=/nowhere", "--files masks=/nowhere: this folder does not exist");
  for (const char* wrong : {"mask=/", "masks", "=/"})
    refused(mesh() + " --files " + wrong, "expected KIND=DIR, where KIND is one of: photographs, depth, normals, masks");
}

}  // namespace
}  // namespace glint

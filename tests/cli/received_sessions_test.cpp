// SPDX-License-Identifier: BSD-3-Clause
// A session that came from somebody else has no rights of its own: what it names outside of its folder and its scene's is not
// looked at until the person at this command line says so.
#include <gmock/gmock.h>

#include "tests/cli/small_scene.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class ReceivedSessions : public SmallScene {
 protected:
  void SetUp() override {
    SmallScene::SetUp();
    withHighlights();
    writeScene();
    saveSession();
    session_ = Json::parse(contentOf(folder_ / "run.glint"));
  }
  /// The session as it was received: beside nothing else, its scene named by an absolute path.
  void receive() {
    session_["input"]["path"] = (folder_ / "scene.json").string();
    received_.write("run.glint", session_.dump());
  }
  ProgramRun onReceived(const std::string& command, const std::string& more = "") const {
    return runGlint(command + " " + inQuotes(received_ / "run.glint") + " " + more);
  }
  Json session_;
  TemporaryFolder received_, outside_;
};

TEST_F(ReceivedSessions, TheSceneMayLieAnywhere) {
  session_["input"]["files"] = Json::array();
  receive();
  const ProgramRun run = onReceived("predict", "--json " + inQuotes(received_ / "p.json"));
  EXPECT_EQ(run.code, 0) << run.err;
}

TEST_F(ReceivedSessions, FoldersOutsideNeedTheWordOfThisCommandLine) {
  outside_.write("0000.png", "not an image");
  session_["input"]["allow_outside"] = true;  // counts for nothing
  session_["input"]["folders"] = {{{"of", "photographs"}, {"folder", outside_.path().string()}}};
  receive();
  const ProgramRun refused = onReceived("predict");
  EXPECT_EQ(refused.code, 2);
  EXPECT_EQ(refused.errorLines(), 1) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("input.folders[0].folder"));
  EXPECT_THAT(refused.err, HasSubstr("--allow-outside"));
  EXPECT_EQ(onReceived("predict", "--allow-outside").code, 0);
}

TEST_F(ReceivedSessions, MeshesAndTruthOutsideAreRefusedToo) {
  session_["input"]["allow_outside"] = true;
  session_["input"]["meshes"] = {{"body.ply", (outside_ / "body.ply").string()}};
  receive();
  EXPECT_THAT(onReceived("predict").err, HasSubstr("input.meshes.body.ply"));
  session_["input"].erase("meshes");
  session_["request"]["truth"] = outside_.path().string();
  receive();
  EXPECT_THAT(onReceived("evaluate").err, HasSubstr("request.truth"));
}

// With a hash to compare, a session could ask whether a file of its reader is a certain one.
TEST_F(ReceivedSessions, NothingIsSaidAboutFilesOutside) {
  outside_.write("there.txt", "secret");
  const auto replayWith = [&](const std::string& name, const std::string& hash) {
    session_["input"]["files"] = {{{"path", (outside_ / name).string()}, {"sha256", hash}}};
    receive();
    return onReceived("replay");
  };
  const std::string right = "2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b";  // sha256sum of "secret"
  const std::string wrong(64, '0');
  const ProgramRun same = replayWith("there.txt", right), other = replayWith("there.txt", wrong);
  EXPECT_EQ(same.code, 2);
  EXPECT_EQ(same.err, other.err);
  EXPECT_THAT(same.err, HasSubstr("not compared"));
  const ProgramRun missing = replayWith("gone1.txt", right);
  EXPECT_THAT(missing.err, Not(HasSubstr("missing")));
}

TEST_F(ReceivedSessions, ASessionThatNamesItselfAFolderOrADeviceIsRefused) {
  for (const std::string& path :
       {std::string("."), std::string("run.glint"), std::string("/dev/zero"), std::string(".."), folder_.path().string()}) {
    session_["input"]["path"] = path;
    received_.write("run.glint", session_.dump());
    const ProgramRun run = onReceived("predict");
    EXPECT_EQ(run.code, 2) << path;
    EXPECT_EQ(run.errorLines(), 1) << run.err;
  }
}

/// A link in a folder that the session may name leads out of it all the same.
TEST_F(ReceivedSessions, ALinkInAPermittedFolderGivesNoRight) {
  outside_.write("0000.png", "not an image");
  std::filesystem::create_directory(received_ / "sub");
  std::filesystem::create_directory_symlink(outside_.path(), received_ / "sub/frames");
  for (const char* image : {"0000.png", "frames/0000.png"}) {  // as the scene may name it
    scene_["frames"][0]["image"] = image;
    writeScene();
    session_["input"]["folders"] = {{{"of", "photographs"}, {"folder", std::string(image) == "0000.png" ? "sub/frames" : "sub"}}};
    session_["input"]["files"] = Json::array();
    receive();
    for (const char* command : {"predict", "detect --source image --json -", "replay"}) {
      const ProgramRun run = onReceived(command);
      EXPECT_EQ(run.code, 2) << command;
      EXPECT_THAT(run.err, HasSubstr("input.folders[0].folder")) << command;
    }
    EXPECT_EQ(onReceived("predict", "--allow-outside").code, 0);
  }
}

TEST_F(ReceivedSessions, ALinkInATruthFolderGivesNoRight) {
  const std::filesystem::path secret = outside_.write("0000.json", "{\"levels\": 5}");
  std::filesystem::create_directory(received_ / "truth");
  std::filesystem::create_symlink(secret, received_ / "truth/0000.json");
  session_["request"]["truth"] = "truth";
  session_["input"]["files"] = Json::array();
  receive();
  const ProgramRun run = onReceived("evaluate");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("request.truth"));
  EXPECT_THAT(run.err, Not(HasSubstr("levels")));
}

TEST_F(ReceivedSessions, ManyFoldersAreRefusedAndRepeatedModelsAreOne) {
  session_["request"]["models"] = Json::array();
  for (int i = 0; i < 100000; ++i) session_["request"]["models"].push_back("limit-angle");
  receive();
  EXPECT_EQ(onReceived("predict").code, 0);
  for (int i = 0; i < 101; ++i) session_["input"]["folders"].push_back({{"of", "depth"}, {"folder", "."}});
  receive();
  const ProgramRun run = onReceived("predict");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("names 101 folders; the limit is 100"));
}

TEST_F(ReceivedSessions, AFileThatIsADeviceEnds) {
  session_["input"]["files"] = {{{"path", "/dev/zero"}, {"sha256", std::string(64, '0')}}};
  receive();
  EXPECT_EQ(onReceived("replay").code, 2);
  EXPECT_EQ(onReceived("replay", "--allow-outside").code, 2);
}

TEST_F(ReceivedSessions, ASceneIsNoSession) {
  const ProgramRun run = runGlint("predict " + inQuotes(folder_ / "scene.json"));
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("is a scene, not a session"));
}

/// A document of another kind is named as such; its missing keys are not listed.
TEST_F(ReceivedSessions, ASpecificationIsNeitherASceneNorASession) {
  const std::string specification = inQuotes(std::filesystem::path(GLINT_SOURCE_DIR) / "resources/specs/ellipsoid_80.json");
  for (const char* command : {"info ", "evaluate "}) {
    const ProgramRun run = runGlint(command + specification);
    EXPECT_EQ(run.code, 2) << command;
    EXPECT_THAT(run.err, HasSubstr("is a specification, not a scene")) << command;
  }
  EXPECT_THAT(runGlint("predict " + specification).err, HasSubstr("is a specification, not a session"));
  receive();
  const ProgramRun made = onReceived("synth", "-o " + inQuotes(received_ / "made"));
  EXPECT_EQ(made.code, 2);
  EXPECT_THAT(made.err, HasSubstr("is a session, not the specification"));
}

TEST_F(ReceivedSessions, ANewerSessionIsRefusedByEveryCommand) {
  session_["glint_session"] = 5;
  receive();
  for (const char* command : {"info", "predict", "evaluate", "replay", "detect --json -", "tradeoff"}) {
    const ProgramRun run = onReceived(command);
    EXPECT_EQ(run.code, 2) << command;
    EXPECT_THAT(run.err, HasSubstr("version 5 is newer than this program supports")) << command;
  }
}

}  // namespace
}  // namespace glint

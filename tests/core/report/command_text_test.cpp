// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <memory>

#include "core/report/texts.h"
#include "core/scene/frame_name.h"

namespace glint {
namespace {

/// What a shell makes of a word.
std::string throughShell(const std::string& word) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(("printf %s " + word).c_str(), "r"), pclose);
  std::string out;
  std::array<char, 256> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe.get())) out.append(buffer.data(), n);
  return out;
}

TEST(CommandText, AShellGivesBackEveryWord) {
  for (const std::string text : {"plain.json", "two words", "it's", "$HOME `x` \"q\" \\", "$HOME", "a$$", "a;b|c&d", "*", "~",
                                 "#a", "!", "(b)", "a\tb", "a\nb", "--", "ümlaut"})
    EXPECT_EQ(throughShell(shellWord(text)), text);
  EXPECT_EQ(shellWord(""), "''");
}

Scene sceneIn(const std::string& file) {
  Scene scene;
  scene.file = file;
  return scene;
}

TEST(CommandText, DefaultsAreLeftOut) { EXPECT_EQ(*commandOf(sceneIn("/s/scene.json"), {}), "glint evaluate /s/scene.json"); }

/// The inspector may have been started with a relative path; the shell that the command is pasted into stands elsewhere.
TEST(CommandText, EveryPathIsAbsolute) {
  Scene scene = sceneIn("data/../scene.json");
  scene.folders = {{FrameFile::Photograph, "photos"}, {FrameFile::Depth, "depth"}};
  scene.meshes = {{"a.ply", "meshes/a.ply"}};
  InspectionRequest q;
  q.truthFolder = "truth";
  std::array<char, 4096> here{};
  ASSERT_NE(getcwd(here.data(), here.size()), nullptr);
  const std::string at = std::string(here.data()) + "/";
  EXPECT_EQ(*commandOf(scene, q), "glint evaluate " + shellWord(at + "scene.json") + " --truth " + shellWord(at + "truth") +
                                      " --photographs " + shellWord(at + "photos") + " --files " +
                                      shellWord("depth=" + at + "depth") + " --mesh " +
                                      shellWord("a.ply=" + at + "meshes/a.ply"));
}

/// The inspector remembers what its user allowed; a command has to say it.
TEST(CommandText, FilesOutsideOfTheNamedFoldersNeedTheFlag) {
  Scene scene = sceneIn("/s/scene.json");
  scene.frames.resize(1);
  scene.frames[0].image = "/s/frames/0.png";
  EXPECT_EQ(*commandOf(scene, {}), "glint evaluate /s/scene.json");
  scene.frames[0].image = "/elsewhere/0.png";
  EXPECT_EQ(*commandOf(scene, {}), "glint evaluate /s/scene.json --allow-outside");
  scene.folders = {{FrameFile::Photograph, "/elsewhere"}};
  EXPECT_EQ(*commandOf(scene, {}), "glint evaluate /s/scene.json --photographs /elsewhere");
}

Scene withIds(const std::vector<std::string>& ids) {
  Scene scene = sceneIn("/s/scene.json");
  for (const std::string& id : ids) {
    Frame frame;
    frame.id = id;
    scene.frames.push_back(frame);
  }
  return scene;
}

TEST(CommandText, ExcludedFramesAreNamed) {
  InspectionRequest q;
  q.excluded = {1, 3, 4, 5};
  EXPECT_EQ(*commandOf(withIds({"a", "b", "c", "d", "e", "f", "g"}), q), "glint evaluate /s/scene.json --exclude b,d-f");
}

/// Ids win over numbers: where the ids are numbers themselves, "1" is the frame of that id.
TEST(CommandText, WhatNamesFramesIsReadBackAsTheSameFrames) {
  for (const std::vector<std::string>& ids : {std::vector<std::string>{"1", "2", "3", "4", "5", "6"},
                                              {"5", "4", "3", "2", "1", "0"},
                                              {"0-2", "1-3", "a-b", "3-4", "x", "2"},
                                              {"0000", "0001", "0002", "0003", "0004", "0005"}}) {
    const Scene scene = withIds(ids);
    for (unsigned set = 1; set < 64; ++set) {
      std::vector<int> frames;
      for (int i = 0; i < 6; ++i)
        if (set >> i & 1u) frames.push_back(i);
      EXPECT_EQ(parseFrames(frameSpec(frames, scene), scene, "--exclude"), frames)
          << ids[0] << " " << set << ": " << frameSpec(frames, scene);
    }
  }
}

/// A person reads what names frames, so it names them by their ids; numbers stand where an id would not be read back.
TEST(CommandText, FramesAreNamedByTheirIds) {
  const std::vector<int> frames = {0, 2, 3, 4};
  EXPECT_EQ(frameSpec(frames, withIds({"0008", "0004", "0012", "0016", "0020"})), "0008,0012-0020");
  EXPECT_EQ(frameSpec({1}, withIds({"4", "0", "1", "2", "3"})), "0") << "the id of frame 1";
  EXPECT_EQ(frameSpec({0, 1}, withIds({"a,b", "c"})), "0-1") << "a comma separates";
  EXPECT_EQ(frameSpec({0}, withIds({"first:1", "c"})), "0") << "a rule";
  EXPECT_EQ(frameSpec({}, withIds({"a"})), "");
}

/// The same for what trains: a rule with what it means.
TEST(CommandText, WhatTrainsIsNamedByItsIds) {
  const Scene scene = withIds({"0008", "0012", "0016", "0020"});
  const auto text = [&](const char* spec) { return trainText(parseTrainSpec(spec, scene), scene); };
  EXPECT_EQ(text("0,2,3"), "0008,0016-0020");
  EXPECT_EQ(text("0008,0012"), "0008-0012");
  EXPECT_EQ(text("first:3"), "first:3, 0008-0016");
  EXPECT_EQ(text("spread:2"), "spread:2, 0008,0016");
  EXPECT_EQ(text("per-surface"), "per-surface");
}

TEST(CommandText, EverythingThatHasAFlagIsThere) {
  InspectionRequest q;
  q.models = {"canonical", "limit-angle"};
  q.train = "spread:6";
  q.source = FrameSource::Image;
  q.settings.setFromText("detect.level", "0.1");
  q.settings.setFromText("fit.solver", "anchored");
  q.settings.setFromText("light.refine_poses", "true");
  q.noisePx = 0.3;
  q.seed = 7;
  q.truthFolder = "/the truth";
  Scene scene = sceneIn("/a b.json");
  scene.allowOutsidePaths = true;
  scene.folders = {{FrameFile::Photograph, "/else where"}, {FrameFile::Mask, "/m s"}, {FrameFile::Photograph, "/p2"}};
  scene.meshes = {{"it's.ply", "/m/it's.ply"}, {"m/b.ply", "/m/b2.ply"}};
  EXPECT_EQ(
      *commandOf(scene, q),
      "glint evaluate '/a b.json' --models canonical,limit-angle --train spread:6 --source image --set detect.level=0.1 "
      "--set fit.solver=anchored "
      "--set light.refine_poses=true --noise-px 0.3 --seed 7 --truth '/the truth' --allow-outside --photographs '/else where' "
      "--files 'masks=/m s' --photographs /p2 "
      "--mesh 'it'\\''s.ply=/m/it'\\''s.ply' --mesh m/b.ply=/m/b2.ply");
}

TEST(CommandText, WhatHasNoFlagIsNamed) {
  InspectionRequest q;
  q.whatIf.poses[1].rotation = {0.1, 0, 0};
  EXPECT_EQ(commandOf(sceneIn("x"), q).failure().reason, Reason::NotSupported);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/evaluate/command_text.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>

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

TEST(CommandText, DefaultsAreLeftOut) { EXPECT_EQ(*commandOf(sceneIn("scene.json"), {}), "glint evaluate scene.json"); }

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
  q.truthFolder = "the truth";
  Scene scene = sceneIn("a b.json");
  scene.allowOutsidePaths = true;
  scene.folders = {{FrameFile::Photograph, "/else where"}, {FrameFile::Mask, "/m s"}, {FrameFile::Photograph, "/p2"}};
  scene.meshes = {{"it's.ply", "/m/it's.ply"}, {"m/b.ply", "/m/b2.ply"}};
  EXPECT_EQ(
      *commandOf(scene, q),
      "glint evaluate 'a b.json' --models canonical,limit-angle --train spread:6 --source image --set detect.level=0.1 "
      "--set fit.solver=anchored "
      "--set light.refine_poses=true --noise-px 0.3 --seed 7 --truth 'the truth' --allow-outside --photographs '/else where' "
      "--files 'masks=/m s' --photographs /p2 "
      "--mesh 'it'\\''s.ply=/m/it'\\''s.ply' --mesh m/b.ply=/m/b2.ply");
}

TEST(CommandText, WhatHasNoFlagIsNamed) {
  InspectionRequest q;
  q.excluded = {3};
  EXPECT_EQ(commandOf(sceneIn("x"), q).failure().reason, Reason::NotSupported);
  q.excluded.clear();
  q.whatIf.poses[1].rotation = {0.1, 0, 0};
  EXPECT_EQ(commandOf(sceneIn("x"), q).failure().reason, Reason::NotSupported);
}

}  // namespace
}  // namespace glint

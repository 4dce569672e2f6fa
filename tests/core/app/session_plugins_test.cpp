// SPDX-License-Identifier: BSD-3-Clause
// A session says with which plugins it was saved, and is refused by their names where its models need them.
#include <gmock/gmock.h>

#include <filesystem>

#include "core/app/load_plugins.h"
#include "core/app/session.h"
#include "core/base/atomic_file.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint::session_plugins_tests {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string text(const std::string& models, const std::string& plugins, const std::string& settings = "{}") {
  return R"({"glint_session": 3, "input": {"path": "scene.json"}, "request": {"models": [")" + models +
         R"("], "train": "0", "settings": )" + settings + R"(}, "plugins": )" + plugins + "}";
}
const std::string kExample =
    R"([{"name": "example", "version": "1.0", "adds": ["model flat-mirror", "lobe student-t", "surface superellipsoid"]}])";

std::string failureOf(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

struct Folder {
  testing_support::TemporaryFolder folder;
  std::filesystem::path file = folder / "a.glint";
  void write(const std::string& session, const std::string& type = "sphere") {
    atomicWrite(
        folder / "scene.json",
        R"({"glint_scene": 1, "name": "s", "units": "m", "camera": {"width": 4, "height": 4, "fx": 4, "fy": 4, "cx": 2, "cy": 2},
                   "frames": [{"id": "0", "surface": "a", "camera_from_world": [[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]],
                               "highlights": [{"peak": [2, 2], "contour": [[1, 2], [1.5, 1.5], [2, 1], [3, 2], [2, 3]]}]}],
                   "surfaces": {"a": {"analytic": {"type": ")" +
            type + R"(", "radius": 1}}}})");
    atomicWrite(file, session);
  }
};

TEST(SessionPlugins, WhatIsLoadedIsWrittenAndReadBack) {
  loadPlugin(GLINT_EXAMPLE_PLUGIN);
  Folder f;
  f.write(text("flat-mirror", "[]"));
  const OpenedSession opened = openSession(f.file);
  EXPECT_EQ(opened.warning, "");
  writeSession(opened.session, f.file);
  const Session again = readSession(f.file);
  EXPECT_TRUE(again.warnings.empty());
  ASSERT_EQ(again.plugins.size(), 1u);
  EXPECT_EQ(again.plugins[0].name, "example");
  EXPECT_EQ(again.plugins[0].version, "1.0");
  EXPECT_THAT(again.plugins[0].adds, testing::Contains("model flat-mirror"));
  EXPECT_EQ(openSession(f.file).warning, "");
}

TEST(SessionPlugins, AModelOfAMissingPluginIsRefusedByBothNames) {
  Folder f;
  f.write(text("flat-mirror", kExample));
  EXPECT_THAT(
      failureOf([&] { openSession(f.file); }),
      AllOf(HasSubstr("request.models"), HasSubstr("'flat-mirror' is from the plugin example 1.0"), HasSubstr("--plugin")));
}

TEST(SessionPlugins, ALobeAndASurfaceOfAMissingPluginNameIt) {
  Folder f;
  f.write(text("limit-angle", kExample, R"({"fit.lobe": "student-t"})"));
  EXPECT_THAT(failureOf([&] { readSession(f.file); }), AllOf(HasSubstr("fit.lobe"), HasSubstr("the plugin example 1.0")));
  f.write(text("limit-angle", kExample), "superellipsoid");
  EXPECT_THAT(failureOf([&] { openSession(f.file); }),
              AllOf(HasSubstr("superellipsoid"), HasSubstr("the plugin example 1.0"), HasSubstr("scene.json")));
}

TEST(SessionPlugins, AFailureThatNoPluginMendsDoesNotNameOne) {
  Folder f;
  f.write(text("limit-angle", kExample, R"({"detect.level": 7})"));
  EXPECT_THAT(failureOf([&] { readSession(f.file); }), AllOf(HasSubstr("detect.level"), Not(HasSubstr("example"))));
}

TEST(SessionPlugins, OneThatIsNotNeededIsAWarningAndStaysInTheFile) {
  Folder f;
  f.write(text("limit-angle", kExample));
  const OpenedSession opened = openSession(f.file);
  EXPECT_THAT(opened.warning, AllOf(HasSubstr("the plugin example 1.0"), HasSubstr("not loaded")));
  writeSession(opened.session, f.file);
  ASSERT_EQ(readSession(f.file).plugins.size(), 1u);
  EXPECT_EQ(readSession(f.file).plugins[0].adds.size(), 3u);
}

TEST(SessionPlugins, AnotherVersionIsAWarning) {
  loadPlugin(GLINT_EXAMPLE_PLUGIN);
  Folder f;
  f.write(text("flat-mirror", R"([{"name": "example", "version": "0.9"}])"));
  EXPECT_THAT(openSession(f.file).warning, AllOf(HasSubstr("example 0.9"), HasSubstr("1.0 is loaded")));
}

TEST(SessionPlugins, DamagedListsAreRefusedWithTheirPlace) {
  Folder f;
  for (const std::string wrong :
       {R"({"name": "example"})", R"([{"name": 3, "version": "1"}])", R"([{"name": "", "version": "1"}])",
        R"([{"version": "1"}])", R"([{"name": "a", "version": "1", "adds": [1]}])", "7"}) {
    f.write(text("limit-angle", wrong));
    EXPECT_THAT(failureOf([&] { readSession(f.file); }), HasSubstr("plugins")) << wrong;
  }
}

}  // namespace
}  // namespace glint::session_plugins_tests

// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/load_plugins.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "core/app/session.h"
#include "core/base/settings.h"
#include "core/scene/scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint::plugin_tests {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::UnorderedElementsAre;
using testing_support::inputErrorOf;
using testing_support::TemporaryFolder;

fs::path built(const std::string& name) { return fs::path(GLINT_TEST_PLUGINS) / (name + ".so"); }

/// The refusal of a plugin, and that nothing of it was kept.
std::string refusalOf(const fs::path& file) {
  std::string words;
  try {
    loadPlugin(file);
    ADD_FAILURE() << file << " was loaded";
  } catch (const InputError& e) {
    words = e.what();
  }
  EXPECT_TRUE(loadedPlugins().empty());
  EXPECT_FALSE(lobeOf("student-t").has_value());
  EXPECT_EQ(modelIds().size(), 5u);
  EXPECT_EQ(allLobes().size(), 4u);
  return words;
}

TEST(LoadPlugin, AddsWhatItBrings) {
  loadPlugin(built("none"));
  ASSERT_EQ(loadedPlugins().size(), 1u);
  EXPECT_EQ(loadedPlugins()[0].name, "tried");
  EXPECT_THAT(loadedPlugins()[0].added, UnorderedElementsAre("lobe student-t"));
  EXPECT_THAT(pluginLines(), AllOf(HasSubstr("plugin tried 1: For a test (lobe student-t; "), HasSubstr("none.so)")));
  Settings settings;
  settings.setFromText("fit.lobe", "student-t");  // no longer an unknown name
  loadPlugin(built("none"));                      // the same file once more is no fault
  EXPECT_EQ(loadedPlugins().size(), 1u);
}

TEST(LoadPlugin, TheExampleAddsOneOfEverything) {
  loadPlugin(GLINT_EXAMPLE_PLUGIN);
  EXPECT_THAT(loadedPlugins()[0].added,
              UnorderedElementsAre("model flat-mirror", "lobe student-t", "surface superellipsoid", "reader camera-table"));
  EXPECT_NE(findModel("flat-mirror"), nullptr);
  EXPECT_NE(addedShapeKind("superellipsoid"), nullptr);
  EXPECT_NE(captureReaderNamed("camera-table"), nullptr);
}

// A session or scene cannot say which plugin it was made with: the refusal of what it brought says how plugins are given.
TEST(LoadPlugin, WithoutItWhatItAddsIsRefusedByNameAndWithTheFlag) {
  const auto needsPlugin = [](const std::string& name) { return AllOf(HasSubstr("'" + name + "'"), HasSubstr("--plugin FILE")); };
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "scene.json";
  std::ofstream(file)
      << R"({"glint_scene": 1, "surfaces": {"s": {"analytic": {"type": "superellipsoid", "a": 1, "b": 1, "c": 1}}},
    "camera": {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 31.5, "cy": 23.5},
    "frames": [{"id": "0", "surface": "s", "camera_from_world": [[1,0,0,0],[0,1,0,0],[0,0,1,5],[0,0,0,1]]}]})";
  const fs::path sessionFile = fs::path(GLINT_SOURCE_DIR) / "sessions/lessons/plane/plane.glint";
  std::string session = testing_support::contentOf(sessionFile);
  const std::string automatic = R"("fit.lobe": "auto")";
  ASSERT_NE(session.find(automatic), std::string::npos);
  session.replace(session.find(automatic), automatic.size(), R"("fit.lobe": "student-t")");
  ReadOptions reader;
  reader.choices.as = "camera-table";
  EXPECT_THAT(inputErrorOf([] { modelByName("flat-mirror"); }), needsPlugin("flat-mirror"));
  EXPECT_THAT(inputErrorOf([] { Settings().setFromText("fit.lobe", "student-t"); }), needsPlugin("student-t"));
  EXPECT_THAT(inputErrorOf([&] { parseSession(session, sessionFile); }),
              AllOf(HasSubstr("plane.glint"), needsPlugin("student-t")));
  EXPECT_THAT(inputErrorOf([&] { readScene(file); }), AllOf(HasSubstr("scene.json"), needsPlugin("superellipsoid")));
  EXPECT_THAT(inputErrorOf([&] { readScene(file, reader); }), AllOf(HasSubstr("camera-table"), HasSubstr("--plugin FILE")));
  // No plugin adds a value to other settings.
  EXPECT_THAT(inputErrorOf([] { Settings().setFromText("fit.solver", "student-t"); }), testing::Not(HasSubstr("--plugin")));
  loadPlugin(GLINT_EXAMPLE_PLUGIN);
  EXPECT_EQ(modelByName("flat-mirror").id(), "flat-mirror");
  EXPECT_EQ(parseSession(session, sessionFile).request.settings.text("fit.lobe"), "student-t");
  EXPECT_EQ(readScene(file).frames.size(), 1u);
}

TEST(LoadPlugin, RefusesAnOtherInterfaceByItsVersion) {
  EXPECT_THAT(refusalOf(built("interface")),
              AllOf(HasSubstr("interface.so"), HasSubstr("version -1 of Glint's plugin interface")));
}
TEST(LoadPlugin, RefusesALaterInterfaceToo) {
  EXPECT_THAT(refusalOf(built("later-interface")),
              AllOf(HasSubstr("later-interface.so"), HasSubstr("of Glint's plugin interface")));
}
TEST(LoadPlugin, RefusesOtherHeadersByName) {
  EXPECT_THAT(refusalOf(built("headers")), AllOf(HasSubstr("plugin 'tried'"), HasSubstr("headers of Glint 0.0.9")));
}
TEST(LoadPlugin, RefusesOtherVectors) { EXPECT_THAT(refusalOf(built("alignment")), HasSubstr("-march=native")); }
TEST(LoadPlugin, RefusesOneWithoutAName) { EXPECT_THAT(refusalOf(built("nameless")), HasSubstr("is incomplete")); }
TEST(LoadPlugin, RefusesALobeWithAWrongDerivative) {
  EXPECT_THAT(refusalOf(built("lobe-derivative")),
              AllOf(HasSubstr("plugin 'tried'"), HasSubstr("lobe wrong: the derivative of log D by m")));
}
TEST(LoadPlugin, RefusesALobeThatRises) { EXPECT_THAT(refusalOf(built("lobe-rises")), HasSubstr("lobe rising: log D rises")); }
TEST(LoadPlugin, RefusesTheSameModelTwice) {
  EXPECT_THAT(refusalOf(built("model-twice")), HasSubstr("adds model flat-mirror twice"));
}
TEST(LoadPlugin, RefusesAWrongRange) { EXPECT_THAT(refusalOf(built("shape-range")), HasSubstr("range or default of 'a'")); }
TEST(LoadPlugin, RefusesATakenReader) { EXPECT_THAT(refusalOf(built("reader-taken")), HasSubstr("'colmap' is taken")); }
TEST(LoadPlugin, RefusesOneThatThrows) { EXPECT_THAT(refusalOf(built("throws")), HasSubstr("is refused: no luck today")); }
TEST(LoadPlugin, RefusesALibraryThatIsNoPlugin) {
  EXPECT_THAT(refusalOf(built("no-declaration")), HasSubstr("is no plugin of Glint"));
}
TEST(LoadPlugin, RefusesWhatIsNoLibrary) {
  const fs::path file = fs::path(testing::TempDir()) / "text.so";
  std::ofstream(file) << "hello";
  EXPECT_THAT(refusalOf(file), AllOf(HasSubstr("text.so"), HasSubstr("cannot be loaded")));
  EXPECT_THAT(refusalOf(file.parent_path() / "none-there.so"), HasSubstr("no such file"));
}

TEST(LoadPlugins, FromAFolderAWrongOneIsLeftOutWithItsName) {
  const fs::path folder = fs::path(testing::TempDir()) / "glint_plugin_folder";
  fs::create_directories(folder);
  for (const char* name : {"none", "interface"})
    fs::copy_file(built(name), folder / (std::string(name) + ".so"), fs::copy_options::overwrite_existing);
  ::setenv("GLINT_PLUGIN_PATH", folder.c_str(), 1);
  EXPECT_THAT(loadPlugins({}), testing::ElementsAre(HasSubstr("interface.so")));
  EXPECT_EQ(loadedPlugins().size(), 1u);
  fs::remove_all(folder);
}

TEST(LoadPlugins, NoFileThatEveryUserCanWriteTo) {
  const fs::path folder = fs::path(testing::TempDir()) / "glint_open_file";
  fs::create_directories(folder);
  fs::copy_file(built("none"), folder / "none.so", fs::copy_options::overwrite_existing);
  fs::permissions(folder / "none.so", fs::perms::others_write, fs::perm_options::add);
  ::setenv("GLINT_PLUGIN_PATH", folder.c_str(), 1);
  EXPECT_THAT(loadPlugins({}), testing::ElementsAre(AllOf(HasSubstr("none.so"), HasSubstr("every user can write to it"))));
  EXPECT_TRUE(loadedPlugins().empty());
  fs::remove_all(folder);
}

TEST(LoadPlugins, NothingFromAFolderThatEveryUserCanWriteTo) {
  const fs::path folder = fs::path(testing::TempDir()) / "glint_open_folder";
  fs::create_directories(folder);
  fs::copy_file(built("none"), folder / "none.so", fs::copy_options::overwrite_existing);
  fs::permissions(folder, fs::perms::others_write, fs::perm_options::add);
  ::setenv("GLINT_PLUGIN_PATH", folder.c_str(), 1);
  EXPECT_THAT(loadPlugins({}), testing::ElementsAre(HasSubstr("every user can write to it")));
  EXPECT_TRUE(loadedPlugins().empty());
  fs::remove_all(folder);
}

}  // namespace
}  // namespace glint::plugin_tests

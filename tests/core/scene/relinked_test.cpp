// SPDX-License-Identifier: BSD-3-Clause
// Meshes that are not where the scene says: named, and found where the caller says.
#include "core/scene/relinked.h"

#include <gmock/gmock.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "core/app/session.h"
#include "core/base/permitted.h"
#include "core/scene/scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
namespace fs = std::filesystem;

/// Four surfaces; two of them share a mesh. Reading a scene does not look into its meshes.
std::string scene(const std::string& shared = "m/a.ply", const std::string& other = "m/b.ply") {
  return with(with(minimalScene(), R"({"ball": {"analytic": {"type": "sphere", "radius": 0.4}}})",
                   R"({"a": {"mesh": ")" + shared + R"("}, "a2": {"mesh": ")" + shared + R"("}, "b": {"mesh": ")" + other +
                       R"("}, "ball": {"analytic": {"type": "sphere", "radius": 0.4}}})"),
              R"({"id": "a", )", R"({"id": "a", "surface": "a", )");
}

MissingMesh missingIn(const std::function<void()>& action) {
  try {
    action();
  } catch (const MissingMesh& e) {
    return e;
  }
  ADD_FAILURE() << "nothing is missing";
  return {"", "", "", ""};
}

TEST(FolderOfMove, IsWhatIsNotSharedAtTheEnd) {
  EXPECT_EQ(folderOfMove("/a/m/x.ply", "/b/m/x.ply"), "/b");
  EXPECT_EQ(folderOfMove("/a/m/x.ply", "/b/x.ply"), "/b");
  EXPECT_EQ(folderOfMove("/a/m/x.ply", "/b/m/y.ply"), "/b/m") << "another name: its own folder";
  EXPECT_EQ(folderOfMove("/m/x.ply", "/a/m/x.ply"), "/a");
  EXPECT_EQ(folderOfMove("/a/m/x.ply", "/m/x.ply"), "/");
  EXPECT_EQ(folderOfMove("/a/./m/x.ply", "/b/c/../m/x.ply"), "/b");
}

TEST(SameUnder, IsFoundAgainFromTheFolderOfItsMove) {
  const TemporaryFolder folder;
  for (const char* now : {"b/m/x.ply", "x.ply", "deep/er/m/x.ply"}) {
    const fs::path file = folder.write(now, "x");
    EXPECT_EQ(sameUnder(folderOfMove("/a/m/x.ply", file), "/a/m/x.ply"), file) << now;
  }
}

TEST(MissingMesh, NamesFilePlaceAndPath) {
  const TemporaryFolder folder;
  folder.write("m/a.ply", "x");
  const fs::path file = folder.write("scene.json", scene());
  const MissingMesh e = missingIn([&] { readScene(file); });
  EXPECT_EQ(e.named(), "m/b.ply");
  EXPECT_EQ(e.mesh(), folder / "m/b.ply");
  EXPECT_EQ(e.file(), file);
  EXPECT_EQ(e.place(), "surfaces.b.mesh");
  EXPECT_EQ(e.what(), file.string() + ": surfaces.b.mesh: file '" + (folder / "m/b.ply").string() + "' does not exist");
  // A folder of that name is no mesh.
  fs::create_directories(folder / "m/b.ply");
  EXPECT_EQ(missingIn([&] { readScene(file); }).named(), "m/b.ply");
}

TEST(RelinkedMeshes, AFileTakesThePlaceOfEverySurfaceThatNamesIt) {
  const TemporaryFolder folder, other;
  folder.write("m/b.ply", "x");
  const fs::path file = folder.write("scene.json", scene()), now = other.write("renamed.ply", "x");
  ReadOptions options;
  options.meshes["m/a.ply"] = now;
  const Scene read = readScene(file, options);
  EXPECT_EQ(read.surfaces.at("a").file()->file, now);
  EXPECT_EQ(read.surfaces.at("a2").file()->file, now);
  EXPECT_EQ(read.surfaces.at("b").file()->file, folder / "m/b.ply");
  EXPECT_THAT(read.meshes, ElementsAre(Pair("m/a.ply", now)));
  EXPECT_THAT(read.warnings, IsEmpty());
  // Written again, the scene names the file where it is; what reads it needs to be told nothing.
  writeScene(read, folder / "again.json");
  ReadOptions outside;
  outside.allowOutsidePaths = true;
  const Scene again = readScene(folder / "again.json", outside);
  EXPECT_EQ(again.surfaces.at("a2").file()->file, now);
  EXPECT_THAT(again.meshes, IsEmpty());
}

TEST(RelinkedMeshes, AFolderServesThoseThatAreNotInTheirPlace) {
  const TemporaryFolder folder, first, second;
  const fs::path file = folder.write("scene.json", scene());
  folder.write("m/a.ply", "x");
  first.write("a.ply", "old");  // must not take the place of the one that is there
  second.write("b.ply", "x");
  const fs::path longest = second.write("m/b.ply", "x");
  ReadOptions options;
  options.meshFolders = {first.path()};
  EXPECT_EQ(missingIn([&] { readScene(file, options); }).mesh(), folder / "m/b.ply");
  options.meshFolders.push_back(second.path());
  const Scene read = readScene(file, options);
  EXPECT_EQ(read.surfaces.at("a").file()->file, folder / "m/a.ply");
  EXPECT_EQ(read.surfaces.at("b").file()->file, longest);
  EXPECT_THAT(read.meshes, ElementsAre(Pair("m/b.ply", longest)));
}

TEST(RelinkedMeshes, WhereAFileWasGivenNoOtherIsTaken) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("scene.json", scene());
  folder.write("m/a.ply", "x");
  folder.write("m/b.ply", "x");
  ReadOptions options;
  options.meshes["m/a.ply"] = folder / "gone.ply";
  const MissingMesh e = missingIn([&] { readScene(file, options); });
  EXPECT_EQ(e.named(), "m/a.ply");
  EXPECT_EQ(e.mesh(), folder / "gone.ply");
  options.meshes = {{"m/c.ply", folder / "m/a.ply"}};
  EXPECT_THAT(readScene(file, options).warnings, ElementsAre(HasSubstr("'m/c.ply'")));
}

/// A session whose reader has said yes to what lies outside of its folders.
Session permitted(const fs::path& file) {
  Session session = readSession(file);
  session.allowOutsidePaths = true;
  return session;
}

ReadOptions allowingOutside() {
  ReadOptions options;
  options.allowOutsidePaths = true;
  return options;
}

TEST(RelinkedMeshes, AreKeptByASessionRelativeToItself) {
  const TemporaryFolder folder, moved;
  folder.write("data/m/b.ply", "x");
  folder.write("else/a2.ply", "x");
  Session session;
  session.input = folder.write("data/scene.json", scene());
  session.meshes["m/a.ply"] = folder / "else/a2.ply";
  fs::create_directories(folder / "sessions");
  writeSession(session, folder / "sessions/x.glint");
  const std::string text = contentOf(folder / "sessions/x.glint");
  EXPECT_THAT(text, HasSubstr("\"m/a.ply\": \"../else/a2.ply\""));
  fs::copy(folder.path(), moved.path(), fs::copy_options::recursive);
  fs::remove_all(folder / "else");
  const fs::path now = moved / "else/a2.ply";
  EXPECT_THROW(openSession(moved / "sessions/x.glint"), OutsidePath) << "outside of the folders of the session and its scene";
  const OpenedSession opened = openSession(permitted(moved / "sessions/x.glint"));
  EXPECT_EQ(opened.scene->surfaces.at("a").file()->file, now);
  EXPECT_THAT(opened.session.meshes, ElementsAre(Pair("m/a.ply", now)));
  EXPECT_EQ(opened.warning, "");
  EXPECT_EQ(readScene(moved / "sessions/x.glint", allowingOutside()).surfaces.at("a2").file()->file, now)
      << "a session is an input like a scene";
  // Gone again, it is asked for again, and what is given now counts.
  EXPECT_EQ(missingIn([&] { openSession(permitted(folder / "sessions/x.glint")); }).mesh(), folder / "else/a2.ply");
  Relinked instead;
  instead.meshes["m/a.ply"] = now;
  EXPECT_EQ(openSession(folder / "sessions/x.glint", instead).scene->surfaces.at("a").file()->file, now);
}

TEST(RelinkedMeshes, AnotherFileThanTheSessionWasMadeWithIsTold) {
  const TemporaryFolder folder, other;
  folder.write("m/a.ply", "the mesh");
  folder.write("m/b.ply", "b");
  Session session;
  session.input = folder.write("scene.json", scene());
  session.files = hashInputs(readScene(session.input), {});
  ASSERT_EQ(session.files.size(), 3u);
  writeSession(session, folder / "x.glint");
  Relinked same, different;
  same.meshes["m/a.ply"] = other.write("same.ply", "the mesh");
  different.meshes["m/a.ply"] = other.write("different.ply", "another");
  for (const bool sceneToo : {false, true}) {
    fs::remove(folder / "m/a.ply");
    if (sceneToo) {  // its meshes are then looked for beside it, and known by where they were
      fs::rename(folder / "scene.json", other / "scene.json");
      other.write("m/b.ply", "b");
      same.scene = different.scene = other / "scene.json";
    }
    const OpenedSession found = openSession(folder / "x.glint", same);
    EXPECT_EQ(found.warning, "") << sceneToo;
    EXPECT_THAT(changedFiles(found.session), IsEmpty()) << "where it was is not missed any more";
    EXPECT_EQ(found.session.files.size(), sceneToo ? 0u : 2u);
    EXPECT_EQ(openSession(folder / "x.glint", different).warning,
              (other / "different.ply").string() + " differs from the mesh that the session was made with")
        << sceneToo;
  }
}

TEST(RelinkedFrameFiles, AreKeptWhileTheirFolderIsNotToBeHad) {
  const TemporaryFolder folder;
  Session session;
  session.input = folder.write("scene.json", minimalScene());
  session.folders = {{FrameFile::Photograph, folder / "disk"}};
  writeSession(session, folder / "x.glint");
  EXPECT_EQ(openSession(folder / "x.glint").scene->folders, session.folders);
  EXPECT_EQ(readScene(folder / "x.glint").folders, session.folders);
}

TEST(RelinkedFrameFiles, OfEveryKindAreKeptRelativeToTheSession) {
  const TemporaryFolder folder, moved;
  nlohmann::json json = nlohmann::json::parse(minimalScene());
  for (const char* key : {"image", "depth", "normals", "mask"}) json["frames"][0][key] = std::string(key) + "s/0.png";
  Session session;
  session.input = folder.write("data/scene.json", json.dump());
  for (const char* name : {"a/depths/0.png", "a/masks/0.png", "b/0.png", "c/0.png"}) folder.write(name, "x");
  session.folders = {{FrameFile::Mask, folder / "a"},
                     {FrameFile::Depth, folder / "a"},
                     {FrameFile::Normals, folder / "b"},
                     {FrameFile::Photograph, folder / "gone"},
                     {FrameFile::Photograph, folder / "c"}};
  fs::create_directories(folder / "sessions");
  writeSession(session, folder / "sessions/x.glint");
  EXPECT_THAT(contentOf(folder / "sessions/x.glint"), HasSubstr("\"folder\": \"../a\""));
  fs::copy(folder.path(), moved.path(), fs::copy_options::recursive);
  fs::remove_all(folder.path());
  EXPECT_THROW(openSession(moved / "sessions/x.glint"), OutsidePath);
  const OpenedSession opened = openSession(permitted(moved / "sessions/x.glint"));
  for (const Scene& scene : {*opened.scene, readScene(moved / "sessions/x.glint", allowingOutside())}) {
    const Frame& f = scene.frames[0];
    EXPECT_EQ(f.image, moved / "c/0.png");
    EXPECT_EQ(f.depth, moved / "a/depths/0.png");
    EXPECT_EQ(f.normals, moved / "b/0.png");
    EXPECT_EQ(f.mask, moved / "a/masks/0.png");
    EXPECT_EQ(scene.folders.size(), 5u);
  }
}

TEST(RelinkedFrameFiles, TheOneFolderOfAnOlderSessionIsTheFirst) {
  const TemporaryFolder folder;
  folder.write("scene.json", minimalScene());
  const std::string rest = "\"request\": {\"models\": [], \"train\": \"0\"}}";
  const fs::path old =
      folder.write("old.glint", "{\"glint_session\": 2, \"input\": {\"path\": \"scene.json\", \"photographs\": \"p\"}, " + rest);
  const std::vector<FilesFolder> one{{FrameFile::Photograph, folder / "p"}};
  EXPECT_EQ(readSession(old).folders, one);
  EXPECT_EQ(readScene(old).folders, one);
  writeSession(readSession(old), folder / "new.glint");
  EXPECT_EQ(readSession(folder / "new.glint").folders, one);
  EXPECT_EQ(contentOf(folder / "new.glint").find("\"photographs\":"), std::string::npos);
  const fs::path wrong = folder.write("wrong.glint",
                                      "{\"glint_session\": 3, \"input\": {\"path\": \"scene.json\", \"folders\": [{\"of\": "
                                      "\"mask\", \"folder\": \"p\"}]}, " +
                                          rest);
  EXPECT_THAT(inputErrorOf([&] { readSession(wrong); }), HasSubstr("input.folders[0].of: 'mask' is not one of"));
}

}  // namespace
}  // namespace glint

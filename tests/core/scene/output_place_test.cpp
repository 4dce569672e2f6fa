// SPDX-License-Identifier: BSD-3-Clause
// What others put where a program is going to write, between its check and its write.
#include "core/base/output_place.h"

#include <gmock/gmock.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "core/base/atomic_file.h"
#include "core/scene/outputs.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::contentOf;
using testing_support::inputErrorOf;
using testing_support::TemporaryFolder;

constexpr const char* kPrecious = "precious";
const char* const kOurs = R"({"glint_report": 1})";

/// A folder of several users, and a file that does not concern the program.
struct SharedFolder : TemporaryFolder {
  SharedFolder() {
    fs::create_directories(*this / "shared");
    write("victim/0000.png", kPrecious);
    write("victim/victim.txt", kPrecious);
  }
  fs::path out(const char* name = "o.json") const { return *this / "shared" / name; }
  fs::path victim() const { return *this / "victim/victim.txt"; }
  void expectVictimsAsTheyWere() const {
    EXPECT_EQ(contentOf(victim()), kPrecious);
    EXPECT_EQ(contentOf(*this / "victim/0000.png"), kPrecious);
    EXPECT_EQ(std::distance(fs::directory_iterator(*this / "victim"), fs::directory_iterator()), 2);
  }
};

void check(const fs::path& file) {
  Outputs(std::vector<fs::path>{}).file(file.string(), "--json", OutputKind::document("glint_report"));
}

TEST(OutputPlace, ALinkThatAppearsAfterTheCheckIsNotFollowed) {
  const SharedFolder folder;
  check(folder.out());
  fs::create_symlink("../victim/victim.txt", folder.out());
  EXPECT_THAT(inputErrorOf([&] { atomicWrite(folder.out(), kOurs); }),
              HasSubstr("o.json: leads elsewhere than when the command began: a link was put there"));
  folder.expectVictimsAsTheyWere();
  EXPECT_TRUE(fs::is_symlink(folder.out()));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "shared"), fs::directory_iterator()), 1) << "no temporary file stays";
}

TEST(OutputPlace, ALinkToADeviceIsNotFollowedEither) {
  const SharedFolder folder;
  check(folder.out());
  fs::create_symlink("/dev/null", folder.out());
  EXPECT_NE(inputErrorOf([&] { atomicWrite(folder.out(), kOurs); }), "");
}

TEST(OutputPlace, AFolderOnTheWayThatBecomesALinkIsNotFollowed) {
  const SharedFolder folder;
  check(folder.out());
  fs::rename(folder / "shared", folder / "aside");
  fs::create_directory_symlink("victim", folder / "shared");
  EXPECT_NE(inputErrorOf([&] { atomicWrite(folder.out(), kOurs); }), "");
  folder.expectVictimsAsTheyWere();
}

TEST(OutputPlace, AFileOfAnotherKindThatAppearsIsNotReplacedAndOneOfTheSameKindIs) {
  const SharedFolder folder;
  check(folder.out());
  folder.write("shared/o.json", kPrecious);
  EXPECT_THAT(inputErrorOf([&] { atomicWrite(folder.out(), kOurs); }), HasSubstr("nothing is overwritten"));
  EXPECT_EQ(contentOf(folder.out()), kPrecious);
  folder.write("shared/o.json", R"({"glint_report": 1, "by": "another run"})");
  atomicWrite(folder.out(), kOurs);
  EXPECT_EQ(contentOf(folder.out()), kOurs);
  // What was expected of the first write is not expected of a later one, which nobody checked.
  folder.write("shared/o.json", kPrecious);
  EXPECT_NO_THROW(atomicWrite(folder.out(), kOurs));
}

TEST(OutputPlace, ThePersonsOwnLinkIsFollowed) {
  const SharedFolder folder;
  folder.write("mine/real.json", kOurs);
  fs::create_symlink("../mine/real.json", folder.out());
  check(folder.out());
  atomicWrite(folder.out(), R"({"glint_report": 1, "new": true})");
  EXPECT_TRUE(fs::is_symlink(folder.out()));
  EXPECT_THAT(contentOf(folder / "mine/real.json"), HasSubstr("new"));
}

TEST(OutputPlace, FoldersOfPicturesKeepOutOfLinksToo) {
  const auto pictures = [](const fs::path& to) {
    std::ofstream(to / "0000.png") << "new";
    std::ofstream(to / "list.json") << R"({"glint_detection": 1})";
  };
  const auto check = [](const fs::path& to) {
    Outputs(std::vector<fs::path>{}).inFolder(to.string(), "--out", {"0000.png", "list.json"}, "list.json", "glint_detection");
  };
  for (const bool isThere : {false, true}) {
    SCOPED_TRACE(isThere);
    const SharedFolder folder;
    if (isThere) folder.write("shared/out/other.txt", "other");
    check(folder.out("out"));
    if (isThere) fs::rename(folder.out("out"), folder / "aside");
    fs::create_directory_symlink("../victim", folder.out("out"));
    EXPECT_THAT(inputErrorOf([&] { atomicFiles(folder.out("out"), "list.json", pictures); }), HasSubstr("a link was put there"));
    folder.expectVictimsAsTheyWere();
  }
  // Somebody's picture of the same name appears in it.
  const SharedFolder folder;
  folder.write("shared/out/other.txt", "other");
  check(folder.out("out"));
  folder.write("shared/out/0000.png", kPrecious);
  EXPECT_THAT(inputErrorOf([&] { atomicFiles(folder.out("out"), "list.json", pictures); }), HasSubstr("nothing is overwritten"));
  EXPECT_EQ(contentOf(folder / "shared/out/0000.png"), kPrecious);
}

/// Links come and go while files are written: whatever moment they hit, what they point to stays.
TEST(OutputPlace, RacingLinksReachNoVictim) {
  const SharedFolder folder;
  constexpr int kFiles = 300;
  const auto file = [&](int i) { return folder.out(("o" + std::to_string(i) + ".json").c_str()); };
  for (int i = 0; i < kFiles; ++i) check(file(i));
  std::atomic<int> now{0};
  std::thread attacker([&] {
    std::error_code ignored;
    for (int i = now; i < kFiles; i = now) {
      fs::create_symlink("../victim/victim.txt", file(i), ignored);
      std::this_thread::yield();
      if (fs::is_symlink(file(i), ignored)) fs::remove(file(i), ignored);
    }
  });
  int written = 0, refused = 0;
  for (; now < kFiles; ++now) try {
      atomicWrite(file(now), kOurs);
      ++written;
    } catch (const InputError&) {
      ++refused;
    }
  attacker.join();
  folder.expectVictimsAsTheyWere();
  EXPECT_EQ(written + refused, kFiles);
}

}  // namespace
}  // namespace glint

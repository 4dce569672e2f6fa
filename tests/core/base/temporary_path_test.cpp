// SPDX-License-Identifier: BSD-3-Clause
// What a killed program leaves goes with the next write; what is anyone else's stays.
#include "core/base/temporary_path.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "core/base/atomic_file.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::TemporaryFolder;

std::vector<std::string> namesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// A process that begins two writes and dies.
void leaveBehind(const fs::path& folder) {
  const pid_t pid = ::fork();
  if (pid == 0) {
    const TemporaryPath file(folder, folder / "run.glint", TemporaryPath::Kind::File);
    const TemporaryPath unfinished(folder, folder / "labels", TemporaryPath::Kind::Folder);
    std::ofstream(unfinished.path() / "half.txt") << "half";
    ::_exit(0);  // no destructor
  }
  ::waitpid(pid, nullptr, 0);
}

TEST(TemporaryPath, LiesBesideTheTargetAndGoesWithItsWriter) {
  const TemporaryFolder folder;
  {
    const TemporaryPath one(folder.path(), folder / "picture.png", TemporaryPath::Kind::File);
    EXPECT_EQ(one.path().parent_path(), folder.path());
    EXPECT_EQ(one.path().extension(), ".png");  // encoders look at it
    EXPECT_EQ(one.path().filename().string()[0], '.');
    const TemporaryPath two(folder.path(), folder / "picture.png", TemporaryPath::Kind::File);
    EXPECT_NE(one.path(), two.path());
    removeAbandonedTemporaries(folder.path());
    EXPECT_EQ(namesIn(folder.path()).size(), 2u) << "a living writer's files stay";
  }
  EXPECT_THAT(namesIn(folder.path()), IsEmpty());
}

TEST(TemporaryPath, OfADeadProgramIsRemoved) {
  const TemporaryFolder folder;
  leaveBehind(folder.path());
  ASSERT_EQ(namesIn(folder.path()).size(), 2u);
  atomicWrite(folder / "another.txt", "x");
  EXPECT_THAT(namesIn(folder.path()), ElementsAre("another.txt"));
}

TEST(TemporaryPath, WhatIsNotAbandonedStays) {
  const TemporaryFolder folder;
  const std::vector<std::string> users = {".run.1-2.tmp.glint",  ".run.glint-1-2.tmp.a.b", ".run.glint-1.tmp",
                                          ".run.glint-1-2.tmpx", ".run.glint-a-2.tmp",     "run.glint-1-2.tmp",
                                          ".run.glint-1-2.TMP"};
  for (const std::string& name : users) folder.write(name, "mine");
  fs::create_directory(folder / "elsewhere");
  folder.write("elsewhere/kept.txt", "mine");
  fs::create_directory_symlink(folder / "elsewhere", folder / ".run.glint-1-3.tmp");  // what a link points to is not ours
  const fs::path locked = folder.write(".run.glint-1-4.tmp.glint", "half");
  const int fd = ::open(locked.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(::flock(fd, LOCK_EX), 0);
  const std::vector<std::string> before = namesIn(folder.path());
  removeAbandonedTemporaries(folder.path());
  EXPECT_EQ(namesIn(folder.path()), before);
  EXPECT_TRUE(fs::exists(folder / "elsewhere/kept.txt"));
  ::close(fd);
  removeAbandonedTemporaries(folder.path());
  EXPECT_FALSE(fs::exists(locked)) << "nobody holds it any more";
}

/// A program that is asked to stop while its threads go on writing into a folder that is not finished. Several times: it depends
/// on the moment.
TEST(TemporaryPath, NothingIsLeftBehindThreadsThatGoOnWriting) {
  const TemporaryFolder folder;
  for (int i = 0; i < 20; ++i) {
    const pid_t pid = ::fork();
    if (pid == 0) {
      const TemporaryPath unfinished(folder.path(), folder / "made", TemporaryPath::Kind::Folder);
      std::atomic<int> written{0};
      std::vector<std::thread> threads;
      for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
          for (int n = 0;; ++n, ++written) {
            std::ofstream(unfinished.path() / (std::to_string(t) + "-" + std::to_string(n))) << "half";
            std::this_thread::sleep_for(
                std::chrono::microseconds(500));  // far from the number of files that are too many to remove
          }
        });
      while (written < 50) std::this_thread::yield();
      removeUnfinishedWrites();
      ::_exit(0);
    }
    ::waitpid(pid, nullptr, 0);
    ASSERT_THAT(namesIn(folder.path()), IsEmpty()) << i;
  }
}

TEST(TemporaryPath, LongNamesOfTargetsLeaveRoomForItsOwn) {
  const TemporaryFolder folder;
  const std::string name(251, 'n');  // with its ending the longest that file systems take
  atomicWrite(folder / (name + ".txt"), "x");
  EXPECT_THAT(namesIn(folder.path()), ElementsAre(name + ".txt"));
}

TEST(TemporaryPath, AFolderThatIsNotThereIsNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT(
      testing_support::inputErrorOf([&] { TemporaryPath(folder / "none", folder / "none/x.txt", TemporaryPath::Kind::File); }),
      testing::HasSubstr("none/x.txt: cannot be written: No such file"));
}

}  // namespace
}  // namespace glint

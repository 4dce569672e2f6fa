// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/atomic_file.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>

#include "core/scene/scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
namespace fs = std::filesystem;

int entries(const fs::path& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AtomicWrite, ReplacesTheContentAndLeavesNothingElse) {
  const TemporaryFolder folder;
  atomicWrite(folder / "x.txt", "one");
  atomicWrite(folder / "x.txt", "two");
  EXPECT_EQ(contentOf(folder / "x.txt"), "two");
  EXPECT_EQ(entries(folder.path()), 1);
}

/// Files larger than a few bytes cannot be written while this lives: what a full disk does, without needing one.
struct FullDisk {
  rlimit old{};
  void (*oldHandler)(int);
  explicit FullDisk(rlim_t bytes) : oldHandler(::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old);
    rlimit small = old;
    small.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &old);
    ::signal(SIGXFSZ, oldHandler);
  }
};

TEST(AtomicWrite, FullDiskKeepsTheOldFileAndLeavesNoTemporaryOne) {
  const TemporaryFolder folder;
  atomicWrite(folder / "x.txt", "old");
  std::string message;
  {
    const FullDisk disk(10);
    message = inputErrorOf([&] { atomicWrite(folder / "x.txt", std::string(100000, 'x')); });
  }
  EXPECT_THAT(message, HasSubstr((folder / "x.txt").string() + ": cannot be written: "));
  EXPECT_EQ(contentOf(folder / "x.txt"), "old");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(AtomicWrite, DeviceThatIsFullIsAnError) {
  EXPECT_THAT(inputErrorOf([&] { atomicWrite("/dev/full", "x"); }), HasSubstr("/dev/full: cannot be written: No space left"));
}

TEST(AtomicWrite, TargetsThatCannotBeFilesAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT(inputErrorOf([&] { atomicWrite(folder / "none/x.txt", "x"); }), HasSubstr("does not exist"));
  EXPECT_THAT(inputErrorOf([&] { atomicWrite(folder.path(), "x"); }), HasSubstr("it is a folder"));
  EXPECT_EQ(entries(folder.path()), 0);
}

TEST(AtomicWrite, EncoderThatFailsLeavesNothing) {
  const TemporaryFolder folder;
  EXPECT_THROW(atomicWrite(folder / "x.png",
                           [](const fs::path& p) {
                             std::ofstream(p) << "half";
                             throw std::runtime_error("stop");
                           }),
               std::runtime_error);
  EXPECT_EQ(entries(folder.path()), 0);
  EXPECT_THAT(inputErrorOf([&] { atomicWrite(folder / "x.png", [](const fs::path&) {}); }), HasSubstr("cannot be written"));
  atomicWrite(folder / "x.png", [](const fs::path& p) {
    EXPECT_EQ(p.extension(), ".png");  // encoders choose the format by it
    std::ofstream(p) << "whole";
  });
  EXPECT_EQ(contentOf(folder / "x.png"), "whole");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(WriteScene, FullDiskIsAnErrorWithTheFile) {
  const TemporaryFolder folder;
  const Scene scene = readScene(folder.write("scene.json", minimalScene()));
  std::string message;
  {
    const FullDisk disk(10);
    message = inputErrorOf([&] { writeScene(scene, folder / "out.json"); });
  }
  EXPECT_THAT(message, HasSubstr("out.json: cannot be written"));
  EXPECT_FALSE(fs::exists(folder / "out.json"));
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// A folder is there whole or not at all.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>
#include <stdexcept>

#include "core/base/atomic_file.h"
#include "core/base/outcome.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

class AtomicFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::path(testing::TempDir()) / "glint-atomic-XXXXXX").string();  // tests run beside each other
    parent_ = mkdtemp(pattern.data());
  }
  void TearDown() override { fs::remove_all(parent_); }
  static void twoFiles(const fs::path& to) {
    std::ofstream(to / "a.txt") << "a";
    fs::create_directories(to / "in");
    std::ofstream(to / "in" / "b.txt") << "b";
  }
  static int entries(const fs::path& folder) {
    return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }
  fs::path parent_;
};

TEST_F(AtomicFolder, HoldsWhatWasWrittenHoweverItIsNamed) {
  fs::create_directories(parent_ / "empty");
  for (const char* name : {"new", "slash/", "empty", "./dot/../plain"}) {
    SCOPED_TRACE(name);
    ASSERT_NO_THROW(atomicFolder(parent_ / name, twoFiles));
    EXPECT_TRUE(fs::exists(parent_ / name / "a.txt") || fs::exists(parent_ / "plain" / "a.txt"));
    EXPECT_TRUE(fs::exists(parent_ / name / "in" / "b.txt") || fs::exists(parent_ / "plain" / "in" / "b.txt"));
  }
  EXPECT_EQ(entries(parent_), 4) << "no temporary folder stays";
  EXPECT_EQ(entries(parent_ / "slash"), 2);
}

TEST_F(AtomicFolder, AWriterThatFailsLeavesWhatWasThere) {
  const auto fails = [](const fs::path& to) {
    twoFiles(to);
    throw std::runtime_error("disk full");
  };
  EXPECT_THROW(atomicFolder(parent_ / "new", fails), std::runtime_error);
  EXPECT_EQ(entries(parent_), 0);
  fs::create_directories(parent_ / "empty");
  EXPECT_THROW(atomicFolder(parent_ / "empty", fails), std::runtime_error);
  EXPECT_EQ(entries(parent_), 1);
  EXPECT_TRUE(fs::is_empty(parent_ / "empty"));
}

TEST_F(AtomicFolder, NeverOverwrites) {
  std::ofstream(parent_ / "file") << "mine";
  fs::create_directories(parent_ / "full");
  std::ofstream(parent_ / "full" / "mine.txt") << "mine";
  for (const char* name : {"file", "full"}) {
    bool written = false;
    EXPECT_THROW(atomicFolder(parent_ / name, [&](const fs::path&) { written = true; }), InputError) << name;
    EXPECT_FALSE(written) << name << ": refused before the work";
  }
  EXPECT_EQ(entries(parent_), 2);
  EXPECT_EQ(entries(parent_ / "full"), 1);
}

TEST_F(AtomicFolder, FilesBesideOthersAreNewOrOld) {
  fs::create_directories(parent_ / "full" / "in");
  std::ofstream(parent_ / "full" / "mine.txt") << "mine";
  std::ofstream(parent_ / "full" / "a.txt") << "old";
  std::ofstream(parent_ / "full" / "in" / "c.txt") << "mine";
  const auto read = [&](const char* name) {
    std::ifstream in(parent_ / "full" / name);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const auto fails = [&](const fs::path& to) {
    twoFiles(to);
    throw InputError((to / "in" / "b.txt").string(), "", "disk full");
  };
  try {
    atomicFiles(parent_ / "full", "a.txt", fails);
    ADD_FAILURE() << "nothing thrown";
  } catch (const InputError& e) {
    EXPECT_EQ(std::string(e.what()), (parent_ / "full/in/b.txt").string() + ": disk full") << "the name that it was to have";
  }
  EXPECT_EQ(read("a.txt"), "old");
  EXPECT_EQ(entries(parent_ / "full"), 3);
  atomicFiles(parent_ / "full", "a.txt", twoFiles);
  EXPECT_EQ(read("a.txt"), "a");
  EXPECT_EQ(read("in/b.txt"), "b");
  EXPECT_EQ(read("in/c.txt"), "mine");
  EXPECT_EQ(read("mine.txt"), "mine");
  EXPECT_EQ(entries(parent_ / "full"), 3) << "no temporary folder stays";
}

TEST_F(AtomicFolder, FilesOfANewFolderAppearWithIt) {
  const auto fails = [&](const fs::path& to) {
    twoFiles(to);
    throw std::runtime_error("disk full");
  };
  EXPECT_THROW(atomicFiles(parent_ / "deep/new", "a.txt", fails), std::runtime_error);
  EXPECT_EQ(entries(parent_), 0) << "the folders above it go too";
  fs::create_directories(parent_ / "empty");
  for (const char* name : {"deep/new", "empty"}) {
    atomicFiles(parent_ / name, "a.txt", [&](const fs::path& to) {
      twoFiles(to);
      EXPECT_EQ(fs::exists(parent_ / name / "a.txt"), false);
    });
    EXPECT_EQ(entries(parent_ / name), 2) << name;
  }
  EXPECT_EQ(entries(parent_), 2);
}

/// A shell may stand in it: a new folder in its place would leave the shell in one that is gone.
TEST_F(AtomicFolder, NothingIsWrittenThroughALinkInTheFolder) {
  fs::create_directories(parent_ / "taken");
  fs::create_directories(parent_ / "elsewhere");
  fs::create_directory_symlink(parent_ / "elsewhere", parent_ / "taken/frames");
  std::ofstream(parent_ / "taken/kept") << "kept";
  const auto write = [](const fs::path& to) {
    fs::create_directories(to / "frames");
    std::ofstream(to / "frames/0001.png") << "new";
  };
  for (const char* main : {"scene.json", "frames/0001.png"}) {
    EXPECT_THROW(atomicFiles(parent_ / "taken", main, write), InputError) << main;
    EXPECT_TRUE(fs::is_empty(parent_ / "elsewhere")) << main;
  }
}

TEST_F(AtomicFolder, TheCurrentFolderStaysTheSame) {
  const fs::path before = fs::current_path(), here = parent_ / "here";
  fs::create_directories(here);
  fs::current_path(here);
  atomicFiles(".", "a.txt", twoFiles);
  EXPECT_TRUE(fs::exists("a.txt"));
  fs::current_path(before);
}

}  // namespace
}  // namespace glint

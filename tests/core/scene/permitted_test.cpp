// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/permitted.h"

#include <gtest/gtest.h>

#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
namespace fs = std::filesystem;

TEST(Permitted, AFolderHoldsItselfAndWhatLiesInIt) {
  const TemporaryFolder folder;
  folder.write("in/a/file", "x");
  folder.write("inside-not/file", "x");
  const std::vector<fs::path> in{folder / "in"};
  EXPECT_TRUE(liesIn(in, folder / "in"));
  EXPECT_TRUE(liesIn(in, folder / "in/a/file"));
  EXPECT_TRUE(liesIn({folder / "in/"}, folder / "in/a/file"));
  EXPECT_TRUE(liesIn(in, folder / "in/there/is/none"));
  EXPECT_TRUE(liesIn(in, folder / "in/a/../a/file"));
  EXPECT_FALSE(liesIn(in, folder / "in/../inside-not/file"));
  EXPECT_FALSE(liesIn(in, folder / "inside-not/file")) << "a name that begins alike is another folder";
  EXPECT_FALSE(liesIn(in, folder.path()));
  EXPECT_FALSE(liesIn(in, "/etc/passwd"));
  EXPECT_FALSE(liesIn({}, folder / "in"));
}

TEST(Permitted, ALinkLeadsWhereItLeads) {
  const TemporaryFolder folder;
  folder.write("in/file", "x");
  folder.write("secret/file", "x");
  fs::create_symlink(folder / "secret", folder / "in/link");
  fs::create_symlink(folder / "secret/file", folder / "in/one");
  fs::create_symlink(folder / "in", folder / "other");
  const std::vector<fs::path> in{folder / "in"};
  EXPECT_FALSE(liesIn(in, folder / "in/link/file"));
  EXPECT_FALSE(liesIn(in, folder / "in/link/not-there"));
  EXPECT_FALSE(liesIn(in, folder / "in/one"));
  EXPECT_TRUE(liesIn(in, folder / "other/file"));
  EXPECT_TRUE(liesIn({folder / "other"}, folder / "in/file"));
  // A link in a circle leads nowhere, so nothing may be said of it.
  fs::create_symlink(folder / "in/circle", folder / "in/circle");
  EXPECT_FALSE(liesIn(in, folder / "in/circle"));
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "viz/offscreen.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/viz/test_display.h"
#include "viz/display_connection.h"
#include "viz/scene_view.h"

namespace glint::viz {
namespace {

bool xvfbInstalled() { return std::system("command -v Xvfb > /dev/null 2>&1") == 0; }

/// Running and not a zombie.
bool alive(int pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  if (!std::getline(status, text)) return false;
  const std::size_t end = text.rfind(')');
  return end != std::string::npos && text.size() > end + 2 && text[end + 2] != 'Z';
}

bool endsWithin(int pid, int milliseconds) {
  for (int waited = 0; waited < milliseconds; waited += 20) {
    if (!alive(pid)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return !alive(pid);
}

class WithoutXvfb : public testing::Test {
 protected:
  void SetUp() override { path_ = std::getenv("PATH"); }
  void TearDown() override { setenv("PATH", path_.c_str(), 1); }
  test::KeepsDisplay keeps_;
  std::string path_;
};

TEST(VirtualDisplay, LeavesNoProcessAndRestoresDisplay) {
  if (!xvfbInstalled()) GTEST_SKIP() << "Xvfb is not installed";
  const test::KeepsDisplay keeps;
  unsetenv("DISPLAY");
  int pid = -1;
  {
    Outcome<std::unique_ptr<VirtualDisplay>> display = VirtualDisplay::start(320, 200);
    ASSERT_TRUE(display) << display.failure().message();
    pid = (*display)->processId();
    EXPECT_TRUE(alive(pid));
    ASSERT_NE(std::getenv("DISPLAY"), nullptr);
    EXPECT_EQ(std::getenv("DISPLAY"), (*display)->name());
  }
  EXPECT_FALSE(alive(pid));
  EXPECT_EQ(std::getenv("DISPLAY"), nullptr);
  setenv("DISPLAY", ":4711", 1);
  { const Outcome<std::unique_ptr<VirtualDisplay>> display = VirtualDisplay::start(320, 200); }
  EXPECT_STREQ(std::getenv("DISPLAY"), ":4711");
}

TEST(VirtualDisplay, EndsWhenAnExceptionPasses) {
  if (!xvfbInstalled()) GTEST_SKIP() << "Xvfb is not installed";
  int pid = -1;
  try {
    const Outcome<std::unique_ptr<VirtualDisplay>> display = VirtualDisplay::start(320, 200);
    ASSERT_TRUE(display);
    pid = (*display)->processId();
    throw std::runtime_error("drawing failed");
  } catch (const std::runtime_error&) {
  }
  ASSERT_GT(pid, 0);
  EXPECT_FALSE(alive(pid));
}

/// A program that starts a display and is killed: the server must not outlive it, not even when SIGTERM was blocked.
class KilledBy : public testing::TestWithParam<int> {};

TEST_P(KilledBy, TheServerEndsWithTheProgram) {
  if (!xvfbInstalled()) GTEST_SKIP() << "Xvfb is not installed";
  int channel[2];
  ASSERT_EQ(pipe(channel), 0);
  const pid_t child = fork();
  if (child == 0) {
    sigset_t blocked;
    sigemptyset(&blocked);
    if (GetParam() == SIGKILL) sigaddset(&blocked, SIGTERM);
    sigprocmask(SIG_BLOCK, &blocked, nullptr);
    signal(GetParam(), SIG_DFL);  // a shell ignores SIGINT for what it starts in the background
    const Outcome<std::unique_ptr<VirtualDisplay>> display = VirtualDisplay::start(320, 200);
    const int pid = display ? (*display)->processId() : -1;
    if (write(channel[1], &pid, sizeof pid) != sizeof pid) _exit(1);
    for (;;) pause();
  }
  close(channel[1]);
  int server = -1;
  ASSERT_EQ(read(channel[0], &server, sizeof server), static_cast<ssize_t>(sizeof server));
  close(channel[0]);
  ASSERT_GT(server, 0);
  EXPECT_TRUE(alive(server));
  kill(child, GetParam());
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(endsWithin(server, 5000));
}
INSTANTIATE_TEST_SUITE_P(VirtualDisplay, KilledBy, testing::Values(SIGTERM, SIGINT, SIGKILL));

TEST_F(WithoutXvfb, SaysWhatToInstall) {
  setenv("PATH", "/nonexistent", 1);
  const Outcome<std::unique_ptr<VirtualDisplay>> display = VirtualDisplay::start(320, 200);
  ASSERT_FALSE(display);
  EXPECT_EQ(display.failure().reason, Reason::NotSupported);
  EXPECT_NE(display.failure().detail.find("apt-get install xvfb"), std::string::npos);
  unsetenv("DISPLAY");
  EXPECT_FALSE(Offscreen::create(320, 200));
}

/// VTK itself would abort at its first picture.
TEST_F(WithoutXvfb, ADisplayThatCannotBeOpenedIsNamed) {
  setenv("PATH", "/nonexistent", 1);
  setenv("DISPLAY", ":4711", 1);
  const Outcome<std::unique_ptr<Offscreen>> target = Offscreen::create(320, 200);
  ASSERT_FALSE(target);
  EXPECT_EQ(target.failure().reason, Reason::NotSupported);
  EXPECT_NE(target.failure().detail.find("':4711' cannot be opened"), std::string::npos) << target.failure().detail;
  EXPECT_NE(target.failure().detail.find("apt-get install xvfb"), std::string::npos) << target.failure().detail;
  EXPECT_FALSE(Offscreen::onOwnDisplay(320, 200));
  unsetenv("DISPLAY");
  EXPECT_FALSE(Offscreen::onOwnDisplay(320, 200));
}

TEST(DisplayConnection, OpensWhereAServerAnswers) {
  if (!xvfbInstalled()) GTEST_SKIP() << "Xvfb is not installed";
  const test::KeepsDisplay keeps;
  unsetenv("DISPLAY");
  EXPECT_FALSE(DisplayConnection::open());
  const Outcome<std::unique_ptr<VirtualDisplay>> server = VirtualDisplay::start(320, 200);
  ASSERT_TRUE(server) << server.failure().message();
  const Outcome<std::unique_ptr<DisplayConnection>> display = DisplayConnection::open();
  ASSERT_TRUE(display) << display.failure().message();
  EXPECT_TRUE((*display)->has("GLX"));
  EXPECT_FALSE((*display)->has("NO-SUCH-EXTENSION"));
}

TEST(Offscreen, BringsAServerOfItsOwn) {
  if (!xvfbInstalled()) GTEST_SKIP() << "Xvfb is not installed";
  const test::KeepsDisplay keeps;
  unsetenv("DISPLAY");
  {
    const Outcome<std::unique_ptr<Offscreen>> target = Offscreen::create(320, 200);
    ASSERT_TRUE(target) << target.failure().message();
    EXPECT_NE(std::getenv("DISPLAY"), nullptr);
    const Image image = (*target)->render(SceneView());
    EXPECT_EQ(image.width, 320);
    EXPECT_EQ(image.height, 200);
  }
  EXPECT_EQ(std::getenv("DISPLAY"), nullptr);
}

TEST(Offscreen, RefusesImpossibleSizes) {
  EXPECT_THROW((void)Offscreen::create(0, 100), std::invalid_argument);
  EXPECT_THROW((void)Offscreen::create(100, 100000), std::invalid_argument);
}

}  // namespace
}  // namespace glint::viz

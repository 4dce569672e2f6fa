// SPDX-License-Identifier: BSD-3-Clause
// Killed or asked to stop, at every call that writes and at random moments: every output is old, absent or complete, and the same
// command runs again and leaves nothing over. GLINT_KILLS is the number of random kills of the whole program, GLINT_SEED their
// seed (tests/run_kills); with fewer than a hundred only some of the calls are tried.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "tests/faults/workload.h"

namespace glint::faults {
namespace {

Piece* piece = nullptr;

int number(const char* variable, int standard) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : standard;
}
int randomKills() { return number("GLINT_KILLS", 10); }
bool all() { return randomKills() >= 100; }

std::vector<Workload> killed() {
  std::vector<Workload> chosen;
  for (Workload& w : workloads(all()))
    if (w.name != "convert" && w.name != "render" && w.name != "evaluate")
      chosen.push_back(std::move(w));  // one file, as reconstruct
  return chosen;
}

class Kills : public testing::TestWithParam<Workload> {
 protected:
  void check(Stage& stage, bool withOld, const ChildRun& run, const std::string& what, Tally& tally) {
    std::vector<std::string> problems;
    const Found found = stage.look(withOld, problems);
    const bool ended = !run.signalled;
    tally.add(std::string(ended ? "ended before it, " : "") + kFoundNames[int(found)]);
    if (ended && found != Found::Complete)
      problems.push_back("it ended with " + std::to_string(run.code) + " and is not complete: " + run.err);
    stage.again(problems);
    ++tally.runs;
    tally.problems += !problems.empty();
    for (const std::string& p : problems)
      ADD_FAILURE() << GetParam().name << " " << what << (withOld ? " (old files): " : ": ") << p;
  }
};

TEST_P(Kills, AtEveryCallThatWrites) {
  Stage stage(GetParam());
  ASSERT_FALSE(HasFailure());
  Tally tally;
  for (const Call call : {Call::Open, Call::Write, Call::Rename, Call::Sync, Call::Folder, Call::Unlink}) {
    const int count = stage.calls()[std::size_t(call)];
    const bool few = call == Call::Write || call == Call::Rename;
    const int step = all() ? 1 : few ? std::max(1, (count + 1) / 2) : std::max(1, count);  // 2 of these, 1 of the others
    for (int n = all() || few ? 1 : count; n >= 1 && n <= count; n += step) {
      const bool withOld = n % 2 == 0 && !GetParam().before.empty();
      const Fault fault{kCallNames[int(call)], "signal=" + std::to_string(SIGKILL), n};
      stage.prepare(withOld);
      check(stage, withOld, stage.run({.fault = fault, .cores = {oneCore()}}), fault.text(), tally);
    }
  }
  EXPECT_TRUE(stage.inputsUnchanged());
  piece->add(GetParam().name + ", at the calls that write", tally);
}

TEST_P(Kills, AtRandomMoments) {
  Stage stage(GetParam());
  ASSERT_FALSE(HasFailure());
  const int share = std::max(1, randomKills() / int(killed().size()));
  const int seed = number("GLINT_SEED", 1);
  std::mt19937 random(static_cast<unsigned>(seed) + static_cast<unsigned>(std::hash<std::string>()(GetParam().name)));
  Tally tally;
  for (int i = 0; i < share; ++i) {
    const double at = std::uniform_real_distribution<double>(0, 1.1 * stage.milliseconds())(random);
    const bool withOld = i % 2 == 1 && !GetParam().before.empty();
    stage.prepare(withOld);
    check(stage, withOld, stage.run({.killAfterMs = at}), "seed " + std::to_string(seed) + ", kill " + std::to_string(i), tally);
  }
  EXPECT_TRUE(stage.inputsUnchanged());
  piece->add(GetParam().name + ", at random moments", tally);
}

/// Ctrl-C and SIGTERM: 130, one line, at once clean. `signal`: the work goes on and notices; `stuck`: it never does. Before that
/// line may stand what the command says when nobody stops it: `lights` warns of its input.
TEST_P(Kills, AskedToStopAtEveryCall) {
  const std::string kStopped = "glint: stopped\n";
  if (GetParam().program != "glint") GTEST_SKIP() << "the window has a button for it";
  Stage stage(GetParam());
  ASSERT_FALSE(HasFailure());
  Tally tally;
  for (const Call call : {Call::Open, Call::Write, Call::Rename, Call::Sync}) {
    const int count = stage.calls()[std::size_t(call)];
    const int step = all() ? 1 : std::max(1, count);  // the last of each
    for (int n = all() ? 1 : count; n >= 1 && n <= count; n += step) {
      const bool withOld = n % 2 == 0 && !GetParam().before.empty();
      const int signal = n % 2 ? SIGINT : SIGTERM;
      for (const char* how : {"signal", "stuck"}) {
        // They take turns. Both at the last write: it is that of the process's end, which no longer works but may wait for a
        // reader.
        if (!all() && call != Call::Write && (int(call) % 2 == 0) == (how[1] == 'i')) continue;
        const Fault fault{kCallNames[int(call)], how + ("=" + std::to_string(signal)), n};
        stage.prepare(withOld);
        const ChildRun run = stage.run({.fault = fault, .cores = {oneCore()}});
        std::vector<std::string> problems;
        const Found found = stage.look(withOld, problems);
        if (run.injected != 1) problems.push_back("the signal was not sent");
        if (run.code != 130 || (run.err != kStopped && run.err != stage.said() + kStopped))
          problems.push_back("exit code " + std::to_string(run.code) + ", standard error: " + run.err);
        for (const std::string& l : stage.leftovers(true)) problems.push_back("it leaves " + l);
        ++tally.runs;
        tally.problems += !problems.empty();
        tally.add(kFoundNames[int(found)]);
        for (const std::string& p : problems)
          ADD_FAILURE() << GetParam().name << " " << fault.text() << (withOld ? " (old files): " : ": ") << p;
      }
    }
  }
  piece->add(GetParam().name + ", asked to stop at the calls that write", tally);
}

INSTANTIATE_TEST_SUITE_P(Commands, Kills, testing::ValuesIn(killed()), [](const auto& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

/// Nothing of the program has run yet; and a program that does nothing but start is stopped too.
TEST(StoppedEarly, BeforeTheFirstLineOfMain) {
  for (const char* command : {"reconstruct", "--version"})
    for (const int signal : {SIGINT, SIGTERM}) {
      const testing_support::TemporaryFolder folder;
      const ChildRun run =
          runChild({GLINT_PROGRAM, command}, folder.path(), {.fault = Fault{"main", "signal=" + std::to_string(signal), 0}});
      EXPECT_EQ(run.code, 130) << command << " " << signal;
      EXPECT_EQ(run.err, "glint: stopped\n") << command << " " << signal;
    }
}

/// The system gives no thread for the waiting: the program works, and a signal still ends it.
TEST(StoppedEarly, WithoutAThread) {
  const testing_support::TemporaryFolder folder;
  const ChildRun run = runChild({GLINT_PROGRAM, "--version"}, folder.path(), {.fault = Fault{"thread", "from=11", 1}});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.injected, 1);
}

/// A file of the user, one that a living program writes, and one that a dead one left, all beside the target.
TEST(Leftovers, OnlyThoseOfDeadProgramsGo) {
  Stage stage(workloads(true).front());
  stage.prepare(false);
  const ChildRun killed = stage.run({.fault = Fault{"rename", "signal=9", 1}, .cores = {oneCore()}});
  ASSERT_TRUE(killed.signalled);
  ASSERT_EQ(stage.leftovers().size(), 1u);
  const std::vector<std::string> users = {".run.tmp.glint", ".run.glint-notes.tmp", "run.glint-1-1.tmp.glint",
                                          ".run.glint-1-1.tmp.glint.keep"};
  for (const std::string& name : users) std::ofstream(stage.folder() / name) << "mine";
  const std::string living = ".run.glint-1-7.tmp.glint";  // locked by this process, which lives
  const int fd = ::open((stage.folder() / living).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(::flock(fd, LOCK_EX), 0);
  const ChildRun next = stage.run({});
  EXPECT_EQ(next.code, 0) << next.err;
  std::vector<std::string> left = stage.leftovers(), expected = users;
  expected.push_back(living);
  std::sort(left.begin(), left.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(left, expected);
  ::close(fd);
}

}  // namespace
}  // namespace glint::faults

int main(int argc, char** argv) {
  return glint::faults::runTests(argc, argv, glint::faults::piece, "Programs that are killed or asked to stop",
                                 "tests/run_kills");
}

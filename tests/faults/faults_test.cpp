// SPDX-License-Identifier: BSD-3-Clause
// Every call that writes, and every large allocation, fails once. Whatever fails: exit code 2 or 3 and one line, and every output
// is old, absent or complete. GLINT_FAULTS=all tries every call (tests/run_faults); otherwise a few of each kind, spread over the
// run.
#include <gmock/gmock.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "tests/faults/workload.h"

namespace glint::faults {
namespace {

Piece* piece = nullptr;

bool all() {
  const char* asked = std::getenv("GLINT_FAULTS");
  return asked && std::strcmp(asked, "all") == 0;
}

/// What one kind of call can answer when it fails.
struct Failing {
  const char* call;
  int inCi;  ///< how many calls of this kind fail where not all of them do
  std::vector<std::string> actions;
};
std::string error(const char* how, int number) { return std::string(how) + "=" + std::to_string(number); }
const std::vector<Failing>& failing() {
  static const std::vector<Failing> every = {{"open", 2, {error("errno", EROFS), error("from", EACCES)}},
                                             {"write", 3, {error("from", ENOSPC), error("errno", EIO), "short"}},
                                             {"rename", 2, {error("errno", EACCES), error("from", EROFS)}},
                                             {"sync", 1, {error("errno", EIO)}},
                                             {"folder", 1, {error("errno", ENOSPC)}},
                                             {"unlink", 1, {error("from", EACCES)}},
                                             {"memory", 1, {error("errno", ENOMEM)}},
                                             {"thread", 1, {error("from", EAGAIN)}}};
  return every;
}

/// n of 1 .. count: all of them, or at most `most`, spread, the last among them.
std::vector<int> chosen(int count, int most) {
  std::vector<int> numbers;
  if (all() || count <= most) {
    for (int n = 1; n <= count; ++n) numbers.push_back(n);
  } else {
    for (int i = 1; i <= most; ++i) numbers.push_back(std::max(1, count * i / most));
  }
  return numbers;
}

/// What every run must keep to, whatever failed in it.
std::vector<std::string> problemsOf(const Stage& stage, const ChildRun& run, Found found) {
  std::vector<std::string> problems;
  if (run.timedOut) problems.emplace_back("it hangs");
  if (run.signalled) problems.push_back("it dies of signal " + std::to_string(run.code - 128));
  if (run.code != 0 && run.code != 2 && run.code != 3) problems.push_back("exit code " + std::to_string(run.code));
  if (run.code == 0 && found != Found::Complete)
    problems.push_back(std::string("exit code 0, but the outputs are ") + kFoundNames[int(found)]);
  const std::string start = stage.workload().program + ": ";
  if (run.code != 0 && (run.errorLines() != 1 || run.err.rfind(start, 0) != 0))
    problems.push_back("standard error is not one line of the program: " + run.err);
  if (run.code == 0 && run.errorLines() > 1) problems.push_back("more than one line of warnings: " + run.err);
  constexpr std::size_t kLongest = 450;  // 400, the program's name and "warning: " before
  if (run.err.size() > kLongest) problems.push_back("a message of " + std::to_string(run.err.size()) + " bytes");
  return problems;
}

class Faults : public testing::TestWithParam<Workload> {};

TEST_P(Faults, TargetsAreOldAbsentOrComplete) {
  Stage stage(GetParam());
  ASSERT_FALSE(HasFailure());
  for (std::size_t k = 0; k < failing().size(); ++k) {
    const Failing& kind = failing()[k];
    Tally tally;
    std::vector<int> numbers = chosen(stage.calls()[k], kind.inCi);
    // The first ones of memory, too: while they started tasks, the libraries that stand on oneTBB waited for ever.
    constexpr int kFirst = 6;
    if (std::string(kind.call) == "memory" && !all())
      for (int n = 1; n <= std::min(kFirst, stage.calls()[k]); ++n)
        if (std::find(numbers.begin(), numbers.end(), n) == numbers.end()) numbers.push_back(n);
    for (const int n : numbers)
      for (std::size_t a = 0; a < kind.actions.size(); ++a)
        for (const bool withOld : {false, true}) {
          // A few of them in CI: every action and both beginnings take turns.
          if (!all() && (a != std::size_t(n) % kind.actions.size() || withOld != (n % 2 == 0))) continue;
          if (withOld && GetParam().before.empty()) continue;
          const Fault fault{kind.call, kind.actions[a], n};
          stage.prepare(withOld);
          const ChildRun run = stage.run({.fault = fault, .cores = {oneCore()}});
          std::vector<std::string> problems;
          const Found found = stage.look(withOld, problems);
          for (std::string& p : problemsOf(stage, run, found)) problems.push_back(std::move(p));
          const std::vector<std::string> left = stage.leftovers(true);
          if (std::string(kind.call) != "unlink")  // what cannot be removed now, the next run removes
            for (const std::string& l : left) problems.push_back("it leaves " + l);
          if (!left.empty() || (all() && n % 10 == 0)) stage.again(problems);
          ++tally.runs;
          tally.problems += !problems.empty();
          tally.add("exit " + std::to_string(run.code) + ", " + kFoundNames[int(found)]);
          for (const std::string& p : problems)
            ADD_FAILURE() << GetParam().name << " " << fault.text() << (withOld ? " (old files)" : "") << ": " << p;
        }
    EXPECT_TRUE(stage.inputsUnchanged());
    if (tally.runs) piece->add(GetParam().name + ", " + kind.call, tally);
  }
}

/// A real full disk: a file system of a few pages, where one can be mounted. It catches what no preloaded library sees.
TEST_P(Faults, AFullDisk) {
  Stage stage(GetParam());
  ASSERT_FALSE(HasFailure());
  Tally tally;
  for (const char* size : {"size=8k", "size=4k", "size=24k"}) {
    if (!all() && tally.runs > 0) break;
    stage.prepare(false);
    if (::mount("tmpfs", stage.folder().c_str(), "tmpfs", 0, size) != 0)
      GTEST_SKIP() << "mounting needs the right to: " << std::strerror(errno);
    const ChildRun run = stage.run({});
    std::vector<std::string> problems;
    const Found found = stage.look(false, problems);
    for (std::string& p : problemsOf(stage, run, found)) problems.push_back(std::move(p));
    for (const std::string& l : stage.leftovers(true)) problems.push_back("it leaves " + l);
    EXPECT_EQ(::umount(stage.folder().c_str()), 0);
    ++tally.runs;
    tally.problems += !problems.empty();
    tally.add("exit " + std::to_string(run.code) + ", " + kFoundNames[int(found)]);
    for (const std::string& p : problems) ADD_FAILURE() << GetParam().name << " " << size << ": " << p;
  }
  piece->add(GetParam().name + ", a disk of 4, 8 and 24 kB", tally);
}

INSTANTIATE_TEST_SUITE_P(Commands, Faults, testing::ValuesIn(workloads(all())), [](const auto& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

/// The preloaded library does what these tests believe.
TEST(Injection, CountsAndFails) {
  Stage stage(workloads(true).front());
  EXPECT_GE(stage.calls()[int(Call::Open)], 1);
  EXPECT_GE(stage.calls()[int(Call::Write)], 2);  // the session, and what is printed
  EXPECT_GE(stage.calls()[int(Call::Rename)], 1);
  EXPECT_GE(stage.calls()[int(Call::Sync)], 1);
  stage.prepare(false);
  const ChildRun run = stage.run({.fault = Fault{"rename", error("errno", EXDEV), 1}});
  EXPECT_EQ(run.injected, 1);
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, testing::HasSubstr(std::string("run.glint: cannot be written: ") + std::strerror(EXDEV)));
}

}  // namespace
}  // namespace glint::faults

int main(int argc, char** argv) {
  return glint::faults::runTests(argc, argv, glint::faults::piece, "Calls that fail: writes, renames, folders, memory, threads",
                                 "tests/run_faults");
}

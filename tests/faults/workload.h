// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/core/scene/scene_fixture.h"
#include "tests/faults/program_run.h"

namespace glint::faults {

namespace fs = std::filesystem;

/// A command that writes, with the other command that made what lay there before.
struct Workload {
  std::string name;
  std::vector<std::string> arguments;  ///< IN stands for the folder of the inputs; outputs are relative to the current folder
  /// The same command with other results under the same names; empty: nothing replaces anything.
  std::vector<std::string> before;
  std::string program = "glint";  ///< or "glint-save"
};
inline void PrintTo(const Workload& w, std::ostream* out) { *out << w.name; }

/// Every command that writes a file, on small shipped data, and the inspector's save and autosave. Not `every`: one for each way
/// of writing (a file, a folder with a file, a new folder, an encoder's file, the inspector's), for CI.
std::vector<Workload> workloads(bool every);

/// How the files of a workload were found after a run.
enum class Found { Absent, Old, Complete, Mixed, Broken };
inline constexpr const char* kFoundNames[] = {"absent", "old", "complete", "each file old, absent or complete", "broken"};

using Files = std::map<std::string, std::string>;  ///< path relative to the folder -> content

/// A workload with its inputs, what it writes when nothing fails, and what the earlier command wrote.
class Stage {
 public:
  explicit Stage(const Workload& workload);

  const Workload& workload() const { return workload_; }
  /// An empty folder, or one with what the earlier command wrote.
  void prepare(bool withOld);
  ChildRun run(const ChildOptions& options) const;
  /// What is wrong goes to `problems`: a file that is cut, a leftover, another file that changed.
  Found look(bool withOld, std::vector<std::string>& problems) const;
  /// Files and folders that are neither outputs nor on the way to one. @param work  the measured work of a trade-off may stay: it
  /// goes on from there.
  std::vector<std::string> leftovers(bool work = false) const;
  /// The same command once more, undisturbed: it succeeds, everything is complete, nothing is left over.
  void again(std::vector<std::string>& problems);
  bool inputsUnchanged() const { return filesIn(in_) == inputs_; }
  const std::vector<int>& calls() const { return calls_; }  ///< of a run where nothing fails
  double milliseconds() const { return milliseconds_; }
  const std::string& said() const { return said_; }  ///< on standard error, by a run where nothing fails
  const fs::path& folder() const { return run_; }

  static Files filesIn(const fs::path& folder);

 private:
  std::vector<std::string> command(const std::vector<std::string>& arguments) const;
  bool isValid(const std::string& name, const std::string& content, const std::string& good) const;

  Workload workload_;
  testing_support::TemporaryFolder base_;
  fs::path in_, run_;
  Files inputs_, good_, old_;
  std::vector<int> calls_;
  double milliseconds_ = 0;
  std::string said_;
};

/// What a whole loop found, for the piece of docs/trust.md.
struct Tally {
  int runs = 0, problems = 0;
  std::map<std::string, int> outcomes;  ///< "exit 2, old": how often
  void add(const std::string& outcome) { ++outcomes[outcome]; }
};

/// Writes rows for docs/trust.md when the test program ends: the file that the environment variable GLINT_PIECE names. Where a
/// filter chose some tests only (--gtest_filter), rows of other names stay in the file, and the new ones say their day.
class Piece : public testing::Environment {
 public:
  Piece(std::string what, std::string command) : what_(std::move(what)), command_(std::move(command)) {}
  void add(const std::string& name, const Tally& tally);
  void TearDown() override;

 private:
  std::string what_, command_;
  std::vector<std::pair<std::string, Tally>> rows_;
};

/// Runs the tests of a program that adds its counts to `piece`.
int runTests(int argc, char** argv, Piece*& piece, const char* what, const char* command);

}  // namespace glint::faults

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/progress.h"

namespace glint::cli {

/// Exit codes of every command (docs/formats.md, "Exit codes").
enum ExitCode { kDone = 0, kComparisonFailed = 1, kWrongInput = 2, kCannotAnswer = 3, kStopped = 130 };

/// Thrown by a command when the data cannot answer: one line on standard error, exit code 3.
struct CannotAnswer {
  Failure failure;
};

/// Thrown when the reader of standard output has closed its pipe: exit code 2 without a message.
struct ReaderGone {};

/// Declares the arguments of one command; each is bound to a variable that lives as long as the command.
/// The defaults shown by --help are the variables' values at declaration. Units belong in the help text.
class Options {
 public:
  struct Parser;
  explicit Options(Parser& parser) : parser_(parser) {}
  void positional(std::string& target, const std::string& name, const std::string& help);  ///< required
  /// One or more, in their order.
  void positionals(std::vector<std::string>& target, const std::string& name, const std::string& help);
  void option(std::string& target, const std::string& flags, const std::string& type,
              const std::string& help);  ///< "-o,--out", "DIR"
  void required(std::string& target, const std::string& flags, const std::string& type, const std::string& help);
  void option(double& target, const std::string& flags, const std::string& type, const std::string& help);
  void option(int& target, const std::string& flags, const std::string& type, const std::string& help);
  void option(unsigned& target, const std::string& flags, const std::string& type, const std::string& help);
  void repeated(std::vector<std::string>& target, const std::string& flags, const std::string& type,
                const std::string& help);  ///< --set A=1 --set B=2
  void choice(std::string& target, const std::string& flags, const std::vector<std::string>& values, const std::string& help);
  void flag(bool& target, const std::string& flags, const std::string& help);

 private:
  Parser& parser_;
};

/// What a running command may use of the terminal. Results go to files or standard output, everything else to standard error.
class Context {
 public:
  /// Draws a progress line on a terminal, nothing in a pipe; returns false after Ctrl-C. Pass it to all long work.
  ProgressFn progress() const;
  /// On standard error when the command ends, together with its other warnings in one line; --all-warnings: at once, on its own.
  void warn(const std::string& line) const;
  void info(const std::string& line) const;  ///< on standard error, on a terminal only
  /// To standard output, control characters from files escaped. InputError if that is full or closed.
  void print(const std::string& text) const;
  /// "-" = standard output, unchanged; else a file written atomically, with a message. InputError if it cannot be written.
  void write(const std::string& fileOrDash, const std::string& content) const;
  /// "wrote FILE", on standard error, on a terminal only. For files that a command writes by other means than `write`.
  void wrote(const std::string& file) const;
};

/// One subcommand. `run` returns an exit code or throws InputError (2), CannotAnswer (3), Stopped (130), std::invalid_argument
/// (2).
struct Command {
  std::string name;
  std::string summary;      ///< one line, in the list of commands
  std::string description;  ///< what it does, for its own --help page
  std::string examples;     ///< lines "glint ..." with a word of what they do
  std::function<void(Options&)> declare;
  std::function<int(const Context&)> run;
};

/// Parses and runs; the whole of main. Never throws. Ctrl-C and SIGTERM end the program within 200 ms, even if the work
/// does not ask for progress: temporary files of unfinished writes are removed then.
int runCommandLine(int argc, char** argv, const std::function<std::vector<Command>()>& makeCommands);

}  // namespace glint::cli

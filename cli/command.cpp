// SPDX-License-Identifier: BSD-3-Clause
// The only file that includes CLI11 (it is slow to compile).
#include "cli/command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>

#include "cli/interrupt.h"
#include "cli/terminal.h"
#include "core/app/load_plugins.h"
#include "core/base/limits.h"
#include "core/base/memory.h"
#include "core/base/number_text.h"
#include "core/base/safe_text.h"
#include "core/base/version.h"
#include "core/base/words.h"
#include "core/codecs/codecs.h"
#include "viz/added_layer.h"

namespace glint::cli {

struct Options::Parser {
  CLI::App& app;
};

namespace {

CLI::Option* named(CLI::Option* option, const std::string& type) { return option->type_name(type)->capture_default_str(); }

/// The help page of one command: synopsis, what it does, arguments, examples, exit codes.
class Page final : public CLI::Formatter {
 public:
  std::string make_usage(const CLI::App* app, std::string name) const override {
    std::string line = "Usage: " + name;
    for (const CLI::Option* o : app->get_options()) {
      if (o->get_positional())
        line += " " + o->get_name(true, false);
      else if (o->get_required())
        line += " " + o->get_name(false, false) + " " + o->get_type_name();
    }
    if (app->get_parent() == nullptr) line += " COMMAND";
    return line + " [OPTIONS]\n";
  }
  std::string make_option_opts(const CLI::Option* o) const override {
    if (o->get_type_size() == 0) return "";
    std::string text = o->get_positional() ? "" : " " + o->get_type_name();
    if (!o->get_default_str().empty()) text += "=" + o->get_default_str();
    return text;
  }
};

/// The heading of the options that every command has.
constexpr const char* kEverywhere = "Options common to all commands";

/// "json.megabytes=512, ...": names and the values at the start.
std::string limitNames() {
  std::string names;
  for (const LimitInfo& limit : limitInfos()) {
    const std::string value = formatted("=%.15g", limit.standard);
    names += (names.empty() ? "" : ", ") + limit.name + value;
  }
  return names;
}

constexpr const char* kExitCodes =
    "Exit codes: 0 done; 1 a comparison failed; 2 the input or the request is wrong;\n"
    "3 the data cannot answer; 130 stopped by Ctrl-C. Each message is one line on standard error.";

int stopped() {
  dropWarnings();
  sayStopped();
  return kStopped;
}

int fail(const std::string& line, int code) {
  if (!finish()) return stopped();  // what fails after Ctrl-C fails because of it: its files are being removed
  dropWarnings();
  clearProgressLine();
  std::fprintf(stderr, "%s %s\n", programName(Tone::Error).c_str(), messageLine(line).c_str());
  return code;
}

/// Every way in which a command may end, as an exit code and at most one line.
int guarded(const std::function<int()>& run) {
  try {
    keepFreedMemory();
    reserveTaskMemory();
    const int code = run();
    if (!finish()) return stopped();
    showWarnings();
    return code;
  } catch (const InputError& e) {
    return fail(e.what(), kWrongInput);
  } catch (const CodecsMissing& e) {
    return fail(e.what(), kWrongInput);
  } catch (const CannotAnswer& e) {
    return fail(e.failure.message(), kCannotAnswer);
  } catch (const ReaderGone&) {
    return finish() ? kWrongInput : stopped();  // `glint ... | head`: nobody is left to read a message's context
  } catch (const Stopped&) {
    return fail("stopped", kStopped);
  } catch (const std::invalid_argument& e) {
    return fail(std::string("invalid request: ") + e.what(), kWrongInput);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", kCannotAnswer);
  } catch (const std::exception& e) {
    const std::string what = e.what();  // OpenCV's own exception says so
    return fail(what.find("Insufficient memory") == std::string::npos ? "unexpected error: " + what : "out of memory",
                kCannotAnswer);
  } catch (...) {
    return fail("unexpected error", kCannotAnswer);
  }
}

}  // namespace

void Options::positional(std::string& target, const std::string& name, const std::string& help) {
  parser_.app.add_option(name, target, help)->required()->type_name("");
}
void Options::positionals(std::vector<std::string>& target, const std::string& name, const std::string& help) {
  parser_.app.add_option(name, target, help)->required()->type_name("")->expected(1, CLI::detail::expected_max_vector_size);
}
void Options::option(std::string& target, const std::string& flags, const std::string& type, const std::string& help) {
  named(parser_.app.add_option(flags, target, help), type);
}
void Options::required(std::string& target, const std::string& flags, const std::string& type, const std::string& help) {
  parser_.app.add_option(flags, target, help)->required()->type_name(type);
}
void Options::option(double& target, const std::string& flags, const std::string& type, const std::string& help) {
  // CLI11's own conversion depends on the locale.
  const CLI::callback_t read = [&target](const CLI::results_t& given) {
    const std::optional<double> number = numberFrom(given.back());
    target = number.value_or(target);
    return number.has_value();
  };
  named(parser_.app.add_option(flags, read, help), type);
}
void Options::option(int& target, const std::string& flags, const std::string& type, const std::string& help) {
  named(parser_.app.add_option(flags, target, help), type);
}
void Options::option(unsigned& target, const std::string& flags, const std::string& type, const std::string& help) {
  named(parser_.app.add_option(flags, target, help), type);
}
void Options::repeated(std::vector<std::string>& target, const std::string& flags, const std::string& type,
                       const std::string& help) {
  parser_.app.add_option(flags, target, help)->type_name(type)->expected(1)->take_all();
}
void Options::choice(std::string& target, const std::string& flags, const std::vector<std::string>& values,
                     const std::string& help) {
  std::string type;
  for (const std::string& v : values) type += (type.empty() ? "" : "|") + v;
  // A check of our own: CLI11's replaces the type's name in the help.
  named(parser_.app.add_option(flags, target, help), type)->check([values, type](const std::string& given) {
    for (const std::string& v : values)
      if (v == given) return std::string();
    return "'" + given + "' is not one of " + type;
  });
}
void Options::flag(bool& target, const std::string& flags, const std::string& help) { parser_.app.add_flag(flags, target, help); }

namespace {

/// Options that every command has.
struct Everywhere {
  std::vector<std::string> limits;
  std::vector<std::string> plugins;  ///< loaded already
  bool allWarnings = false;

  void declare(CLI::App& app) {
    const auto repeated = [&app](std::vector<std::string>& target, const char* flag, const char* type, const std::string& help) {
      app.add_option(flag, target, help + "; may be repeated")->type_name(type)->expected(1)->take_all()->group(kEverywhere);
    };
    repeated(limits, "--limit", "NAME=VALUE", "Raise a limit on input size, in the unit of its name: " + limitNames());
    repeated(plugins, "--plugin", "FILE",
             "Load this plugin: a shared library that adds models, lobes, surfaces, readers or layers");
    app.add_flag("--all-warnings", allWarnings, "Print each warning on a separate line (default: all on one line)")
        ->group(kEverywhere);
  }
};

std::vector<std::string> namesOf(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  for (const Command& c : commands) names.push_back(c.name);
  return names;
}

/// Which flag of the command was meant by the first one that it does not have, in words; "" if none is near.
std::string meantOption(const CLI::App& app) {
  for (const CLI::App* sub : app.get_subcommands()) {
    std::vector<std::string> known;
    for (const CLI::Option* option : sub->get_options())
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    for (const std::string& word : sub->remaining())
      if (word.rfind("--", 0) == 0) return didYouMean(word.substr(0, word.find('=')), known);
  }
  return "";
}

/// What a command line that cannot be parsed ends with: a page that was asked for, or one line that says what is wrong.
int answer(const CLI::App& app, const CLI::ParseError& e, const std::string& first, const std::vector<Command>& commands) {
  const bool known = std::any_of(commands.begin(), commands.end(), [&](const Command& c) { return c.name == first; });
  const bool page = known || first.empty() || first[0] == '-';  // an unknown command has no page
  if (page && e.get_exit_code() == 0) {                         // --help, --version
    std::ostringstream text;
    app.exit(e, text, text);
    Context().print(text.str());
    return kDone;
  }
  if (!known && !first.empty() && first[0] != '-')
    return fail("'" + first + "' is not a command" + didYouMean(first, namesOf(commands)) + " (see glint --help)", kWrongInput);
  if (!known && first.rfind("--", 0) == 0 && first.size() > 2 && !app.get_option_no_throw(first.substr(0, first.find('=')))) {
    std::vector<std::string> flags;
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
    return fail("'" + first + "' is not an option" + didYouMean(first, flags) + " (see glint --help)", kWrongInput);
  }
  std::string who;
  for (const CLI::App* sub : app.get_subcommands()) who = sub->get_name() + " ";
  return fail(std::string(e.what()) + meantOption(app) + " (see glint " + who + "--help)", kWrongInput);
}

/// `glint help` and `glint help COMMAND`, as other programs have them, mean the pages of --help.
std::vector<std::string> wordsFrom(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (words.empty() || words[0] != "help") return words;
  if (words.size() == 1) return {"--help"};
  return {words[1], "--help"};
}

/// All commands with their options, and what one command line says to them.
class Line {
 public:
  explicit Line(std::vector<Command> commands)
      : commands_(std::move(commands)), app_("Predicts specular highlights from a few images of a known scene.", "glint") {
    app_.formatter(std::make_shared<Page>());
    app_.set_version_flag("--version", std::string("glint ") + GLINT_VERSION + pluginLines());
    app_.set_help_flag("-h,--help", "Show this page");
    app_.require_subcommand(1);
    app_.footer("`glint COMMAND --help` describes a command.\n" + std::string(kExitCodes));
    app_.add_option("--plugin", everywhere_.plugins, "Load this plugin; also behind the command")
        ->type_name("FILE")
        ->expected(1)
        ->take_all();
    for (const Command& command : commands_) add(command);
  }
  Line(const Line&) = delete;  // the options refer to its members
  Line& operator=(const Line&) = delete;

  /// The plugins that the line names as options: not a value of another option, nothing behind "--", nothing of a line that is
  /// wrong in a way that no plugin mends.
  std::vector<std::filesystem::path> plugins(const std::vector<std::string>& words) {
    try {
      parse(words);
    } catch (const CLI::ParseError& e) {
      const bool mayName = dynamic_cast<const CLI::ValidationError*>(&e) != nullptr;  // a model that the plugin adds
      if (!mayName && e.get_exit_code() != 0) return {};
    }
    std::vector<std::filesystem::path> files;
    const auto take = [&files](const CLI::App& app) {
      for (const std::string& file : app.get_option("--plugin")->results()) files.emplace_back(file);
    };
    take(app_);
    for (const CLI::App* sub : app_.get_subcommands()) take(*sub);
    return files;
  }

  int run(const std::vector<std::string>& words) {
    if (words.empty()) {  // `glint` alone asks what there is
      Context().print(app_.help());
      return kDone;
    }
    try {
      parse(words);
    } catch (const CLI::ParseError& e) {
      return answer(app_, e, words.front(), commands_);
    }
    for (const std::string& limit : everywhere_.limits) setLimit(limit);
    showEachWarning(everywhere_.allWarnings);
    return chosen_->run(Context());
  }

 private:
  void add(const Command& command) {
    CLI::App* sub = app_.add_subcommand(command.name, command.summary);
    sub->formatter(std::make_shared<Page>());
    std::string footer;
    if (!command.description.empty()) footer += command.description + "\n\n";
    if (!command.examples.empty()) footer += "Examples:\n" + command.examples + "\n";
    sub->footer(footer + kExitCodes);
    Options::Parser parser{*sub};
    Options options(parser);
    command.declare(options);
    everywhere_.declare(*sub);
    sub->callback([this, &command] { chosen_ = &command; });
  }
  void parse(const std::vector<std::string>& words) {
    app_.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 takes them from the back
  }

  std::vector<Command> commands_;
  Everywhere everywhere_;
  CLI::App app_;
  const Command* chosen_ = nullptr;
};

}  // namespace

int runCommandLine(int argc, char** argv, const std::function<std::vector<Command>()>& makeCommands) {
  return guarded([&]() -> int {
    const std::vector<std::string> words = wordsFrom(argc, argv);
    // The pages list what plugins add, so the commands are made again behind them.
    const bool mayName =
        std::any_of(words.begin(), words.end(), [](const std::string& word) { return word.rfind("--plugin", 0) == 0; });
    std::vector<std::string> refused =
        loadPlugins(mayName ? Line(makeCommands()).plugins(words) : std::vector<std::filesystem::path>());
    for (std::string& line : viz::addPluginLayers()) refused.push_back(std::move(line));
    for (const std::string& line : refused) Context().warn(line);
    return Line(makeCommands()).run(words);
  });
}

}  // namespace glint::cli

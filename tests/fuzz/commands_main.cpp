// SPDX-License-Identifier: BSD-3-Clause
// Damaged inputs through the program itself, as a script would run it:
//   fuzz_commands PROGRAM [--seed K] [--count N] [--first N] [--jobs N] [--keep FOLDER] [--piece FILE]
// Number n of a seed is always the same damage and command. A finding is: a signal; more than 20 s of the processor or a minute's
// silence; more than 1 GB; an exit code other than 0, 2, 3 (1 for replay); a failure without its one line, or more than one line
// on standard error; a line of more than 400 characters; control characters or bytes that are no UTF-8 on the terminal; a file
// written, changed or removed outside of out/; a invalid JSON file. Ends with 1 when there was one. Each is kept in FOLDER/n: the
// folder as it was, and CMD.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "core/base/safe_text.h"
#include "tests/fuzz/command_materials.h"
#include "tests/fuzz/scratch_file.h"

namespace {

using namespace glint::fuzz;
namespace fs = std::filesystem;

constexpr double kSlowSeconds = 20;   // of the processor: the inputs are tiny, and most commands take a tenth of a second
constexpr long kMostUnchecked = 500;  // runs, from which all commands are first tried on what is not damaged: a minute
constexpr double kHangSeconds = 180;  // on the clock, for what waits
constexpr double kLargeMegabytes = 1000;
constexpr std::size_t kLongestLine = 400;
constexpr std::size_t kMostBytes = 1 << 20;

struct Options {
  fs::path program, keep, piece;
  std::uint64_t seed = 0;
  long count = 1000, first = 0;
  int jobs = 1;
};

struct Run {
  int code = -1;  // exit code, or minus the signal
  bool hung = false;
  double seconds = 0, megabytes = 0;
  std::string out, err;
};

std::string contentOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// The words of a command, blanks between them; "{}" is the damaged word, whatever it holds.
std::vector<std::string> wordsOf(const std::string& command, const std::string& damaged) {
  std::vector<std::string> words;
  std::istringstream in(command);
  for (std::string word; in >> word;) words.push_back(word == "{}" ? damaged : word);
  return words;
}

Run runProgram(const fs::path& program, const std::vector<std::string>& words, const fs::path& folder, const fs::path& outer) {
  const std::string out = (outer / "stdout").string(), err = (outer / "stderr").string();
  std::vector<char*> arguments{const_cast<char*>("glint")};
  for (const std::string& w : words) arguments.push_back(const_cast<char*>(w.c_str()));
  arguments.push_back(nullptr);
  const std::string home = (outer / "home").string(), temporary = (outer / "tmp").string();
  const pid_t child = ::fork();
  if (child == 0) {
    const auto bound = [](auto what, rlim_t most) {
      const rlimit limit{most, most};
      ::setrlimit(what, &limit);
    };
    bound(RLIMIT_CPU, 60);
#ifndef __SANITIZE_ADDRESS__  // it maps terabytes for its shadow
    bound(RLIMIT_AS, rlim_t(6) << 30);
#endif
    bound(RLIMIT_CORE, 0);
    bound(RLIMIT_FSIZE, rlim_t(1) << 29);
    ::setenv("HOME", home.c_str(), 1);
    ::setenv("TMPDIR", temporary.c_str(), 1);
    for (const char* name : {"XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"}) ::unsetenv(name);
    const int in = ::open("/dev/null", O_RDONLY), toOut = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644),
              toErr = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (::chdir(folder.c_str()) != 0 || ::dup2(in, 0) < 0 || ::dup2(toOut, 1) < 0 || ::dup2(toErr, 2) < 0) ::_exit(99);
    ::execv(program.c_str(), arguments.data());
    ::_exit(98);
  }
  Run run;
  if (child < 0) throw std::runtime_error("no process can be started");
  const auto start = std::chrono::steady_clock::now();
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, WNOHANG, &usage) == 0) {
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > kHangSeconds) {
      run.hung = true;
      ::kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  const auto secondsOf = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  run.seconds = secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime);
  run.megabytes = double(usage.ru_maxrss) / 1024;
  run.out = contentOf(out);
  run.err = contentOf(err);
  return run;
}

/// Every file below a folder with its content, but what lies in the copy's out/, and the two that hold the program's words.
std::map<std::string, std::string> filesBelow(const fs::path& outer) {
  std::map<std::string, std::string> files;
  for (fs::recursive_directory_iterator it(outer), end; it != end; ++it) {
    const std::string name = it->path().lexically_relative(outer).string();
    if (name == "case/out") it.disable_recursion_pending();
    if (name != "stdout" && name != "stderr" && name != "case/out")
      files[name] = it->is_regular_file() ? contentOf(it->path()) : "a folder";
  }
  return files;
}

std::string kindOfLine(const std::string& text) {
  if (glint::withoutControls(text) != text) return "control characters or no UTF-8";
  return "";
}

/// All that is wrong with a run; "" = nothing.
std::string complaint(const Run& run, const std::string& command, const std::map<std::string, std::string>& before,
                      const fs::path& outer) {
  if (run.hung) return "no end after " + std::to_string(int(kHangSeconds)) + " s";
  if (run.code == -SIGXCPU || run.seconds > kSlowSeconds) return "slow: " + std::to_string(run.seconds) + " s of the processor";
  if (run.code < 0) return "signal " + std::to_string(-run.code);
  const bool replayed = command.rfind("replay", 0) == 0 && run.code == 1;
  if (run.code != 0 && run.code != 2 && run.code != 3 && !replayed) return "exit code " + std::to_string(run.code);
  if (run.megabytes > kLargeMegabytes) return "memory: " + std::to_string(run.megabytes) + " MB";
  const auto lines = std::count(run.err.begin(), run.err.end(), '\n');
  if (lines > 1) return std::to_string(lines) + " lines on standard error";
  if (lines == 0 && (run.code == 2 || run.code == 3)) return "a failure without a line";
  if (!run.err.empty() && run.err.back() != '\n') return "a line without an end";
  if (run.err.size() > kLongestLine + 1) return "a line of " + std::to_string(run.err.size() - 1) + " bytes";
  if (!run.err.empty() && run.err.rfind("glint: ", 0) != 0) return "a line that is not the program's own";
  if (run.err.rfind("glint: unexpected", 0) == 0 || run.err.rfind("glint: out of memory", 0) == 0 ||
      run.err.rfind("glint: invalid request", 0) == 0)
    return "a failure that nobody meant";
  if (const std::string kind = kindOfLine(run.err); !kind.empty()) return "standard error: " + kind;
  if (const std::string kind = kindOfLine(run.out); !kind.empty()) return "standard output: " + kind;
  const std::map<std::string, std::string> after = filesBelow(outer);
  for (const auto& [name, content] : after) {
    const auto old = before.find(name);
    if (old == before.end()) return "written outside of out/: " + name;
    if (old->second != content) return "changed: " + name;
  }
  // The unfinished work that --work names is the command's own: it goes when the work is done.
  const bool ownWork = command.find("--work run.work") != std::string::npos;
  for (const auto& [name, content] : before)
    if (!after.count(name) && !(ownWork && name == "case/run.work")) return "removed: " + name;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(outer / "case/out", none))
    if (entry.path().extension() == ".json" && !nlohmann::json::accept(contentOf(entry.path())))
      return "no JSON: " + entry.path().filename().string();
  return "";
}

struct Row {
  long runs = 0, answered = 0, wrong = 0, cannot = 0, findings = 0;
  double slowest = 0, largest = 0;
};
using Table = std::map<std::string, Row>;

void addTo(Row& sum, const Row& r) {
  sum.runs += r.runs;
  sum.answered += r.answered;
  sum.wrong += r.wrong;
  sum.cannot += r.cannot;
  sum.findings += r.findings;
  sum.slowest = std::max(sum.slowest, r.slowest);
  sum.largest = std::max(sum.largest, r.largest);
}

void one(const Options& o, const fs::path& materials, const std::vector<const Victim*>& lots, long number, Table& table) {
  Rng rng = rngOf(o.seed, static_cast<std::uint64_t>(number));
  const Victim& v = *lots[below(rng, lots.size())];
  const std::string command = v.commands[below(rng, v.commands.size())];
  const ScratchFolder outer;
  const fs::path folder = outer.path() / "case";
  fs::copy(materials / v.input, folder, fs::copy_options::recursive);
  for (const char* name : {"home", "tmp", "canary", "case/out"}) fs::create_directories(outer.path() / name);
  outer.write("canary/song.txt", "la");
  const std::vector<std::string> paths = {"../canary/song.txt", (outer.path() / "canary/song.txt").string(),
                                          (outer.path() / "canary/new").string(), "../canary/new", "../../escape"};
  std::string damaged;
  if (v.file.empty()) {
    damaged = mutated(v.word, v.form, rng, 2000, paths);
    std::erase(damaged, '\0');  // a word of a command line holds none
    if (damaged.empty() || damaged[0] == '-') damaged = "," + damaged;
  } else {
    const std::string bytes = mutated(contentOf(folder / v.file), v.form, rng, kMostBytes, paths);
    std::ofstream(folder / v.file, std::ios::binary) << bytes;
  }
  const fs::path kept = o.keep / std::to_string(number);
  if (!o.keep.empty() && o.count == 1) fs::copy(folder, kept, fs::copy_options::recursive);
  const std::map<std::string, std::string> before = filesBelow(outer.path());
  const Run run = runProgram(o.program, wordsOf(command, damaged), folder, outer.path());
  std::string wrong = complaint(run, command, before, outer.path());
  // Words that name an output may name any place, and the program writes where it is told.
  if (v.reader == "places" && wrong.rfind("written outside", 0) == 0) wrong.clear();

  Row& row = table[v.reader + " | " + command.substr(0, command.find(' '))];
  ++row.runs;
  ++(run.code == 0 || run.code == 1 ? row.answered : run.code == 2 ? row.wrong : row.cannot);
  row.slowest = std::max(row.slowest, run.seconds);
  row.largest = std::max(row.largest, run.megabytes);
  if (wrong.empty()) return;
  ++row.findings;
  std::printf("FINDING %ld: %s: glint %s (%s): %s\n", number, v.reader.c_str(), command.c_str(), wrong.c_str(),
              glint::messageLine(run.err.empty() ? damaged : run.err).c_str());
  std::fflush(stdout);
  if (o.keep.empty()) return;
  std::error_code error;
  fs::create_directories(kept, error);
  for (const auto& [name, content] : before)
    if (name.rfind("case/", 0) == 0 && content != "a folder") {
      fs::create_directories((kept / name.substr(5)).parent_path(), error);
      std::ofstream(kept / name.substr(5), std::ios::binary) << content;
    }
  std::ofstream(kept / "CMD") << "glint " << command << (damaged.empty() ? "" : "\n{} = " + damaged) << "\n"
                              << wrong << "\n"
                              << run.err;
}

/// The first command that fails on what is not damaged, with its words; "" = none. Such a command would reach nothing behind its
/// failure.
std::string failsUndamaged(const Options& o, const fs::path& materials, const std::vector<Victim>& victims) {
  std::set<std::pair<std::string, std::string>> seen;
  for (const Victim& v : victims)
    for (const std::string& command : v.commands) {
      if (v.reader == "places" || !seen.emplace(v.input, command).second) continue;  // most of those places are wrong ones
      const ScratchFolder outer;
      const fs::path folder = outer.path() / "case";
      fs::copy(materials / v.input, folder, fs::copy_options::recursive);
      for (const char* name : {"home", "tmp", "case/out"}) fs::create_directories(outer.path() / name);
      const Run run = runProgram(o.program, wordsOf(command, v.word), folder, outer.path());
      if (run.code != 0) return v.input + ": glint " + command + ": exit code " + std::to_string(run.code) + ": " + run.err;
    }
  return "";
}

void write(const fs::path& file, const Table& table) {
  std::ofstream out(file);
  for (const auto& [name, r] : table)
    out << name << "\t" << r.runs << " " << r.answered << " " << r.wrong << " " << r.cannot << " " << r.findings << " "
        << r.slowest << " " << r.largest << "\n";
}

void add(const fs::path& file, Table& table) {
  std::ifstream in(file);
  for (std::string name; std::getline(in, name, '\t');) {
    Row r;
    std::string rest;
    std::getline(in, rest);
    std::istringstream(rest) >> r.runs >> r.answered >> r.wrong >> r.cannot >> r.findings >> r.slowest >> r.largest;
    addTo(table[name], r);
  }
}

std::string markdown(const Table& table) {
  std::string text =
      "| damaged | command | runs | answered | exit 2 | exit 3 | findings | slowest, s | largest, MB "
      "|\n|---|---|---|---|---|---|---|---|---|\n";
  Row all;
  const auto line = [&](const std::string& name, const Row& r) {
    char numbers[200];
    std::snprintf(numbers, sizeof numbers, " | %ld | %ld | %ld | %ld | %ld | %.1f | %.0f |\n", r.runs, r.answered, r.wrong,
                  r.cannot, r.findings, r.slowest, r.largest);
    text += "| " + name + numbers;
  };
  for (const auto& [name, r] : table) {
    line(name, r);
    addTo(all, r);
  }
  line("all | ", all);
  return text;
}

/// For docs/trust.md: one row for each damaged thing.
std::string pieceOf(const Options& o, const Table& table) {
  Table things;
  for (const auto& [name, r] : table) {
    Row& sum = things[name.substr(0, name.find(" | "))];
    sum = {sum.runs + r.runs,
           sum.answered + r.answered,
           sum.wrong + r.wrong,
           sum.cannot + r.cannot,
           sum.findings + r.findings,
           std::max(sum.slowest, r.slowest),
           std::max(sum.largest, r.largest)};
  }
  char day[32];
  const std::time_t now = std::time(nullptr);
  std::strftime(day, sizeof day, "%Y-%m-%d", std::gmtime(&now));
  nlohmann::ordered_json piece = {{"what", "Damaged inputs through the program itself"},
                                  {"command", "tests/run_mutations --seed " + std::to_string(o.seed) + " --first " +
                                                  std::to_string(o.first) + " --count " + std::to_string(o.count)},
                                  {"date", day}};
  for (const auto& [name, r] : things)
    piece["rows"].push_back({{"name", name},
                             {"count", r.runs},
                             {"findings", r.findings},
                             {"note", "answered " + std::to_string(r.answered) + ", refused " + std::to_string(r.wrong) +
                                          ", cannot answer " + std::to_string(r.cannot)}});
  return piece.dump(1) + "\n";
}

bool parse(int argc, char** argv, Options& o) {
  if (argc < 2 || argc % 2 != 0) return false;
  o.program = fs::absolute(argv[1]);
  for (int i = 2; i + 1 < argc; i += 2) {
    const std::string flag = argv[i], value = argv[i + 1];
    if (flag == "--seed")
      o.seed = std::strtoull(value.c_str(), nullptr, 10);
    else if (flag == "--count")
      o.count = std::atol(value.c_str());
    else if (flag == "--first")
      o.first = std::atol(value.c_str());
    else if (flag == "--jobs")
      o.jobs = std::max(1, std::atoi(value.c_str()));
    else if (flag == "--keep")
      o.keep = fs::absolute(value);
    else if (flag == "--piece")
      o.piece = fs::absolute(value);
    else
      return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  if (!parse(argc, argv, o)) {
    std::fprintf(stderr, "fuzz_commands PROGRAM [--seed K] [--count N] [--first N] [--jobs N] [--keep FOLDER] [--piece FILE]\n");
    return 2;
  }
  const ScratchFolder materials;
  std::vector<Victim> victims;
  try {
    victims = makeMaterials(o.program, materials.path());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
  if (o.count >= kMostUnchecked)
    if (const std::string fails = failsUndamaged(o, materials.path(), victims); !fails.empty()) {
      std::fprintf(stderr, "undamaged, %s", fails.c_str());
      return 2;
    }
  std::vector<const Victim*> lots;
  for (const Victim& v : victims) lots.insert(lots.end(), static_cast<std::size_t>(v.weight), &v);

  std::vector<pid_t> workers;
  for (int w = 0; w < o.jobs; ++w) {
    const pid_t worker = ::fork();
    if (worker != 0) {
      workers.push_back(worker);
      continue;
    }
    Table table;
    for (long n = o.first + w; n < o.first + o.count; n += o.jobs) one(o, materials.path(), lots, n, table);
    write(materials.path() / ("counts-" + std::to_string(w)), table);
    ::_exit(0);
  }
  bool whole = true;
  for (const pid_t worker : workers) {
    int status = 0;
    whole = ::waitpid(worker, &status, 0) == worker && status == 0 && whole;
  }
  Table table;
  for (int w = 0; w < o.jobs; ++w) add(materials.path() / ("counts-" + std::to_string(w)), table);
  std::printf("Seed %llu, numbers %ld to %ld\n%s", static_cast<unsigned long long>(o.seed), o.first, o.first + o.count - 1,
              markdown(table).c_str());
  if (!o.piece.empty()) std::ofstream(o.piece) << pieceOf(o, table);
  long findings = 0;
  for (const auto& [name, r] : table) findings += r.findings;
  if (!whole) std::fprintf(stderr, "a worker ended early\n");
  return findings == 0 && whole ? 0 : 1;
}

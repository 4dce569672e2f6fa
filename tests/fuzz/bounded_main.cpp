// SPDX-License-Identifier: BSD-3-Clause
// One reader of files fed with its corpus and with damaged copies of it: what CI runs, without libFuzzer and with any compiler.
//   fuzz_readers READER CORPUS [--inputs N] [--seconds S] [--seed K] [--first N]
// Input number n of a seed is always the same, so that a finding comes back with --first n --inputs 1. Ends with 1 at a finding,
// whose bytes lie in the working folder as finding-READER.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/fuzz/readers.h"

namespace {

using namespace glint::fuzz;
namespace fs = std::filesystem;

constexpr unsigned kHang = 60;  // s for one input, of which most take a millisecond: generous, for machines under load
constexpr std::size_t kMostBytes = 1 << 18;  // of one input
const std::string* current = nullptr;        // what a signal finds
std::string findingFile;                     // with its zero byte, for `open`
char nowFeeding[160];                        // "input 17 of seed 3"

void keepCurrent() {
  if (!current) return;
  const int fd = ::open(findingFile.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (fd < 0 || ::write(fd, current->data(), current->size()) < 0) return;
  ::close(fd);
}

/// Only calls that a signal handler may make.
void say(const char* text) {
  if (::write(STDERR_FILENO, text, __builtin_strlen(text)) < 0) return;
}

extern "C" void onSignal(int number) {
  say(number == SIGALRM ? "no end after a minute: " : "killed by a signal: ");
  say(nowFeeding);
  say(", kept as ");
  say(findingFile.c_str());
  say("\n");
  keepCurrent();
  ::_exit(1);
}

struct Counts {
  long inputs = 0, read = 0, refused = 0;
};

/// False at a finding.
bool feed(const Reader& reader, const std::string& bytes, Counts& counts) {
  current = &bytes;
  ::alarm(kHang);
  std::string what;
  try {
    ++counts.inputs;
    ++(reader.feed(bytes) ? counts.read : counts.refused);
  } catch (const Finding& finding) {
    what = finding.what;
  } catch (const std::exception& e) {
    what = std::string("an exception that no reader may throw: ") + e.what();
  }
  ::alarm(0);
  if (what.empty()) return true;
  std::fprintf(stderr, "%s: %s: %s; kept as %s\n", reader.name.c_str(), nowFeeding, what.c_str(), findingFile.c_str());
  keepCurrent();
  return false;
}

std::string contentOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

int usage() {
  std::fprintf(stderr, "fuzz_readers READER CORPUS [--inputs N] [--seconds S] [--seed K] [--first N]\nREADER:");
  for (const Reader& r : readers()) std::fprintf(stderr, " %s", r.name.c_str());
  std::fprintf(stderr, "\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  const Reader* reader = argc > 2 ? readerOf(argv[1]) : nullptr;
  if (!reader) return usage();
  long inputs = 100000, first = 0, seed = 1;
  double seconds = 10;
  for (int i = 3; i + 1 < argc; i += 2) {
    const std::string flag = argv[i];
    if (flag == "--inputs")
      inputs = std::atol(argv[i + 1]);
    else if (flag == "--seconds")
      seconds = std::atof(argv[i + 1]);
    else if (flag == "--seed")
      seed = std::atol(argv[i + 1]);
    else if (flag == "--first")
      first = std::atol(argv[i + 1]);
    else
      return usage();
  }
  findingFile = "finding-" + reader->name;
  for (const int number : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGALRM}) std::signal(number, onSignal);

  std::vector<std::string> seeds;
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(argv[2])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  Counts counts;
  for (const fs::path& file : files) {
    seeds.push_back(contentOf(file));
    std::snprintf(nowFeeding, sizeof nowFeeding, "%s", file.filename().c_str());
    if (!feed(*reader, seeds.back(), counts)) return 1;
  }
  if (seeds.empty()) {
    std::fprintf(stderr, "%s: holds no file\n", argv[2]);
    return 2;
  }
  const long readable = counts.read;
  const auto start = std::chrono::steady_clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  for (long n = first; n < first + inputs && passed() < seconds; ++n) {
    Rng rng = rngOf(static_cast<std::uint64_t>(seed), static_cast<std::uint64_t>(n));
    std::snprintf(nowFeeding, sizeof nowFeeding, "input %ld of seed %ld", n, seed);
    const std::string bytes = mutated(seeds[below(rng, seeds.size())], reader->form, rng, kMostBytes);
    if (!feed(*reader, bytes, counts)) return 1;
  }
  std::printf("%s: %zu files of the corpus, %ld of them readable; %ld inputs in %.1f s, %ld read, %ld refused, no finding\n",
              reader->name.c_str(), seeds.size(), readable, counts.inputs, passed(), counts.read, counts.refused);
  return 0;
}

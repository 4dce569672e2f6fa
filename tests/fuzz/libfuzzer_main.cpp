// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer's entries for all readers: `fuzz_libfuzzer --reader=scene CORPUS...`. GLINT_FUZZ_CPU_SECONDS ends a run after so much
// time of the processor, as libFuzzer's own limit counts the clock on the wall.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "tests/fuzz/readers.h"

namespace {

using namespace glint::fuzz;

const Reader* reader = nullptr;
double mostCpuSeconds = 0;  // 0 = no limit

double cpuSeconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr const char* kFlag = "--reader=";
  for (int i = 1; i < *argc; ++i)
    if (std::strncmp((*argv)[i], kFlag, std::strlen(kFlag)) == 0) reader = readerOf((*argv)[i] + std::strlen(kFlag));
  if (!reader) {
    std::fprintf(stderr, "--reader=NAME, one of:");
    for (const Reader& r : readers()) std::fprintf(stderr, " %s", r.name.c_str());
    std::fprintf(stderr, "\n");
    std::exit(2);
  }
  std::atexit([] { std::fprintf(stderr, "GLINT_FUZZ cpu seconds: %.0f\n", cpuSeconds()); });
  if (const char* text = std::getenv("GLINT_FUZZ_CPU_SECONDS")) mostCpuSeconds = std::strtod(text, nullptr);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    reader->feed(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const Finding& finding) {
    std::fprintf(stderr, "FINDING: %s\n", finding.what.c_str());
    std::abort();
  }
  static unsigned count = 0;
  constexpr unsigned kBetweenLooks = 256;
  if (mostCpuSeconds > 0 && ++count % kBetweenLooks == 0 && cpuSeconds() > mostCpuSeconds) {
    mostCpuSeconds = 0;
    std::fprintf(stderr, "GLINT_FUZZ cpu seconds: %.0f\n", cpuSeconds());
    std::raise(SIGUSR1);  // libFuzzer ends with its figures
  }
  return 0;
}

/// Half of the inputs are damaged by their structure, half by libFuzzer, which knows what it has seen compared.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  Rng rng(seed);
  if (below(rng, 2) == 0) return LLVMFuzzerMutate(data, size, most);
  const std::string out = mutated(std::string(reinterpret_cast<const char*>(data), size), reader->form, rng, most);
  if (out.empty()) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, out.data(), out.size());
  return out.size();
}

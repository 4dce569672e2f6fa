// SPDX-License-Identifier: BSD-3-Clause
// The same results whatever the number of threads, the allocator and what lies in fresh memory (replay --exact), and results
// within 1e-9 on a processor with fewer features (replay). GLINT_SESSIONS=all takes every shipped session
// (tests/run_determinism).
#include <dlfcn.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <cstring>

#include "tests/faults/workload.h"

namespace glint::faults {
namespace {

using testing_support::TemporaryFolder;

Piece* piece = nullptr;

std::vector<std::string> sessions() {
  const char* asked = std::getenv("GLINT_SESSIONS");
  if (asked && std::strcmp(asked, "all") == 0)
    return {"plane",          "plane-to-cylinder", "ellipsoid",      "two-lamps",           "vase",
            "lessons/mirror", "lessons/plane",     "lessons/sphere", "lessons/bent-mirror", "lessons/plane-to-cylinder",
            "lessons/waist"};
  return {"plane", "vase"};  // the smallest, and the one with a mesh
}

std::string nameOf(const std::string& session) { return fs::path(session).filename().string(); }

/// Tunables of the C library's allocator: every allocation is its own mapping, many arenas, freed memory filled with a pattern.
struct Setting {
  std::string name;
  std::map<std::string, std::string> environment;
  bool oneCore = false;
};

std::vector<Setting> exactSettings() {
  std::vector<Setting> all;
  for (const char* n : {"1", "2", "4"})
    all.push_back({std::string(n) + (*n == '1' ? " thread" : " threads"),
                   {{"GLINT_THREADS", n},
                    {"OMP_NUM_THREADS", n},
                    {"OPENCV_FOR_THREADS_NUM", n},
                    {"VTK_SMP_MAX_THREADS", n},
                    {"GLINT_EMBREE", std::string("threads=") + n}},
                   *n == '1'});
  all.push_back({"memory filled with a pattern", {{"MALLOC_PERTURB_", "165"}}});
  all.push_back(
      {"allocations mapped one by one",
       {{"GLIBC_TUNABLES", "glibc.malloc.mmap_threshold=4096:glibc.malloc.mmap_max=100000:glibc.malloc.tcache_count=0"}}});
  all.push_back({"one arena, trimmed at once",
                 {{"GLIBC_TUNABLES", "glibc.malloc.arena_max=1:glibc.malloc.trim_threshold=0:glibc.malloc.top_pad=0"}}});
  constexpr const char* kOther = "libjemalloc.so.2";
  if (void* other = dlopen(kOther, RTLD_LAZY)) {  // else the loader would only warn, and the row would be of the same allocator
    dlclose(other);
    all.push_back({"another allocator (jemalloc)", {{"LD_PRELOAD", kOther}}});
  }
  return all;
}

std::vector<Setting> maskedSettings() {
  const std::string noAvx512 = "-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ,-AVX512CD";
  return {{"C library without AVX-512", {{"GLIBC_TUNABLES", "glibc.cpu.hwcaps=" + noAvx512}}},
          {"C library without AVX2 and FMA",
           {{"GLIBC_TUNABLES", "glibc.cpu.hwcaps=" + noAvx512 + ",-AVX2,-AVX2_Usable,-FMA,-FMA_Usable,-FMA4"}}},
          {"OpenCV without AVX-512", {{"OPENCV_CPU_DISABLE", "AVX512_SKX"}}},
          {"OpenCV without AVX2", {{"OPENCV_CPU_DISABLE", "AVX512_SKX,AVX2,FMA3,FP16,AVX"}}},
          {"Embree with AVX2", {{"GLINT_EMBREE", "isa=avx2"}}},
          {"Embree with SSE2", {{"GLINT_EMBREE", "isa=sse2"}}},
          {"all of them",
           {{"GLIBC_TUNABLES", "glibc.cpu.hwcaps=" + noAvx512 + ",-AVX2,-AVX2_Usable,-FMA,-FMA_Usable,-FMA4"},
            {"OPENCV_CPU_DISABLE", "AVX512_SKX,AVX2,FMA3,FP16,AVX"},
            {"GLINT_EMBREE", "isa=sse2"}}}};
}

ChildRun runWith(const Setting& setting, const std::vector<std::string>& command) {
  const TemporaryFolder folder;
  ChildOptions options;
  options.environment = setting.environment;
  if (setting.oneCore) options.cores = {oneCore()};
  options.secondsAtMost = 600;
  return runChild(command, folder.path(), options);
}

class Determinism : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    fs::copy(std::string(GLINT_SOURCE_DIR "/sessions/") + GetParam(), folder_.path() / "s", fs::copy_options::recursive);
    file_ = folder_.path() / "s" / (nameOf(GetParam()) + ".glint");
  }
  /// The shipped session with the results of this machine: bits are promised on one machine only.
  void computeHere() {
    const fs::path here = file_.parent_path() / "here.glint";
    const ChildRun run = runWith({}, {GLINT_PROGRAM, "reconstruct", file_.string(), "-o", here.string()});
    ASSERT_EQ(run.code, 0) << run.err;
    file_ = here;
  }
  void expectReplays(const std::vector<Setting>& settings, const char* what, bool exact) {
    Tally tally;
    for (const Setting& setting : settings) expectReplay(setting, exact, tally);
    piece->add(GetParam() + ", " + what, tally);
  }
  TemporaryFolder folder_;
  fs::path file_;

 private:
  void expectReplay(const Setting& setting, bool exact, Tally& tally) {
    std::vector<std::string> command = {GLINT_PROGRAM, "replay", file_.string()};
    if (exact) command.emplace_back("--exact");
    const ChildRun run = runWith(setting, command);
    EXPECT_EQ(run.code, 0) << setting.name << "\n" << run.out << run.err;
    tally.runs += 1;
    tally.problems += run.code != 0;
    std::string last = run.out.substr(0, run.out.rfind('\n'));
    last = last.substr(last.rfind('\n') + 1);
    tally.add((run.code ? setting.name + " fails; " : std::string()) + last.substr(last.find("digest")));
    RecordProperty(setting.name, last);
    if (!exact) std::printf("%s, %s: %s\n", GetParam().c_str(), setting.name.c_str(), last.c_str());
  }
};

TEST_P(Determinism, TheSameBitsWithAnyThreadsAndMemory) {
  computeHere();
  ASSERT_FALSE(HasFatalFailure());
  expectReplays(exactSettings(), "other threads and allocators", true);
}

TEST_P(Determinism, WithinTheToleranceOnLesserProcessors) {
  computeHere();
  ASSERT_FALSE(HasFatalFailure());
  expectReplays(maskedSettings(), "features of the processor switched off", false);
}

INSTANTIATE_TEST_SUITE_P(Sessions, Determinism, testing::ValuesIn(sessions()), [](const auto& info) {
  std::string name = info.param;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

}  // namespace
}  // namespace glint::faults

int main(int argc, char** argv) {
  return glint::faults::runTests(argc, argv, glint::faults::piece,
                                 "The same results with other threads, allocators and processor features",
                                 "tests/run_determinism");
}

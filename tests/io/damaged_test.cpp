// SPDX-License-Identifier: BSD-3-Clause
// Damaged files end in a mesh that keeps its promises or in one line of an InputError: never in a crash, never in memory that the
// file does not account for, and the same under a locale that writes 0,5.
#include <gmock/gmock.h>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <locale>
#include <random>

#include "tests/core/scene/scene_fixture.h"
#include "tests/io/allocation_meter.h"
#include "tests/io/mesh_texts.h"
#include "tests/shared_data.h"

namespace glint {
namespace {
using namespace testing_support;
namespace fs = std::filesystem;

/// Numbers with a decimal comma: in iostreams always, in the C library where the machine knows such a locale or can make one.
class CommaLocale {
 public:
  CommaLocale() : before_(std::setlocale(LC_ALL, nullptr)) {
    old_ = std::locale::global(std::locale(std::locale::classic(), new Comma));
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8"})
      if (std::setlocale(LC_ALL, name)) return;
    const std::string made = (folder_.path() / "de_DE.UTF-8").string();
    if (std::system(("localedef -i de_DE -f UTF-8 " + made + " > /dev/null 2>&1").c_str()) == 0) {
      if (const char* path = std::getenv("LOCPATH")) path_ = path;
      ::setenv("LOCPATH", folder_.path().c_str(), 1);
      std::setlocale(LC_ALL, "de_DE.UTF-8");
      if (path_.empty())
        ::unsetenv("LOCPATH");
      else
        ::setenv("LOCPATH", path_.c_str(), 1);
    }
  }
  ~CommaLocale() {
    std::locale::global(old_);
    std::setlocale(LC_ALL, before_.c_str());
  }

 private:
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  std::string before_, path_;
  TemporaryFolder folder_;
  std::locale old_;
};

/// The mesh as text, or the message: to compare two readings.
std::string outcomeOf(const std::string& bytes, const fs::path& file) {
  std::string text;
  largestAllocation = 0;
  try {
    const MeshContent mesh = parseMesh(bytes, file);
    EXPECT_EQ(brokenPromise(mesh), "");
    for (const Eigen::Vector3d& v : mesh.vertices) text.append(reinterpret_cast<const char*>(v.data()), sizeof v);
    text += std::to_string(mesh.triangles.size());
  } catch (const InputError& e) {
    text = e.what();
    EXPECT_EQ(text.find_first_of("\n\r\x1b"), std::string::npos) << text;
    EXPECT_LT(text.size(), 400u) << text;
    EXPECT_EQ(text.find(file.string()), 0u) << text;
  }
  // The worst honest ratio: a one-byte corner of an OBJ's polygon ("1 ") makes a triangle and its normals' numbers, in vectors
  // that double when they grow.
  EXPECT_LT(largestAllocation, 100000 + 64 * bytes.size()) << text;
  return text;
}

std::vector<std::string> goodFiles() {
  return {plyText(),
          plyTextWithNormals(),
          plyBinary<float>("float", false),
          plyBinary<double>("double", true),
          objText(),
          stlText(),
          stlBinary(),
          gltfText(),
          glb()};
}

/// One to four changes such as disks, cables, editors and attackers make.
std::string mutated(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n ? static_cast<std::size_t>(random() % n) : 0; };
  static const std::vector<std::string> kNasty = {"0",
                                                  "-1",
                                                  "1e308",
                                                  "-1e999",
                                                  "nan",
                                                  "inf",
                                                  "4294967295",
                                                  "2147483648",
                                                  "9223372036854775807",
                                                  "18446744073709551616",
                                                  "0x10",
                                                  "1,5",
                                                  "//",
                                                  "\\\n",
                                                  "\r",
                                                  "\n",
                                                  "list",
                                                  "property",
                                                  "vertex",
                                                  "face",
                                                  "end_header\n",
                                                  "",
                                                  "f 1 2 3\n"};
  for (std::size_t changes = 1 + below(4); changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = below(bytes.size()), length = std::min(bytes.size() - at, 1 + below(24));
    switch (below(8)) {
      case 0: bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8))); break;
      case 1: bytes[at] = static_cast<char>(random()); break;
      case 2: bytes.erase(at, length); break;
      case 3: bytes.insert(at, bytes.substr(below(bytes.size()), length)); break;
      case 4: bytes.resize(at); break;
      case 5: std::fill_n(bytes.begin() + std::ptrdiff_t(at), length, below(2) ? '\xff' : '\0'); break;
      default: {  // a word becomes another one
        const std::size_t from = bytes.find_first_of(" \n", at);
        if (from == std::string::npos) break;
        const std::size_t to = std::min(bytes.find_first_of(" \n", from + 1), bytes.size());
        bytes.replace(from + 1, to - from - 1, kNasty[below(kNasty.size())]);
      }
    }
  }
  return bytes;
}

TEST(DamagedMeshes, MutationsOfGoodFiles) {
  constexpr int kEach = 4000;
  std::mt19937 random(17);  // fixed: a failure can be repeated
  int meshes = 0, errors = 0;
  for (const std::string& good : goodFiles())
    for (int i = 0; i < kEach && !HasFailure(); ++i) {
      const std::string bytes = mutated(good, random);
      const std::string outcome = outcomeOf(bytes, i % 2 ? "m.stl" : "m");
      ++(outcome.rfind("m", 0) == 0 ? errors : meshes);
      if (HasFailure()) ADD_FAILURE() << "file:\n" << bytes;
    }
  // The sampler makes both: changes that leave a mesh and changes that do not.
  EXPECT_GT(meshes, kEach / 10);
  EXPECT_GT(errors, kEach);
}

TEST(DamagedMeshes, CutAnywhere) {
  for (const std::string& good : goodFiles())
    for (std::size_t n = 0; n < good.size(); ++n) outcomeOf(good.substr(0, n), "m.stl");
}

TEST(DamagedMeshes, ADecimalCommaChangesNothing) {
  std::mt19937 random(18);
  std::vector<std::string> files = goodFiles();
  for (std::string& f : files) {
    if (f.find("1 1 0") != std::string::npos) f = with(f, "1 1 0", "1.25 1e-3 0.5");
  }
  const std::size_t good = files.size();
  for (std::size_t i = 0; i < 300; ++i) files.push_back(mutated(files[i % good], random));
  std::vector<std::string> plain;
  for (const std::string& f : files) plain.push_back(outcomeOf(f, "m"));
  const CommaLocale comma;
  for (std::size_t i = 0; i < files.size(); ++i) EXPECT_EQ(outcomeOf(files[i], "m"), plain[i]);
}

/// The collection of files that crashed, hung or were believed. Each is a mesh or one line, as its table says.
TEST(DamagedMeshes, TheCollection) {
  GLINT_NEEDS_SHARED_DATA();
  const fs::path root = fs::path(GLINT_SHARED_DIR) / "data/damaged";
  int tried = 0;
  for (const fs::directory_entry& folder : fs::directory_iterator(root))
    for (const char* name : {"b.ply", "b.obj", "b.stl"}) {
      const fs::path file = folder.path() / name;
      if (!fs::is_regular_file(file)) continue;
      ++tried;
      const std::string outcome = outcomeOf(contentOf(file), file);
      const std::string is = folder.path().filename().string();
      const bool legal = is == "one-triangle-mesh-segv" || is == "ply-long-comment" || is == "obj-mixed-corners" ||
                         is == "camera-1e20-embree-abort";
      EXPECT_EQ(outcome.find(file.string()) == std::string::npos, legal) << outcome;
    }
  EXPECT_GE(tried, 20);
}

}  // namespace
}  // namespace glint

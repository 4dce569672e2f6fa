// SPDX-License-Identifier: BSD-3-Clause
// Every folder of shared/data/damaged (inputs that broke the program once, by other people's generators) with the command that
// its CMD, INFO or README names. Bounds of time and memory are limits of the process, far above the 10 s and 1 GB that the README
// asks for, so that they tell a hang and an explosion on any machine under any load; they measure no speed.
#include <gmock/gmock.h>

#include <map>
#include <set>
#include <tuple>

#include "tests/cli/small_scene.h"
#include "tests/shared_data.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::AnyOf;
using testing::Eq;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

const fs::path kDamaged = fs::path(GLINT_SHARED_DIR) / "data/damaged";

/// Seconds of the processor, and kB of address space (libraries take a part of it). Sanitizers reserve terabytes.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr const char* kBounds = "ulimit -t 400; ";
constexpr const char* kJpegBounds = "";
#else
constexpr const char* kBounds = "ulimit -t 30; ulimit -v 3000000; ";  // the slowest, reflectance-slow-mesh, takes 7 to 11 s
constexpr const char* kJpegBounds = "ulimit -t 15; ";                 // reflectance-slow-jpg took 27 s, and takes 1.2 s
#endif

enum class Expected { Refused, Answered, Either };

struct Case {
  const char* folder;
  const char* arguments;  // run in a copy of the folder; outputs go to its out/
  Expected expected;
  const char* names;  // what the line must name, where the input is refused: the file and, after it, the place
};

constexpr const char* kEvaluate = "evaluate . --models limit-angle --train 0-1 --json out/e.json";
constexpr const char* kReflectance = "evaluate case/scene.json --models reflectance --html out/e.html --csv out/e.csv";

const std::vector<Case> kCases = {
    {"camera-1e20-embree-abort", kEvaluate, Expected::Refused, "scene.json: frames[0].camera_from_world"},
    {"camera-1e20-embree-abort", "reconstruct . --model limit-angle --train 0-1 -o out/x.glint", Expected::Refused,
     "scene.json: frames[0].camera_from_world"},
    {"camera-1e20-embree-abort", "render . --view frame -o out/x.png", Expected::Refused,
     "scene.json: frames[0].camera_from_world"},
    {"obj-mixed-corners", "info scene.json", Expected::Answered, ""},
    {"obj-normal-index-out-of-range", "info scene.json", Expected::Refused, "b.obj: line "},
    {"obj-normal-index-small", "info scene.json", Expected::Either, "b.obj: line "},
    {"obj-texture-index-out-of-range", "info scene.json", Expected::Refused, "b.obj: line "},
    {"obj-texture-index-small", "info scene.json", Expected::Either, "b.obj: line "},
    {"one-triangle-mesh-segv", kEvaluate, Expected::Either, ""},
    {"one-triangle-mesh-segv", "info .", Expected::Either, "scene.json: no camera sees a surface"},
    // None of the 5000 properties is x, y or z, and one of the indices is 1e300: nothing to read, whatever else is legal.
    {"ply-5000-properties", "info scene.json", Expected::Either, "b.ply: header: the vertices lack x, y or z"},
    {"ply-double-indices", "info scene.json", Expected::Either, "b.ply: byte "},
    {"ply-face-index-negative", "info scene.json", Expected::Refused, "b.ply: byte "},
    {"ply-face-index-out-of-range", "info scene.json", Expected::Refused, "b.ply: line "},
    {"ply-face-without-list", "info scene.json", Expected::Refused, "b.ply: header"},
    {"ply-huge-count-no-properties", "info scene.json", Expected::Refused, "b.ply: header"},
    {"ply-list-count-negative", "info scene.json", Expected::Refused, "b.ply: line "},
    {"ply-long-comment", "info scene.json", Expected::Answered, ""},
    {"ply-long-property-name", "info scene.json", Expected::Either, "b.ply: "},
    {"ply-vertex-list-only", "info scene.json", Expected::Refused, "b.ply: line "},
    {"ply-vertex-x-is-list", "info scene.json", Expected::Refused, "b.ply: line "},
    {"ply-x-three-times", "info scene.json", Expected::Refused, "b.ply: "},
    {"reflectance-slow-jpg", kReflectance, Expected::Either, ""},
    {"reflectance-slow-mesh", kReflectance, Expected::Either, ""},
    {"session-folder-loop", "info .", Expected::Refused, "a.glint"},
    {"session-folder-loop", "detect a.glint --json out/d.json", Expected::Refused, "a.glint"},
    {"session-folder-loop", "predict a.glint --json out/p.json", Expected::Refused, "a.glint"},
    {"session-folder-loop", "convert a.glint -o out/c.json", Expected::Refused, "a.glint"},
    {"stl-ascii-broken", "info scene.json", Expected::Refused, "b.stl: line "},
    {"synth-duplicate-ids", "synth badmesh.json -o out/s", Expected::Refused, "badmesh.json: surfaces.s1.mesh"},
    {"synth-duplicate-ids", "synth dupid.json -o out/s", Expected::Refused, "dupid.json: frames[1].id"},
    {"synth-duplicate-ids", "synth duplight.json -o out/s", Expected::Refused, "duplight.json: lights[1].id"},
    {"synth-duplicate-ids", "synth nlid.json -o out/s", Expected::Refused, "nlid.json: frames[0].id"},
    {"synth-duplicate-ids", "synth torus_step.json -o out/s", Expected::Refused, "torus_step.json: surface_steps"},
    {"synth-path-escape", "synth spec.json -o out/deep", Expected::Either, "spec.json: frames[0].id"},
    {"synth-two-meshes-same-name", "synth twomesh.json -o out/s", Expected::Either, "twomesh.json: "},
};

/// Folders with a test of their own below.
const std::set<std::string> kOwnTests = {"exr-offset-wrap", "png-bomb",          "jpeg-png-decoder-lines",
                                         "movie-disk-full", "session-quadratic", "truth-json-exception"};
/// Folders of the inspector: gui-locale-decimal-comma runs under a comma locale, the other two in tests/gui.
const std::set<std::string> kOfTheInspector = {"gui-banner-rich-text", "gui-locale-decimal-comma",
                                               "gui-save-overwrites-recovery-of"};

/// Every file below a folder, but those below its out/, with its content.
std::map<fs::path, std::string> filesBelow(const fs::path& folder) {
  std::map<fs::path, std::string> files;
  for (fs::recursive_directory_iterator it(folder), end; it != end; ++it) {
    if (it.depth() == 0 && it->path().filename() == "out") it.disable_recursion_pending();
    if (it->is_regular_file()) files[it->path()] = contentOf(it->path());
  }
  return files;
}

/// A copy of one folder, with out/ for outputs, inside a folder of its own, so that writing beside it is seen.
class Copy {
 public:
  explicit Copy(const std::string& name)
      : folder_(outer_ / "copy"), bounds_(std::string(kBounds) + (name == "reflectance-slow-jpg" ? kJpegBounds : "")) {
    fs::copy(kDamaged / name, folder_, fs::copy_options::recursive);
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(outer_.path()))
      fs::permissions(entry.path(), fs::perms::owner_write, fs::perm_options::add);
    fs::permissions(folder_, fs::perms::owner_write, fs::perm_options::add);
    fs::create_directories(folder_ / "out");
  }
  const fs::path& folder() const { return folder_; }
  ProgramRun run(const std::string& arguments) const {
    const std::map<fs::path, std::string> before = filesBelow(outer_.path());
    const ProgramRun run = runGlint(arguments, "cd '" + folder_.string() + "'; " + bounds_);
    const std::map<fs::path, std::string> after = filesBelow(outer_.path());
    for (const auto& [file, content] : after)
      EXPECT_TRUE(isOutput(file) || (before.count(file) && before.at(file) == content))
          << file << " was written by: " << arguments;
    for (const auto& [file, content] : before)
      EXPECT_TRUE(isOutput(file) || after.count(file)) << file << " was removed by: " << arguments;
    return run;
  }

 private:
  bool isOutput(const fs::path& file) const { return file.string().rfind((folder_ / "out").string() + "/", 0) == 0; }
  TemporaryFolder outer_;
  fs::path folder_;
  std::string bounds_;
};

/// A refusal has one line of at most 400 characters, an answer at most one; no run ends by a signal.
void expectManners(const ProgramRun& run, Expected expected) {
  EXPECT_THAT(run.code, AnyOf(Eq(0), Eq(2), Eq(3))) << run.err;
  if (expected == Expected::Refused) {
    EXPECT_THAT(run.code, AnyOf(Eq(2), Eq(3)));
  }
  if (expected == Expected::Answered) {
    EXPECT_EQ(run.code, 0) << run.err;
  }
  EXPECT_LE(run.errorLines(), 1) << run.err;
  if (run.code != 0) {
    EXPECT_EQ(run.errorLines(), 1) << run.err;
    EXPECT_THAT(run.err, StartsWith("glint: "));
    EXPECT_THAT(run.err, testing::Not(HasSubstr("out of memory"))) << "the bound of memory of this test was reached";
  }
  constexpr std::size_t kLongestLine = 400;
  EXPECT_LE(run.err.size(), kLongestLine + 1) << run.err;
}

class Damaged : public testing::TestWithParam<Case> {};

TEST_P(Damaged, EndsInOneLineOrAnAnswer) {
  GLINT_NEEDS_SHARED_DATA();
  const Case& c = GetParam();
  if (!fs::exists(kDamaged / c.folder)) GTEST_SKIP() << "the data beside the project has no " << c.folder;
  const Copy copy(c.folder);
  const ProgramRun run = copy.run(c.arguments);
  expectManners(run, c.expected);
  if (run.code != 0) {
    EXPECT_THAT(run.err, HasSubstr(c.names));
  }
  // What is refused leaves no output behind; the folder that the test made is empty.
  if (run.code == 2) {
    EXPECT_EQ(run.out, "");
    EXPECT_TRUE(fs::is_empty(copy.folder() / "out")) << "something was written all the same";
  }
}

INSTANTIATE_TEST_SUITE_P(, Damaged, testing::ValuesIn(kCases), [](const testing::TestParamInfo<Case>& info) {
  std::string name = std::to_string(info.index) + "_" + info.param.folder;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

TEST(DamagedFolders, EachHasATest) {
  GLINT_NEEDS_SHARED_DATA();
  std::set<std::string> known = kOwnTests;
  known.insert(kOfTheInspector.begin(), kOfTheInspector.end());
  for (const Case& c : kCases) known.insert(c.folder);
  for (const fs::directory_entry& entry : fs::directory_iterator(kDamaged))
    EXPECT_TRUE(!entry.is_directory() || known.count(entry.path().filename()))
        << entry.path() << " is new: give it a row or a test";
}

/// A scene of 64 x 48 with one picture of that name, at the place of the third frame of four.
std::string sceneWithFrame(const std::string& key, const std::string& file) {
  std::string frames;
  for (int i = 0; i < 4; ++i)
    frames += std::string(i ? "," : "") + R"({"id":")" + std::to_string(i) + R"(",)" +
              (i == 3 ? "\"" + key + "\":\"" + file + "\"," : "") + R"("camera_from_world":[[1,0,0,0.)" + std::to_string(i) +
              R"(],[0,1,0,0],[0,0,1,2],[0,0,0,1]]})";
  return R"({"glint_scene":1,"camera":{"width":64,"height":48,"fx":80,"fy":80,"cx":31.5,"cy":23.5},"frames":[)" + frames +
         R"(],"surfaces":{"s":{"analytic":{"type":"sphere","radius":0.4}}}})";
}

/// One frame's damaged picture is a line of the report, and the rest of the scene is read. Detection, which has no other frame,
/// ends with 3.
void expectFrameRefused(const Copy& copy, const std::string& file) {
  const ProgramRun info = copy.run("info fed.json");
  expectManners(info, Expected::Answered);
  EXPECT_THAT(info.out, HasSubstr(file));
  const ProgramRun detected = copy.run("detect fed.json");
  expectManners(detected, Expected::Refused);
}

TEST(DamagedFolders, ImagesThatAreLargerThanTheySayAreRefusedBeforeDecoding) {
  GLINT_NEEDS_SHARED_DATA();
  for (const auto& [folder, file, key] :
       {std::tuple("exr-offset-wrap", "0003.exr", "radiance"), std::tuple("png-bomb", "0003.png", "image")}) {
    const Copy copy(folder);
    std::ofstream(copy.folder() / "fed.json") << sceneWithFrame(key, file);
    expectFrameRefused(copy, file);
  }
}

/// The log of INFO is of an EXR with a damaged attribute; the other decoders have their own ways to write lines.
TEST(DamagedFolders, DecodersWriteNoLinesOfTheirOwn) {
  GLINT_NEEDS_SHARED_DATA();
  const std::string exr = contentOf(kDamaged / "exr-offset-wrap/0003.exr");
  const std::string jpeg = contentOf(kDamaged / "reflectance-slow-jpg/case/frames/0003.jpg");
  const std::string png = contentOf(kDamaged / "png-bomb/0003.png").substr(0, 4096);
  ASSERT_FALSE(exr.empty() || jpeg.empty() || png.empty());
  std::string attribute = exr, type = exr;
  const std::size_t at = exr.find("pixelAspectRatio");
  ASSERT_NE(at, std::string::npos);
  attribute.replace(at, 5, "pixeL");
  type.replace(exr.find("float", at), 5, "flOat");
  std::string noisy = jpeg;
  noisy.insert(noisy.size() / 2, std::string(300, '\x11'));
  for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"a.exr", attribute},
                                    {"b.exr", type},
                                    {"c.jpg", jpeg},
                                    {"d.jpg", noisy},
                                    {"e.jpg", jpeg.substr(0, jpeg.size() / 2)},
                                    {"f.png", png}}) {
    const Copy copy("jpeg-png-decoder-lines");
    std::ofstream(copy.folder() / name, std::ios::binary) << bytes;
    std::ofstream(copy.folder() / "fed.json")
        << sceneWithFrame(name.find("exr") != std::string::npos ? "radiance" : "image", name);
    expectManners(copy.run("info fed.json"), Expected::Either);
    expectManners(copy.run("detect fed.json"), Expected::Either);
  }
}

class DamagedBesideScene : public SmallScene {};

TEST_F(DamagedBesideScene, MovieOnAFullDiskIsOneLine) {
  saveSession("--model limit-angle");
  // No file may grow beyond 8 kB, as on a disk with that much left.
  const ProgramRun run = onSession("movie", "--of timeline --size 320x240 -o " + out("m.mp4"), "ulimit -f 8;");
  expectManners(run, Expected::Refused);
  EXPECT_THAT(run.err, HasSubstr("m.mp4"));
  EXPECT_FALSE(fs::exists(folder_ / "m.mp4"));
}

TEST_F(DamagedBesideScene, SessionWithManyKeysIsReadInProportion) {
  saveSession("--model limit-angle");
  Json session = Json::parse(contentOf(folder_ / "run.glint"));
  session["x"] = Json::object();
  session["y"] = Json::array();
  for (int i = 0; i < 100000; ++i) session["x"][std::to_string(i)] = i;      // make.py of the folder
  for (int i = 0; i < 1000000; ++i) session["y"].push_back(Json::object());  // and the other sizes that its first line names
  folder_.write("run.glint", session.dump());
  const ProgramRun run = onSession("info", "", kBounds);
  expectManners(run, Expected::Answered);
}

TEST_F(DamagedBesideScene, TruthOfTheWrongTypeNamesItsPlace) {
  for (int i = 0; i < kFrames; ++i) folder_.write("t/000" + std::to_string(i) + ".json", R"({"levels":5})");
  const ProgramRun run = on("evaluate", "--models limit-angle --truth " + out("t"));
  expectManners(run, Expected::Refused);
  EXPECT_THAT(run.err, testing::ContainsRegex("t/000[0-9].json: levels: must be an object, is a number"));
}

}  // namespace
}  // namespace glint

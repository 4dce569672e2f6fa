// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <random>
#include <sstream>
#include <tuple>

#include "core/base/permitted.h"
#include "core/scene/capture.h"
#include "tests/core/scene/png_fixture.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/tolerances.h"

namespace glint::tum_tests {
namespace {
using namespace testing_support;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

CaptureOptions withTumCamera() {
  CaptureOptions options;
  options.camera.emplace();
  options.camera->pixelFromRay << 100, 0, 31.5, 0, 110, 23.5, 0, 0, 1;
  return options;
}

Capture readTum(const fs::path& folder, const CaptureOptions& options = withTumCamera()) {
  const auto reader = makeTumReader();
  return reader->read(reader->recognise(folder), options);
}

std::string tumError(const fs::path& folder, const CaptureOptions& options = withTumCamera()) {
  return inputErrorOf([&] { makeTumReader()->read(folder / "rgb.txt", options); });
}

/// Three photographs, three poses, two depth images. The times are of the benchmark's size and number of digits.
struct TumFolder : TemporaryFolder {
  TumFolder() {
    write("rgb.txt",
          "# color images\n# timestamp filename\n1305031102.175304 rgb/1305031102.175304.png\n"
          "1305031102.211214 rgb/1305031102.211214.png\n1305031102.243211 rgb/1305031102.243211.png\n");
    write("groundtruth.txt",
          "# timestamp tx ty tz qx qy qz qw\n1305031102.1758 1 2 3 0 0 0.70710678118654752 0.70710678118654752\n"
          "1305031102.2158 4 5 6 0 0 0 1\n1305031102.2458 7 8 9 0 0 0 1\n");
    write("depth.txt", "1305031102.160407 depth/1305031102.160407.png\n1305031102.226738 depth/1305031102.226738.png\n");
    for (const char* name : {"rgb/1305031102.175304.png", "rgb/1305031102.211214.png", "rgb/1305031102.243211.png"})
      write(name, pngOfSize(64, 48));
  }
  /// Replaces `from` in one of the files.
  void change(const std::string& name, const std::string& from, const std::string& to) const {
    write(name, with(contentOf(*this / name), from, to));
  }
};

TEST(TumCapture, PoseIsCameraToWorldWithTheQuaternionsWLast) {
  const TumFolder folder;
  const Capture capture = readTum(folder.path());
  ASSERT_EQ(capture.views.size(), 3u);
  const Eigen::Isometry3d& camFromWorld = capture.views[0].camera.camFromWorld;
  // The camera stands at (1, 2, 3), turned by 90 degrees about the world's z: its x is the world's y, its y the world's -x.
  EXPECT_LT((camFromWorld * Eigen::Vector3d(1, 2, 3)).norm(), tolerance::kExact);
  EXPECT_LT((camFromWorld * Eigen::Vector3d(1, 3, 3) - Eigen::Vector3d::UnitX()).norm(), tolerance::kExact);
  EXPECT_LT((camFromWorld * Eigen::Vector3d(0, 2, 3) - Eigen::Vector3d::UnitY()).norm(), tolerance::kExact);
  // And it looks along +z.
  EXPECT_LT((camFromWorld * Eigen::Vector3d(1, 2, 5) - Eigen::Vector3d(0, 0, 2)).norm(), tolerance::kExact);
  EXPECT_EQ(capture.metresPerUnit, 1);
  EXPECT_TRUE(capture.hasScale);
}

TEST(TumCapture, NamesPathsAndSources) {
  const TumFolder folder;
  const Capture capture = readTum(folder.path());
  EXPECT_EQ(capture.kind, "tum");
  EXPECT_EQ(capture.file, folder / "rgb.txt");
  EXPECT_EQ(capture.folder, folder.path());
  EXPECT_THAT(capture.sources, ElementsAre(folder / "rgb.txt", folder / "groundtruth.txt", folder / "depth.txt"));
  EXPECT_EQ(capture.views[1].name, "rgb/1305031102.211214.png");
  EXPECT_EQ(capture.views[1].image, folder / "rgb/1305031102.211214.png");
  EXPECT_TRUE(capture.views[1].mask.empty());
  EXPECT_FALSE(capture.mesh);
}

TEST(TumCapture, IntrinsicsAreTheGivenOnesWithoutAnyShift) {
  const TumFolder folder;
  CaptureOptions options = withTumCamera();
  options.camera->pixelFromRay(0, 1) = 0.25;
  options.camera->lens.parameters = {0.1, -0.2, 0.001, 0.002, 0.3};
  options.camera->camFromWorld.translation().x() = 77;  // to be ignored, as its size is
  options.camera->width = options.camera->height = 7;
  for (const CaptureView& view : readTum(folder.path(), options).views) {
    Eigen::Matrix3d k;
    k << 100, 0.25, 31.5, 0, 110, 23.5, 0, 0, 1;
    EXPECT_EQ(view.camera.pixelFromRay, k);
    EXPECT_TRUE(view.camera.lens == options.camera->lens);
    EXPECT_EQ(view.camera.width, 64);
    EXPECT_EQ(view.camera.height, 48);
    EXPECT_NE(view.camera.camFromWorld.translation().x(), 77);
  }
}

TEST(TumCapture, WithoutIntrinsicsItSaysWhatToGive) {
  const TumFolder folder;
  EXPECT_THAT(tumError(folder.path(), {}), AllOf(HasSubstr("--camera fx,fy,cx,cy[,k1,k2,p1,p2,k3]"), HasSubstr("no intrinsics")));
}

TEST(TumCapture, MissingIntrinsicsAreAQuestion) {
  const TumFolder folder;
  try {
    makeTumReader()->read(folder / "rgb.txt", {});
    FAIL() << "nothing thrown";
  } catch (const UndecidedInput& undecided) {
    EXPECT_EQ(undecided.question(), UndecidedInput::Question::Camera);
    EXPECT_TRUE(undecided.answers().empty());  // any numbers
  }
}

TEST(TumCapture, DepthIsFiveThousandthsOfAMetreAndNearestInTime) {
  // 175304 - 160407 = 14.9 ms; 226738 is 15.5 ms from the second and 16.5 ms from the third photograph, and only one may have
  // it.
  const TumFolder folder;
  const Capture capture = readTum(folder.path());
  EXPECT_EQ(capture.views[0].depth, folder / "depth/1305031102.160407.png");  // which does not exist: not checked
  EXPECT_EQ(capture.views[1].depth, folder / "depth/1305031102.226738.png");
  EXPECT_TRUE(capture.views[2].depth.empty());
  EXPECT_DOUBLE_EQ(5000 * capture.views[0].depthScale, 1.0);
  EXPECT_EQ(capture.views[2].depthScale, 0);
  EXPECT_THAT(capture.warnings, ElementsAre(HasSubstr("1 photograph has no depth image within 20 ms")));
}

TEST(TumCapture, WithoutDepthListThereIsNoDepth) {
  const TumFolder folder;
  fs::remove(folder / "depth.txt");
  const Capture capture = readTum(folder.path());
  EXPECT_THAT(capture.warnings, IsEmpty());
  EXPECT_THAT(capture.facts, Contains(HasSubstr("no depth")));
  EXPECT_EQ(capture.sources.size(), 2u);
  for (const CaptureView& view : capture.views) EXPECT_TRUE(view.depth.empty());
}

TEST(TumCapture, TwentyMillisecondsAreNearAndMoreIsNot) {
  const TumFolder folder;
  folder.write("rgb.txt",
               "1305031102.1 rgb/1305031102.175304.png\n1305031103.1 rgb/1305031102.211214.png\n"
               "1305031104.1 rgb/1305031102.243211.png\n");
  folder.write("groundtruth.txt",
               "1305031102.080000 1 0 0 0 0 0 1\n1305031103.120000 2 0 0 0 0 0 1\n1305031104.120010 3 0 0 0 0 0 1\n");
  const Capture capture = readTum(folder.path());
  ASSERT_EQ(capture.views.size(), 2u);
  EXPECT_EQ(capture.views[0].name, "rgb/1305031102.175304.png");
  EXPECT_EQ(capture.views[1].name, "rgb/1305031102.211214.png");
  EXPECT_THAT(capture.warnings, Contains(AllOf(HasSubstr("1 photograph of 3"), HasSubstr("left out"))));
}

TEST(TumCapture, TheClosestPairGoesFirstAndAPoseIsUsedOnce) {
  // Photographs at 0 and 10 ms, poses at 6 and 25 ms. 10-6 is closest; 25 is too far from the photograph at 0, which has
  // nothing left. The nearest for each alone would take the pose at 6 twice; in the order of the file both would have one.
  const TumFolder folder;
  folder.write("rgb.txt", "7.000 rgb/1305031102.175304.png\n7.010 rgb/1305031102.211214.png\n");
  folder.write("groundtruth.txt", "7.006 6 0 0 0 0 0 1\n7.025 25 0 0 0 0 0 1\n");
  fs::remove(folder / "depth.txt");
  const Capture capture = readTum(folder.path());
  ASSERT_EQ(capture.views.size(), 1u);
  EXPECT_EQ(capture.views[0].name, "rgb/1305031102.211214.png");
  EXPECT_NEAR(capture.views[0].camera.camFromWorld.translation().x(), -6, tolerance::kExact);
}

/// TUM's rule word by word: the table of all pairs that are near enough, sorted; each in turn if both are still free.
std::vector<int> tumTable(const std::vector<double>& times, const std::vector<double>& others) {
  std::vector<std::tuple<double, double, double, std::size_t, std::size_t>> table;
  for (std::size_t i = 0; i < times.size(); ++i)
    for (std::size_t k = 0; k < others.size(); ++k)
      if (std::abs(times[i] - others[k]) < 0.02) table.emplace_back(std::abs(times[i] - others[k]), times[i], others[k], i, k);
  std::sort(table.begin(), table.end());
  std::vector<int> pairs(times.size(), -1);
  std::vector<bool> used(others.size());
  for (const auto& [apart, a, b, i, k] : table)
    if (pairs[i] < 0 && !used[k]) {
      pairs[i] = int(k);
      used[k] = true;
    }
  return pairs;
}

TEST(TumCapture, PairsAreThoseOfTheTableOfAllPairs) {
  std::mt19937 random(20121007);
  for (const double seconds : {0.5, 2.0, 8.0}) {  // crowded, as in the benchmark, sparse
    const auto someTimes = [&](std::size_t n) {
      std::vector<double> times;
      for (std::size_t i = 0; i < n; ++i)
        times.push_back(1305031102 + std::round(1e6 * std::uniform_real_distribution<double>(0, seconds)(random)) / 1e6);
      return times;  // not in order
    };
    const std::vector<double> photographs = someTimes(60), poses = someTimes(200), depths = someTimes(70);
    const TemporaryFolder folder;
    const auto list = [](const std::vector<double>& times, const std::string& before, const std::string& after) {
      std::ostringstream out;
      out << std::fixed << std::setprecision(6);
      for (std::size_t i = 0; i < times.size(); ++i) out << times[i] << " " << before << 100 + i << after << "\n";
      return out.str();
    };
    folder.write("rgb.txt", list(photographs, "", ".png"));
    folder.write("depth.txt", list(depths, "depth/", ".png"));
    folder.write("groundtruth.txt", list(poses, "", " 0 0 0 0 0 1"));  // tx = 100 + its place in the list
    for (std::size_t i = 0; i < photographs.size(); ++i) folder.write(std::to_string(100 + i) + ".png", pngOfSize(64, 48));
    const std::vector<int> pose = tumTable(photographs, poses), depth = tumTable(photographs, depths);
    const Capture capture = readTum(folder.path());
    std::size_t v = 0;
    for (std::size_t i = 0; i < photographs.size(); ++i) {
      if (pose[i] < 0) continue;
      ASSERT_LT(v, capture.views.size());
      const CaptureView& view = capture.views[v++];
      ASSERT_EQ(view.name, std::to_string(100 + i) + ".png");
      EXPECT_NEAR(view.camera.camFromWorld.translation().x(), -(100 + pose[i]), tolerance::kExact) << view.name;
      EXPECT_EQ(view.depth.filename(), depth[i] < 0 ? "" : std::to_string(100 + depth[i]) + ".png") << view.name;
    }
    EXPECT_EQ(v, capture.views.size());
    if (seconds > 1) {
      EXPECT_GT(v, 20u);  // the sampler makes the cases
      EXPECT_LT(v, 61u);
    }
  }
}

TEST(TumCapture, ManyEqualTimesDoNotFillTheMemory) {
  // The table of all pairs would have 2.5e8 rows.
  const TumFolder folder;
  std::string rgb, poses;
  for (int i = 0; i < 1000; ++i) rgb += formatted("%.6f", 5 + 1e-6 * i) + " rgb/1305031102.175304.png\n";
  for (int i = 0; i < 250000 / 4; ++i)
    poses += "5 0 0 0 0 0 0 1\n5.001 0 0 0 0 0 0 1\n5.002 0 0 0 0 0 0 1\n5.003 0 0 0 0 0 0 1\n";
  folder.write("rgb.txt", rgb);
  folder.write("groundtruth.txt", poses);
  EXPECT_EQ(readTum(folder.path()).views.size(), 1u);
}

TEST(TumCapture, AnImageThatIsListedTwiceCountsOnce) {
  const TumFolder folder;
  const std::string rgb = contentOf(folder / "rgb.txt");
  folder.write("rgb.txt", rgb + rgb);
  const Capture capture = readTum(folder.path());
  EXPECT_EQ(capture.views.size(), 3u);
  EXPECT_THAT(capture.warnings, Contains(AllOf(HasSubstr("rgb.txt: line "), HasSubstr("says the same as a line before"))));
}

TEST(TumCapture, TimesMayBeInNanoseconds) {
  const TumFolder folder;
  for (const char* list : {"rgb.txt", "depth.txt", "groundtruth.txt"}) {
    std::istringstream lines(contentOf(folder / list));
    std::string text;
    for (std::string line; std::getline(lines, line);)
      if (const std::size_t dot = line.find('.'), end = line.find(' '); !line.empty() && line[0] != '#' && dot < end)
        text += line.substr(0, dot) + (line.substr(dot + 1, end - dot - 1) + "000000000").substr(0, 9) + line.substr(end) + "\n";
    folder.write(list, text);
  }
  const Capture seconds = readTum(TumFolder().path()), nanoseconds = readTum(folder.path());
  ASSERT_EQ(nanoseconds.views.size(), seconds.views.size());
  for (std::size_t i = 0; i < seconds.views.size(); ++i) {
    EXPECT_EQ(nanoseconds.views[i].camera.camFromWorld.matrix(), seconds.views[i].camera.camFromWorld.matrix());
    EXPECT_EQ(nanoseconds.views[i].depth.filename(), seconds.views[i].depth.filename());
  }
}

TEST(TumCapture, ViewsAreOrderedByName) {
  const TumFolder folder;
  folder.write("rgb.txt", "1305031102.243211 rgb/1305031102.243211.png\n1305031102.175304 rgb/1305031102.175304.png\n");
  const Capture capture = readTum(folder.path());
  ASSERT_EQ(capture.views.size(), 2u);
  EXPECT_EQ(capture.views[0].name, "rgb/1305031102.175304.png");
  EXPECT_LT((capture.views[0].camera.camFromWorld * Eigen::Vector3d(1, 2, 3)).norm(),
            tolerance::kExact);  // its pose goes with it
}

TEST(TumCapture, LineEndsTabsAndBlanksDoNotMatter) {
  const TumFolder folder;
  std::string text = contentOf(folder / "groundtruth.txt"), crlf;
  for (const char c : text) crlf += c == '\n' ? "\r\n" : c == ' ' ? "\t " : std::string(1, c);
  folder.write("groundtruth.txt", crlf + "\r\n  # the end\r\n");
  folder.write("rgb.txt", "  1305031102.175304\t rgb/1305031102.175304.png  \r\n\r\n#1 2 3\r\n");
  const Capture capture = readTum(folder.path());
  ASSERT_EQ(capture.views.size(), 1u);
  EXPECT_EQ(capture.views[0].image, folder / "rgb/1305031102.175304.png");
  EXPECT_LT((capture.views[0].camera.camFromWorld * Eigen::Vector3d(1, 2, 3)).norm(), tolerance::kExact);
}

TEST(TumCapture, NoneWithAPoseIsAnError) {
  const TumFolder folder;
  folder.write("groundtruth.txt", "17 0 0 0 0 0 0 1\n");
  EXPECT_THAT(tumError(folder.path()),
              AllOf(HasSubstr("groundtruth.txt"), HasSubstr("no pose within 20 ms"), HasSubstr("17.000000")));
  folder.write("groundtruth.txt", "# nothing\n");
  EXPECT_THAT(tumError(folder.path()), HasSubstr("has no pose"));
  folder.write("rgb.txt", "");
  EXPECT_THAT(tumError(folder.path()), HasSubstr("names no photograph"));
}

TEST(TumCapture, LostTrackingIsPassedOver) {
  const TumFolder folder;
  folder.write("groundtruth.txt", "1305031102.1753 nan nan nan nan nan nan nan\n" + contentOf(folder / "groundtruth.txt"));
  const Capture capture = readTum(folder.path());
  EXPECT_EQ(capture.views.size(), 3u);
  EXPECT_TRUE(capture.views[0].camera.camFromWorld.matrix().allFinite());
  EXPECT_THAT(capture.warnings,
              Contains(HasSubstr("groundtruth.txt: line 1: no finite pose (tracking was lost); it is left out")));
}

/// As a full disk leaves the last line.
TEST(TumCapture, ALineThatIsCutCostsItsPhotograph) {
  const TumFolder folder;
  folder.change("groundtruth.txt", "4 5 6 0", "4 5 6");
  const Capture poses = readTum(folder.path());
  EXPECT_EQ(poses.views.size(), 2u);
  EXPECT_THAT(poses.warnings,
              Contains(HasSubstr("groundtruth.txt: line 3: has fewer numbers than a pose (a cut line?); it is left out")));
  folder.write("groundtruth.txt", "1305031102.1753 1 2 3\n");
  EXPECT_THAT(tumError(folder.path()), HasSubstr("groundtruth.txt: line 1: must be 8 numbers"));
  const TumFolder other;
  other.change("rgb.txt", "1305031102.211214 rgb/1305031102.211214.png", "1305031102.211214");
  const Capture photographs = readTum(other.path());
  EXPECT_EQ(photographs.views.size(), 2u);
  EXPECT_THAT(photographs.warnings,
              Contains(HasSubstr("rgb.txt: line 4: is not a time and a path (a cut line?); it is left out")));
}

/// As programs write it where they have lost the camera.
TEST(TumCapture, AQuaternionOfZerosCostsItsFrame) {
  const TumFolder folder;
  folder.change("groundtruth.txt", "4 5 6 0 0 0 1", "4 5 6 0 0 0 0");
  const Capture capture = readTum(folder.path());
  EXPECT_EQ(capture.views.size(), 2u);
  EXPECT_THAT(capture.warnings, Contains(HasSubstr("groundtruth.txt: line 3: no finite pose (tracking was lost)")));
}

TEST(TumCapture, LongQuaternionsAreNormalisedAndCounted) {
  const TemporaryFolder folder;
  std::string rgb, poses;
  for (int i = 10; i < 30; ++i) {
    rgb += std::to_string(i) + " " + std::to_string(i) + ".png\n";
    poses += std::to_string(i) + " 0 0 1 0 0 0 3\n";
    folder.write(std::to_string(i) + ".png", pngOfSize(64, 48));
  }
  folder.write("rgb.txt", rgb);
  folder.write("groundtruth.txt", poses);
  const Capture capture = readTum(folder.path());
  EXPECT_TRUE(capture.views[3].camera.camFromWorld.linear().isApprox(Eigen::Matrix3d::Identity(), tolerance::kExact));
  ASSERT_EQ(capture.warnings.size(), 9u);
  EXPECT_THAT(capture.warnings[0], HasSubstr("groundtruth.txt: line 1"));
  EXPECT_THAT(capture.warnings[8], HasSubstr("and 12 more"));
}

TEST(TumCapture, DamagedLinesAreNamed) {
  struct Row {
    const char *file, *from, *to, *message;
  };
  for (const Row& row : {
           Row{"rgb.txt", "1305031102.211214 rgb", "x rgb", "rgb.txt: line 4: 'x' is not a number"},
           Row{"rgb.txt", "1305031102.211214 rgb", "nan rgb", "rgb.txt: line 4: 'nan' is not a number"},
           Row{"rgb.txt", "1305031102.211214 rgb", "1305031102.211214 a rgb", "rgb.txt: line 4: must be a time and a path"},
           Row{"rgb.txt", "rgb/1305031102.211214.png", "../x.png", "leaves the folder"},
           Row{"rgb.txt", "rgb/1305031102.211214.png", "/x.png", "is absolute"},
           Row{"rgb.txt", "rgb/1305031102.211214.png", "rgb/1305031102.175304.png", "two images are called"},
           Row{"depth.txt", "depth/1305031102.160407.png", "../../x.png", "depth.txt: line 1: '../../x.png' leaves the folder"},
           Row{"depth.txt", "1305031102.160407", "?", "depth.txt: line 1: '?' is not a number"},
           Row{"groundtruth.txt", "4 5 6 0", "4 5 6 0 0", "groundtruth.txt: line 3: must be 8 numbers"},
           Row{"groundtruth.txt", "4 5 6 0", "4 5 six 0", "groundtruth.txt: line 3: 'six' is not a number"},
           Row{"groundtruth.txt", "4 5 6 0", "4 5 1e99 0", "groundtruth.txt: line 3: 1e+99 is larger than"},
           Row{"groundtruth.txt", "4 5 6 0", "4 5 6 inf0", "groundtruth.txt: line 3: 'inf0' is not a number"},
       }) {
    const TumFolder folder;
    folder.change(row.file, row.from, row.to);
    EXPECT_THAT(tumError(folder.path()), HasSubstr(row.message)) << row.to;
  }
}

TEST(TumCapture, BinaryRubbishIsRefusedWithoutACrash) {
  const TumFolder folder;
  std::string rubbish;
  for (int i = 0; i < 4000; ++i) rubbish += static_cast<char>(i * 7919 % 256);
  for (const char* name : {"rgb.txt", "groundtruth.txt", "depth.txt"}) {
    const std::string before = contentOf(folder / name);
    folder.write(name, rubbish);
    EXPECT_THAT(tumError(folder.path()), HasSubstr(name));
    folder.write(name, before);
  }
}

TEST(TumCapture, ImagesOfAnotherSizeAndMissingOnes) {
  const TumFolder folder;
  folder.write("rgb/1305031102.243211.png", pngOfSize(48, 64));
  EXPECT_THAT(tumError(folder.path()), AllOf(HasSubstr("1305031102.243211.png"), HasSubstr("48 x 64"), HasSubstr("64 x 48")));
  fs::remove(folder / "rgb/1305031102.243211.png");
  fs::remove(folder / "rgb/1305031102.175304.png");
  EXPECT_EQ(readTum(folder.path()).views.at(2).camera.width, 64);  // the second photograph says it
  fs::remove(folder / "rgb/1305031102.211214.png");
  EXPECT_THAT(tumError(folder.path()), HasSubstr("--photographs"));
}

TEST(TumCapture, PhotographsMayLieElsewhereAndDepthIsNotTakenFromThere) {
  const TumFolder folder;
  const TemporaryFolder elsewhere;
  folder.change("depth.txt", "depth/1305031102.160407.png", "depth/1305031102.175304.png");  // as ICL-NUIM names them
  elsewhere.write("1305031102.175304.png", pngOfSize(64, 48));
  CaptureOptions options = withTumCamera();
  options.photographs = {elsewhere.path()};
  const Capture capture = readTum(folder.path(), options);
  EXPECT_EQ(capture.views[0].image, elsewhere / "1305031102.175304.png");
  EXPECT_EQ(capture.views[0].depth, folder / "depth/1305031102.175304.png");
  EXPECT_EQ(capture.views[1].image, folder / "rgb/1305031102.211214.png");
}

TEST(TumCapture, AListThatIsALinkToElsewhereIsNotFollowed) {
  const TumFolder folder;
  const TemporaryFolder elsewhere;
  fs::rename(folder / "groundtruth.txt", elsewhere.write("secret.txt", ""));
  fs::create_symlink(elsewhere / "secret.txt", folder / "groundtruth.txt");
  EXPECT_THROW(makeTumReader()->read(folder / "rgb.txt", withTumCamera()), OutsidePath);
  CaptureOptions options = withTumCamera();
  options.rights.folders = {elsewhere.path()};
  EXPECT_EQ(readTum(folder.path(), options).views.size(), 3u);
}

TEST(TumCapture, IsRecognisedByItsFiles) {
  const auto reader = makeTumReader();
  const TumFolder folder;
  EXPECT_EQ(reader->name(), "tum");
  EXPECT_EQ(reader->recognise(folder.path()), folder / "rgb.txt");
  EXPECT_EQ(reader->recognise(folder / "rgb.txt"), folder / "rgb.txt");
  EXPECT_EQ(reader->recognise(folder / "depth.txt"), "");
  EXPECT_EQ(reader->recognise(folder / "missing"), "");
  EXPECT_EQ(reader->recognise(""), "");
  fs::remove(folder / "groundtruth.txt");
  EXPECT_EQ(reader->recognise(folder.path()), "");
  EXPECT_THAT(tumError(folder.path()), HasSubstr("groundtruth.txt"));
}

TEST(TumCapture, OtherListsAreNotRecognised) {
  const auto reader = makeTumReader();
  const TumFolder folder;
  for (const char* text :
       {"", "# only comments\n", "rgb/1.png\n", "1 2 3\n", "1 rgb/1.png 2 depth/1.png\n", "1 2\n", "{\"a\": 1}\n"}) {
    folder.write("rgb.txt", text);
    EXPECT_EQ(reader->recognise(folder.path()), "") << text;
  }
  fs::remove(folder / "rgb.txt");
  fs::create_directory(folder / "rgb.txt");
  EXPECT_EQ(reader->recognise(folder.path()), "");
  EXPECT_EQ(reader->recognise(folder / "rgb.txt"), "");
}

}  // namespace
}  // namespace glint::tum_tests

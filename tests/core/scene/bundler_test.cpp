// SPDX-License-Identifier: BSD-3-Clause
// Files by hand, after Bundler's manual: P = R X + t, p = -P / P.z, p' = f r(p) p, from the image's middle with y up.
#include <gmock/gmock.h>

#include "core/scene/capture.h"
#include "tests/core/scene/sfm_fixture.h"
#include "tests/tolerances.h"

namespace glint::bundler_tests {
namespace {
using namespace testing_support;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// Three cameras, of which the second is not registered, and one point that all see. The first stands at the origin, looks along
/// -z and has y up; the third is turned by 90 degrees about z and moved.
std::string smallBundle() {
  return "# Bundle file v0.3\n3 1\n"
         "100 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 0\n"
         "0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n"
         "80 0 0\n0 -1 0\n1 0 0\n0 0 1\n3 -1 -2\n"
         "1 2 -5\n10 20 30\n3 0 7 20 40 1 8 1 1 2 3 0.5 -0.25\n";
}
std::string smallList() { return "c.pgm 0 500.5\nb.pgm\na.pgm 0\n"; }

void writeBundlerImages(const TemporaryFolder& folder, const std::string& below = "") {
  writeBlackImage(folder, below + "c.pgm", 64, 48);
  writeBlackImage(folder, below + "a.pgm", 33, 20);
}

struct BundlerRead {
  Capture capture;
  std::vector<CaptureTrack> tracks;
};
BundlerRead readBundlerText(const TemporaryFolder& folder, const std::string& bundle, const std::string& list = smallList()) {
  const auto reader = makeBundlerReader();
  folder.write("list.txt", list);
  const Capture capture = reader->read(folder.write("bundle.out", bundle), {});
  return {capture, reader->tracks(capture, {})};
}

TEST(Bundler, ViewsAreOrderedAndThePrincipalPointIsTheMiddleOfEachImage) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const Capture c = readBundlerText(folder, smallBundle()).capture;
  EXPECT_EQ(c.kind, "bundler");
  EXPECT_EQ(c.file, folder / "bundle.out");
  EXPECT_EQ(c.folder, folder.path());
  EXPECT_THAT(c.sources, ElementsAre(folder / "bundle.out", folder / "list.txt"));
  EXPECT_FALSE(c.hasScale);
  ASSERT_EQ(c.views.size(), 2u);
  EXPECT_EQ(c.views[0].name, "a.pgm");
  EXPECT_EQ(c.views[0].image, folder / "a.pgm");
  EXPECT_EQ(c.views[1].name, "c.pgm");
  EXPECT_EQ(c.views[1].camera.width, 64);
  EXPECT_EQ(c.views[1].camera.height, 48);
  EXPECT_EQ(c.views[1].camera.pixelFromRay, (Eigen::Matrix3d() << 100, 0, 31.5, 0, 100, 23.5, 0, 0, 1).finished());
  EXPECT_EQ(c.views[0].camera.pixelFromRay, (Eigen::Matrix3d() << 80, 0, 16, 0, 80, 9.5, 0, 0, 1).finished());
  EXPECT_FALSE(c.views[0].camera.hasDistortion());
  EXPECT_THAT(c.facts, Contains(HasSubstr("3 cameras (2 registered), 1 points with 3 measurements")));
}

TEST(Bundler, AnImageThatIsNotRegisteredIsLeftOutByName) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);  // b.pgm does not even exist
  EXPECT_THAT(readBundlerText(folder, smallBundle()).capture.warnings,
              ElementsAre("1 image is not registered (focal length 0), left out: 'b.pgm'"));
  std::string bundle = "# Bundle file v0.3\n12 0\n", list;
  for (int i = 0; i < 12; ++i) {
    bundle += (i == 5 ? "100 0 0 1 0 0 0 1 0 0 0 1" : "0 0 0 0 0 0 0 0 0 0 0 0") + std::string(" 0 0 0\n");
    list += (i == 5 ? "c.pgm" : "i" + std::to_string(i)) + "\n";
  }
  EXPECT_THAT(
      readBundlerText(folder, bundle, list).capture.warnings,
      ElementsAre("11 images are not registered (focal length 0), left out: 'i0', 'i1', 'i2', 'i3', 'i4', 'i6', 'i7', 'i8', "
                  "... (11 in all)"));
}

TEST(Bundler, TheCameraLooksAlongMinusZWithYUp) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const Camera c = readBundlerText(folder, smallBundle()).capture.views.at(1).camera;
  // (1, 2, -5): p = (1, 2) / 5, p' = (20, 40), right and up.
  const std::optional<Pixel> pixel = c.project({1, 2, -5});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 31.5 + 20, tolerance::kExact);
  EXPECT_NEAR(pixel->y(), 23.5 - 40, tolerance::kExact);
  EXPECT_FALSE(c.project({1, 2, 5}));
  EXPECT_NEAR(c.camFromWorld.linear().determinant(), 1, tolerance::kExact);
}

TEST(Bundler, ThePoseTakesTheWorldIntoTheCamera) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const Camera a = readBundlerText(folder, smallBundle()).capture.views.at(0).camera;
  // P = R (1, 2, -5) + t = (-2, 1, -5) + (3, -1, -2) = (1, 0, -7): p' = 80 / 7 to the right.
  const std::optional<Pixel> pixel = a.project({1, 2, -5});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 16 + 80 / 7.0, tolerance::kExact);
  EXPECT_NEAR(pixel->y(), 9.5, tolerance::kExact);
  // C = -R^T t, R^T = (0 1 0; -1 0 0; 0 0 1).
  EXPECT_NEAR((a.centreInWorld() - Eigen::Vector3d(1, 3, 2)).norm(), 0, tolerance::kExact);
}

TEST(Bundler, TheRadialTermsDistortOnNormalisedCoordinates) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const Capture capture = readBundlerText(folder, with(smallBundle(), "100 0 0", "100 0.5 -2")).capture;
  const Camera& c = viewNamed(capture, "c.pgm").camera;
  EXPECT_EQ(c.lens.model, LensModel::Radial);
  EXPECT_EQ(c.lens.parameters, (std::array<double, 8>{0.5, -2}));
  // p = (0.3, 0.4) up: p^2 = 0.25, r = 1 + 0.5 * 0.25 - 2 * 0.0625 = 1, so both terms count.
  // p = (0, 0.2): r = 1 + 0.02 - 0.0032 = 1.0168.
  const Pixel both = c.distorted(*c.project({0.3, 0.4, -1}));
  EXPECT_NEAR(both.x(), 31.5 + 30, 1e-9);
  EXPECT_NEAR(both.y(), 23.5 - 40, 1e-9);
  const Pixel up = c.distorted(*c.project({0, 0.2, -1}));
  EXPECT_NEAR(up.x(), 31.5, 1e-9);
  EXPECT_NEAR(up.y(), 23.5 - 20 * 1.0168, 1e-9);
  EXPECT_FALSE(viewNamed(capture, "a.pgm").camera.hasDistortion());
  EXPECT_THAT(capture.facts, Contains(HasSubstr("1 images with Bundler's radial terms")));
}

TEST(Bundler, MeasurementsAreFromTheMiddleYUp) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const BundlerRead read = readBundlerText(folder, smallBundle());
  ASSERT_EQ(read.tracks.size(), 1u);
  EXPECT_EQ(read.tracks[0].point, Eigen::Vector3d(1, 2, -5));
  ASSERT_EQ(read.tracks[0].seen.size(), 2u);  // without that of the image that is not registered
  EXPECT_EQ(read.tracks[0].seen[0].view, 1);
  EXPECT_EQ(read.tracks[0].seen[0].measured, Pixel(31.5 + 20, 23.5 - 40));
  EXPECT_EQ(read.tracks[0].seen[1].view, 0);
  EXPECT_EQ(read.tracks[0].seen[1].measured, Pixel(16 + 0.5, 9.5 + 0.25));
}

TEST(Bundler, AnImageThatIsNotRegisteredIsNotTakenForAnotherOfItsName) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const BundlerRead read = readBundlerText(folder, smallBundle(), "c.pgm\nc.pgm\na.pgm\n");
  EXPECT_EQ(read.capture.views.size(), 2u);
  EXPECT_EQ(read.tracks.at(0).seen.size(), 2u);
}

TEST(Bundler, PointsThatNoRegisteredImageShowsAreLeftOutOfTheTracks) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const std::string text =
      with(with(smallBundle(), "3 1\n", "3 3\n"), "1 2 -5\n", "0 0 0\n0 0 0\n0\n4 5 6\n0 0 0\n1 1 8 1 1\n1 2 -5\n");
  const BundlerRead read = readBundlerText(folder, text);
  ASSERT_EQ(read.tracks.size(), 1u);
  EXPECT_EQ(read.tracks[0].point, Eigen::Vector3d(1, 2, -5));
}

TEST(Bundler, LinesMayBreakAnywhere) {
  std::string oneLine, manyLines;
  const std::string text = smallBundle();
  const std::size_t body = text.find('\n') + 1;
  for (const char c : text.substr(body)) {
    oneLine += c == '\n' ? ' ' : c;
    manyLines += c == ' ' || c == '\n' ? "\r\n" : std::string(1, c);
  }
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  for (const std::string& lines : {oneLine, manyLines}) {
    const BundlerRead read = readBundlerText(folder, text.substr(0, body) + lines);
    EXPECT_EQ(read.capture.views.size(), 2u);
    EXPECT_EQ(read.tracks.at(0).seen.at(1).measured, Pixel(16.5, 9.75));
  }
}

TEST(Bundler, ARotationOfFewDigitsIsReplacedByTheNearestOneAroundTheSameCentre) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const Capture c =
      readBundlerText(folder, with(smallBundle(), "1 0 0\n0 1 0\n0 0 1\n0 0 0", "0.8 -0.6001 0\n0.6001 0.8 0\n0 0 1\n1 2 3"))
          .capture;
  const Eigen::Isometry3d& pose = c.views.at(1).camera.camFromWorld;
  EXPECT_NEAR((pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-14);
  // Scaled by s = sqrt(0.8^2 + 0.6001^2) in the plane: the centre -M^-1 t is -(M^T / s^2) t.
  const double s2 = 0.64 + 0.6001 * 0.6001;
  const Eigen::Vector3d centre(-(0.8 * 1 + 0.6001 * 2) / s2, -(-0.6001 * 1 + 0.8 * 2) / s2, -3);
  EXPECT_NEAR((c.views[1].camera.centreInWorld() - centre).norm(), 0, 1e-14);
  EXPECT_THAT(c.warnings, Contains(HasSubstr("line 3: not exactly a rotation, replaced by the nearest one")));
}

TEST(Bundler, ItsOwnLayoutHasTheListInTheFolderAroundBundle) {
  const TemporaryFolder folder;
  writeBundlerImages(folder, "photos/");
  folder.write("list.txt", "./photos/c.pgm 0 500\n./photos/b.pgm\n./photos/a.pgm\n");
  folder.write("bundle/bundle.out", smallBundle());
  const auto reader = makeBundlerReader();
  const fs::path file = reader->recognise(folder.path());
  EXPECT_EQ(file, folder / "bundle/bundle.out");
  const Capture c = reader->read(file, {});
  EXPECT_EQ(c.folder, folder.path());
  EXPECT_THAT(c.sources, ElementsAre(folder / "bundle/bundle.out", folder / "list.txt"));
  ASSERT_EQ(c.views.size(), 2u);
  EXPECT_EQ(c.views[0].name, "./photos/a.pgm");
  EXPECT_EQ(c.views[0].image, folder / "photos/a.pgm");
  EXPECT_EQ(reader->tracks(c, {}).size(), 1u);
  // The folder itself does as well, and a list beside the file comes first.
  EXPECT_EQ(reader->recognise(folder / "bundle"), folder / "bundle" / "bundle.out");
  folder.write("bundle/list.txt", "c.pgm\nb.pgm\na.pgm\n");
  writeBundlerImages(folder, "bundle/");
  EXPECT_EQ(reader->read(file, {}).folder, folder / "bundle");
}

TEST(Bundler, ALinkOutOfTheFolderIsNoListOfItsOwn) {
  const TemporaryFolder folder, other;
  writeBundlerImages(folder);
  fs::create_symlink(other.write("list.txt", smallList()), folder / "list.txt");
  EXPECT_THROW(makeBundlerReader()->read(folder.write("bundle.out", smallBundle()), {}), OutsidePath);
}

TEST(Bundler, NamesOfTheListMayHaveBlanks) {
  const TemporaryFolder folder;
  writeBlackImage(folder, "my  photo 2.pgm", 64, 48);
  writeBlackImage(folder, "7", 33, 20);
  const Capture c = readBundlerText(folder, smallBundle(), "my  photo 2.pgm 0 500.5\nb.pgm\n\n7\n").capture;
  EXPECT_EQ(viewNamed(c, "my  photo 2.pgm").camera.width, 64);
  EXPECT_EQ(viewNamed(c, "7").camera.width, 33);
}

// As COLMAP 3.8 wrote it, from the same model as the NVM.
const char* const kBundleOfColmap =
    "# Bundle file v0.3\n3 3\n"
    "80 0 0\n"
    "0.72631578947368425 -0.44210526315789472 -0.52631578947368418\n"
    "-0.31578947368421056 -0.89473684210526316 0.31578947368421051\n"
    "-0.61052631578947369 -0.063157894736842135 -0.78947368421052633\n"
    "0.29999999999999999 0.20000000000000001 -4\n"
    "55.5 0 0\n"
    "0.44680851063829774 -0.38297872340425537 0.8085106382978724\n"
    "0.042553191489361708 -0.8936170212765957 -0.44680851063829796\n"
    "0.89361702127659592 0.23404255319148939 -0.38297872340425521\n"
    "-0.40000000000000002 -0.10000000000000001 -5\n"
    "80 0 0\n"
    "0.8183644765923247 0.5746433594534861 0.0080369700622865102\n"
    "0.57062487442234278 -0.81414506730962422 0.1074944745830822\n"
    "0.068314245529435408 -0.083383564396222631 -0.99417319670484228\n"
    "0.10000000000000001 -0.5 -4.5\n"
    "0.25 -0.5 0.5\n10 20 30\n3 0 2 7.78555 12.8671 1 2 3.35554 1.46297 2 2 0.344861 1.6763\n"
    "-0.75 0.5 -0.25\n10 20 30\n3 0 1 -7.91894 -2.12003 1 1 -11.4787 -4.74942 2 1 -4.20701 -25.0791\n"
    "0.5 0.25 0.125\n10 20 30\n3 0 0 8.81215 -2.57219 1 0 -2.09262 -4.37371 2 0 11.3442 -7.02304\n";

TEST(Bundler, OfColmapProjectsAsTheModelItWasMadeFrom) {
  const TemporaryFolder folder;
  writeSfmImages(folder);
  const auto reader = makeBundlerReader();
  folder.write("m.list.txt", "b/second.pgm\na/first.pgm\nc.pgm\n");  // COLMAP's names of the two files
  folder.write("list.txt", "of another model\n");
  const Capture capture = reader->read(folder.write("m.bundle.out", kBundleOfColmap), {});
  expectSfmProjections(capture);
  expectSfmMeasurements(capture, reader->tracks(capture, {}));
  EXPECT_THAT(capture.warnings, ElementsAre());
  EXPECT_THAT(capture.sources, ElementsAre(folder / "m.bundle.out", folder / "m.list.txt"));
}

TEST(Bundler, IsRecognisedByItsFirstLineAndItsList) {
  const auto reader = makeBundlerReader();
  const TemporaryFolder folder;
  EXPECT_EQ(reader->recognise(folder.path()), fs::path());
  EXPECT_EQ(reader->recognise(folder / "bundle.out"), fs::path());
  EXPECT_EQ(reader->recognise(folder.write("any.txt", smallBundle())), folder / "any.txt");
  EXPECT_EQ(reader->recognise(folder.write("other.out", "3 1\n100 0 0\n")), fs::path());
  folder.write("bundle.out", smallBundle());
  EXPECT_EQ(reader->recognise(folder.path()), fs::path());  // without a list it is not recognised
  folder.write("list.txt", smallList());
  EXPECT_EQ(reader->recognise(folder.path()), folder / "bundle.out");
  folder.write("bundle.out", "something else");
  EXPECT_EQ(reader->recognise(folder.path()), fs::path());
  EXPECT_EQ(reader->name(), "bundler");
}

struct BundleCase {
  const char* name;
  const char* from;
  const char* to;
  const char* place;
  const char* reason;
};
class BadBundle : public testing::TestWithParam<BundleCase> {};

TEST_P(BadBundle, IsOneLineWithFilePlaceAndReason) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const std::string text = with(smallBundle(), GetParam().from, GetParam().to);
  const std::string message = inputErrorOf([&] { readBundlerText(folder, text); });
  EXPECT_THAT(message, HasSubstr(std::string("bundle.out: ") + GetParam().place)) << GetParam().name;
  EXPECT_THAT(message, HasSubstr(GetParam().reason)) << GetParam().name;
}

INSTANTIATE_TEST_SUITE_P(
    Bundler, BadBundle,
    testing::Values(BundleCase{"another file", "# Bundle", "# Bunch", "line 1: ", "expected '# Bundle file v0.3'"},
                    BundleCase{"an older version", "v0.3", "v0.2",
                               "line 1: ", "only version 0.3 is supported, not '# Bundle file v0.2'"},
                    BundleCase{"a newer version", "v0.3", "v0.4", "line 1: ", "only version 0.3"},
                    BundleCase{"no counts", "3 1\n", "\n", "line 3: ", "100 cameras do not fit"},
                    BundleCase{"no cameras", "3 1\n", "0 1\n", "line 2: ", "holds no cameras"},
                    BundleCase{"negative count", "3 1\n", "-3 1\n", "line 2: ", "the number of cameras must not be negative"},
                    BundleCase{"count with a fraction", "3 1\n", "3.5 1\n", "line 2: ", "'3.5' is not a whole number"},
                    BundleCase{"more cameras than bytes", "3 1\n", "3000000000 1\n", "line 2: ", "3000000000 cameras do not fit"},
                    BundleCase{"negative points", "3 1\n", "3 -1\n", "line 2: ", "the number of points must not be negative"}));

/// One bad line costs its image or its point, with a warning.
class BadBundleLine : public testing::TestWithParam<BundleCase> {};

TEST_P(BadBundleLine, IsAWarningAndTheRestIsRead) {
  const BundleCase& bad = GetParam();
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const BundlerRead whole = readBundlerText(folder, smallBundle());
  const BundlerRead read = readBundlerText(folder, with(smallBundle(), bad.from, bad.to));
  EXPECT_THAT(read.capture.warnings, Contains(AllOf(HasSubstr(std::string("bundle.out: ") + bad.place), HasSubstr(bad.reason),
                                                    HasSubstr("it is left out"))))
      << bad.name;
  // What is left is as it was.
  const int line = std::atoi(bad.place + std::string("line ").size());
  constexpr int kThird = 13, kPoint = 18;
  const bool points = line >= kPoint;
  ASSERT_EQ(read.capture.views.size(), points ? 2u : 1u) << bad.name;
  for (const CaptureView& v : read.capture.views) {
    EXPECT_EQ(v.camera.camFromWorld.matrix(), viewNamed(whole.capture, v.name).camera.camFromWorld.matrix());
    if (!points) EXPECT_EQ(v.name, line < kThird ? "a.pgm" : "c.pgm") << bad.name;
  }
  if (!points) {
    ASSERT_EQ(read.tracks.size(), 1u) << bad.name;
    EXPECT_EQ(read.tracks[0].seen.size(), 1u) << bad.name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Bundler, BadBundleLine,
    testing::Values(
        BundleCase{"one point too many", "3 1\n", "3 2\n", "line 20: ", "the file ends before point 2 of 2 is complete"},
        BundleCase{"more points than bytes", "3 1\n", "3 1000000000000\n",
                   "line 20: ", "the file ends before point 2 of 1000000000000 is complete"},
        BundleCase{"cut rotation", "0 -1 0\n", "0 -1\n", "line 14: ", "needs 3 entries, has 2 (a cut line?)"},
        BundleCase{"cut intrinsics", "100 0 0\n", "100\n", "line 3: ", "needs 3 entries, has 1"},
        BundleCase{"too many numbers", "0 -1 0\n", "0 -1 0 7\n", "line 14: ", "needs 3 entries, has 4"},
        BundleCase{"cut point", "1 2 -5\n", "1 2\n", "line 18: ", "needs 3 entries, has 2"},
        BundleCase{"cut measurement", " 0.5 -0.25", " 0.5", "line 20: ", "needs 13 entries, has 12"},
        BundleCase{"negative focal length", "100 0 0", "-100 0 0", "line 3: ", "the focal length must be positive"},
        BundleCase{"focal length too large", "100 0 0", "1e300 0 0", "line 3: ", "larger than"},
        BundleCase{"term too large", "100 0 0", "100 1e300 0", "line 3: ", "larger than"},
        BundleCase{"no rotation", "1 0 0\n0 1 0\n0 0 1\n", "1 0 0\n0 1 0\n0 0 2\n", "line 3: ", "is not a rotation"},
        BundleCase{"rotation beyond numbers", "1 0 0\n0 1 0\n0 0 1\n", "1e300 0 0\n0 1 0\n0 0 1\n",
                   "line 3: ", "is not a rotation"},
        BundleCase{"rotation of zeros", "1 0 0\n0 1 0\n0 0 1\n", "0 0 0\n0 0 0\n0 0 0\n", "line 3: ", "is not a rotation"},
        BundleCase{"mirrored rotation", "1 0 0\n0 1 0\n0 0 1\n", "1 0 0\n0 1 0\n0 0 -1\n", "line 3: ", "is mirrored"},
        BundleCase{"rotation of words", "0 -1 0\n", "0 x 0\n", "line 14: ", "'x' is not a number"},
        BundleCase{"translation too far", "3 -1 -2", "3 -1 1e300", "line 13: ", "larger than"},
        BundleCase{"point too far away", "1 2 -5", "1 1e300 -5", "line 18: ", "larger than"},
        BundleCase{"views beyond memory", "3 0 7", "4000000000000000000 0 7", "line 20: ", "views do not fit"},
        BundleCase{"negative views", "3 0 7", "-1 0 7", "line 20: ", "the number of views must not be negative"},
        BundleCase{"one view too many", "3 0 7", "4 0 7", "line 20: ", "needs 17 entries, has 13"},
        BundleCase{"seen by nobody", "3 0 7", "3 3 7", "line 20: ", "there is no camera 3, there are 3"},
        BundleCase{"seen by less than nobody", "3 0 7", "3 -1 7", "line 20: ", "there is no camera -1"},
        BundleCase{"measurement too far away", "0.5 -0.25", "0.5 1e30", "line 20: ", "larger than"},
        BundleCase{"measurement that is no number", "0.5 -0.25", "0.5 nan", "line 20: ", "'nan' is not a number"}));

TEST(Bundler, NumbersThatAreNotFiniteCostTheirImage) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const BundlerRead read = readBundlerText(folder, with(smallBundle(), "100 0 0", "inf 0 0"));
  ASSERT_EQ(read.capture.views.size(), 1u);
  EXPECT_EQ(read.capture.views[0].name, "a.pgm");
  EXPECT_THAT(read.capture.warnings, Contains(HasSubstr("bundle.out: line 3: no finite pose")));
  for (const CaptureTrack& track : read.tracks)
    for (const auto& seen : track.seen) EXPECT_EQ(seen.view, 0);
}

TEST(Bundler, TheListHasToFitTheCameras) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  const auto reader = makeBundlerReader();
  const fs::path file = folder.write("bundle.out", smallBundle());
  EXPECT_THAT(inputErrorOf([&] { reader->read(file, {}); }),
              HasSubstr("bundle.out: needs the list of its images beside it: list.txt"));
  const auto messageFor = [&](const std::string& list) {
    folder.write("list.txt", list);
    return inputErrorOf([&] { reader->read(file, {}); });
  };
  EXPECT_THAT(messageFor("c.pgm\na.pgm\n"), HasSubstr("list.txt: names 2 images, but bundle.out has 3 cameras"));
  EXPECT_THAT(messageFor("c.pgm\nb.pgm\na.pgm\nd.pgm\n"), HasSubstr("list.txt: names 4 images"));
  EXPECT_THAT(messageFor(""), HasSubstr("list.txt: names 0 images"));
  EXPECT_THAT(messageFor("c.pgm\nb.pgm\nd.pgm\n"), HasSubstr("list.txt: line 3: "));
  EXPECT_THAT(messageFor("c.pgm\nb.pgm\nd.pgm\n"), HasSubstr("--photographs"));
  EXPECT_THAT(messageFor("c.pgm\nb.pgm\nc.pgm\n"), HasSubstr("two images are called 'c.pgm'"));
  EXPECT_THAT(messageFor("c.pgm 1 500\nb.pgm\na.pgm\n"), HasSubstr("list.txt: line 1: is marked as a fisheye image"));
  folder.write("list.txt", "c.pgm\nb.pgm\n../a.pgm\n");
  EXPECT_THROW(reader->read(file, {}), OutsidePath);
}

TEST(Bundler, WithoutARegisteredImageThereIsNothingToRead) {
  const TemporaryFolder folder;
  EXPECT_THAT(inputErrorOf([&] { readBundlerText(folder, "# Bundle file v0.3\n1 0\n0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n", "a\n"); }),
              HasSubstr("bundle.out: no image is registered"));
}

TEST(Bundler, EveryBeginningOfAFileIsReadOrRefused) {
  const TemporaryFolder folder;
  writeBundlerImages(folder);
  folder.write("list.txt", smallList());
  const std::string text = smallBundle();
  const auto reader = makeBundlerReader();
  for (std::size_t n = 0; n < text.size(); ++n) {
    const fs::path file = folder.write("cut.out", text.substr(0, n));
    try {
      const Capture capture = reader->read(file, {});
      EXPECT_FALSE(capture.views.empty()) << n;
      // The last number alone can be cut and still be one.
      if (n < text.rfind('-')) EXPECT_THAT(capture.warnings, Contains(HasSubstr("left out"))) << n;
    } catch (const InputError& e) {
      EXPECT_EQ(e.file(), file.string()) << n;
    }
  }
}

}  // namespace
}  // namespace glint::bundler_tests

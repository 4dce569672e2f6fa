// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/core/pipeline/exact_scene.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using namespace testing_support;

Highlight circle(double x, double y, double r, double level = 0.5) {
  Highlight h;
  h.level = level;
  h.contour = {Ellipse{{x, y}, {r, r}, 0}.sample(720), true};
  h.peak = {x, y};
  h.fromScene = true;
  return h;
}

Scene oneFrame(std::vector<Highlight> highlights) {
  Scene scene;
  scene.frames.resize(1);
  scene.frames[0].id = "a";
  scene.frames[0].camera = lookingAt({0, -0.5, 1}, {0, 0, 0});
  scene.frames[0].highlights = std::move(highlights);
  return scene;
}

Settings atLevel(double level) {
  Settings s;
  s.set("detect.level", level);
  return s;
}

TEST(Evidence, TakesTheSceneHighlightsOfTheLevelAskedFor) {
  const Scene scene = oneFrame({circle(100, 100, 20, 0.5), circle(100, 100, 30, 0.2), circle(300, 100, 25, 0.5)});
  EXPECT_EQ(gatherEvidence(scene, 0, FrameSource::Radiance, {}).highlights.size(), 2u);
  const FrameEvidence low = gatherEvidence(scene, 0, FrameSource::Radiance, atLevel(0.2));
  ASSERT_EQ(low.highlights.size(), 1u);
  EXPECT_NEAR(low.highlights[0].ellipse->semiAxes.x(), 30, 1e-6);
  const FrameEvidence none = gatherEvidence(scene, 0, FrameSource::Radiance, atLevel(0.3));
  ASSERT_TRUE(none.failure);
  EXPECT_EQ(none.failure->reason, Reason::NoHighlight);
}

TEST(Evidence, NamesTheOnlyLightAndLeavesSeveralOpen) {
  Scene scene = oneFrame({circle(100, 100, 20)});
  EXPECT_EQ(gatherEvidence(scene, 0, FrameSource::Radiance, {}).highlights[0].light, "light");
  scene.frames[0].lightsOn = {"lamp"};
  EXPECT_EQ(gatherEvidence(scene, 0, FrameSource::Radiance, {}).highlights[0].light, "lamp");
  scene.frames[0].lightsOn = {"lamp", "sun"};
  EXPECT_EQ(gatherEvidence(scene, 0, FrameSource::Radiance, {}).highlights[0].light, "");
  scene.frames[0].highlights[0].light = "sun";
  EXPECT_EQ(gatherEvidence(scene, 0, FrameSource::Radiance, {}).highlights[0].light, "sun");
}

TEST(Evidence, GivenContoursAreIdealAlreadyAndStayAsTheyAre) {
  Scene scene = oneFrame({circle(500, 400, 20)});
  scene.frames[0].camera.lens.parameters = {-0.2, 0.05, 1e-3, 1e-3, 0};
  const FrameEvidence e = gatherEvidence(scene, 0, FrameSource::Radiance, {});
  EXPECT_EQ(e.highlights[0].contour.points, scene.frames[0].highlights[0].contour.points);
  EXPECT_EQ(e.highlights[0].peak, scene.frames[0].highlights[0].peak);
}

TEST(Evidence, AFrameWithNothingToReadIsUnreadable) {
  const FrameEvidence e = gatherEvidence(oneFrame({}), 0, FrameSource::Radiance, {});
  ASSERT_TRUE(e.failure);
  EXPECT_EQ(e.failure->reason, Reason::FrameUnreadable);
}

TEST(Noise, IsGaussianPerCoordinateOn72EquallySpacedPoints) {
  const Highlight clean = circle(320, 240, 60);
  const std::vector<Pixel> exact = resample(clean.contour, 72);
  const double sigma = 0.7;
  double sum = 0, squares = 0, cross = 0, peak = 0;
  int n = 0;
  const int seeds = 200;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const Highlight noisy = withNoise(clean, sigma, seed, 3, 0);
    ASSERT_EQ(noisy.contour.points.size(), 72u);
    ASSERT_TRUE(noisy.ellipse);
    for (std::size_t i = 0; i < 72; ++i) {
      const Pixel d = noisy.contour.points[i] - exact[i];
      sum += d.x() + d.y();
      squares += d.squaredNorm();
      cross += d.x() * d.y();
      n += 2;
    }
    peak += (noisy.peak - clean.peak).squaredNorm();
  }
  // n = 28800 values: the mean has a standard error of sigma / sqrt(n), the variance of sigma^2 sqrt(2 / n); five of them.
  EXPECT_NEAR(sum / n, 0, 5 * sigma / std::sqrt(n));
  EXPECT_NEAR(squares / n, sigma * sigma, 5 * sigma * sigma * std::sqrt(2.0 / n));
  EXPECT_NEAR(2 * cross / n, 0, 5 * sigma * sigma / std::sqrt(n / 2.0));
  EXPECT_NEAR(peak / (2 * seeds), sigma * sigma, 5 * sigma * sigma * std::sqrt(1.0 / seeds));
}

TEST(Noise, DependsOnSeedFrameAndIndexOnly) {
  const Highlight clean = circle(320, 240, 60);
  const auto first = [&](unsigned seed, int frame, int index) {
    return withNoise(clean, 1, seed, frame, index).contour.points[0].x();
  };
  EXPECT_EQ(first(1, 2, 0), first(1, 2, 0));
  const std::set<double> all{first(1, 2, 0), first(2, 2, 0), first(1, 3, 0), first(1, 2, 1), first(2, 1, 0)};
  EXPECT_EQ(all.size(), 5u);
  EXPECT_EQ(withNoise(clean, 0, 1, 0, 0).contour.points.size(), 720u) << "no noise, no resampling";
}

TEST(Noise, OfATrainingFrameDoesNotDependOnTheOthers) {
  const auto scene = exactScene(sheet(0), 5);
  InspectionRequest a, b;
  a.models = b.models = {};
  a.noisePx = b.noisePx = 1;
  a.train = "0-3";
  b.train = "2,4";
  const Inspection ia = inspect(scene, a), ib = inspect(scene, b);
  ASSERT_EQ(ia.views[2].frame, 2);
  ASSERT_EQ(ib.views[0].frame, 2);
  EXPECT_EQ(ia.views[2].highlight.contour.points, ib.views[0].highlight.contour.points);
  EXPECT_EQ(ia.evidence[2].highlights[0].contour.points, scene->frames[2].highlights[0].contour.points) << "evidence stays clean";
}

std::string contours(const std::string& level, const std::string& points) {
  return R"({"levels": {")" + level + R"(": [)" + points + "]}}";
}
const std::string kSquare = R"({"points": [[10,10],[20,10],[20,20],[10,20]]})";

TEST(Truth, IsReadForTheLevelAskedFor) {
  const TemporaryFolder folder;
  folder.write("a.json", contours("0.50", kSquare));
  const Scene scene = oneFrame({circle(100, 100, 20)});
  const Outcome<std::vector<Highlight>> read = readTruth(folder.path().string(), scene, 0, 0.5);
  ASSERT_TRUE(read);
  const std::vector<Highlight>& truth = *read;
  ASSERT_EQ(truth.size(), 1u);
  EXPECT_EQ(truth[0].light, "light");
  EXPECT_NEAR(truth[0].areaPx2, 100, 1e-9);
  EXPECT_NEAR((truth[0].peak - Pixel(15, 15)).norm(), 0, 1e-9);
  EXPECT_NE(inputErrorOf([&] { (void)readTruth(folder.path().string(), scene, 0, 0.2); }).find("0.20"), std::string::npos);
  // 0.501 is not 0.50, although both print alike with two digits.
  EXPECT_NE(inputErrorOf([&] { (void)readTruth(folder.path().string(), scene, 0, 0.501); }).find("levels"), std::string::npos);
}

TEST(Truth, DamagedFilesAreInputErrors) {
  const Scene scene = oneFrame({circle(100, 100, 20)});
  for (const std::string& text :
       {std::string("{"), std::string(""), std::string("[]"), std::string("{\"levels\": 3}"), contours("0.50", "{}"),
        contours("0.50", R"({"points": []})"), contours("0.50", R"({"points": [[1,2],[3]]})"),
        contours("0.50", R"({"points": [[1,1],[1,1],[1,1]]})")}) {
    const TemporaryFolder folder;
    folder.write("a.json", text);
    EXPECT_NE(inputErrorOf([&] { (void)readTruth(folder.path().string(), scene, 0, 0.5); }).find("a.json"), std::string::npos)
        << text;
  }
  EXPECT_NE(inputErrorOf([&] { requireTruthFolder("/nonexistent", scene); }).find("--truth"), std::string::npos);
}

TEST(Truth, AFrameWithoutTruthIsNotScoredAgainstItsOwnDetection) {
  const auto scene = exactScene(sheet(0), 5);
  const TemporaryFolder folder;
  folder.write("v0.json", contours("0.50", kSquare));
  folder.write("v4.json", contours("0.50", ""));
  InspectionRequest q;
  q.train = "first:3";
  q.models = {"limit-angle"};
  q.truthFolder = folder.path().string();
  const Inspection r = inspect(scene, q);
  EXPECT_EQ(r.evidence[0].scored().size(), 1u);
  EXPECT_TRUE(r.evidence[3].scored().empty()) << "no file";
  EXPECT_TRUE(r.evidence[4].scored().empty()) << "the file says that there is no highlight";
  EXPECT_EQ(r.evidence[4].highlights.size(), 1u) << "training still uses what was seen";
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// Highlights ignored, merged, split and grown by hand, against circles, hulls and Gaussian spots whose shapes are known in closed
// form.
#include "core/pipeline/hand_edits.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "core/base/json_text.h"
#include "core/pipeline/summary.h"
#include "core/pipeline/what_if_dom.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint::hand_edits_tests {

using namespace testing_support;
using std::numbers::pi;
using testing::HasSubstr;

constexpr double kRadius = 20;

Highlight disc(double x, double y, double r = kRadius) {
  Highlight h;
  h.light = "lamp";
  h.contour = {Ellipse{{x, y}, {r, r}, 0}.sample(720), true};
  h.peak = {x, y};
  h.peakValue = 1;
  h.areaPx2 = std::abs(signedArea(h.contour));
  h.fromScene = true;
  return h;
}

Scene sceneOf(const std::vector<Highlight>& highlights) {
  Scene scene;
  scene.frames.resize(1);
  scene.frames[0].id = "a";
  scene.frames[0].camera = lookingAt({0, -0.5, 1}, {0, 0, 0});
  scene.frames[0].highlights = highlights;
  return scene;
}

FrameEvidence edited(const std::vector<Highlight>& highlights, const std::vector<HighlightEdit>& edits) {
  FrameEvidence e;
  e.frame = 0;
  e.highlights = highlights;
  InspectionRequest request;
  request.whatIf.edits = edits;
  applyEdits(e, sceneOf(highlights), request);
  return e;
}

TEST(IgnoredByHand, LeavesTheOthersTheirNumbers) {
  const std::vector<Highlight> three{disc(100, 100), disc(200, 100), disc(300, 100)};
  const FrameEvidence e = edited(three, {ignoreEdit(0, three[1])});
  ASSERT_EQ(e.highlights.size(), 2u);
  EXPECT_EQ(e.highlights[1].peak, three[2].peak);
  EXPECT_EQ(e.asFound(0), 0);
  EXPECT_EQ(e.asFound(1), 2);
  ASSERT_EQ(e.ignored.size(), 1u);
  EXPECT_EQ(e.ignored[0].peak, three[1].peak);
}

TEST(IgnoredByHand, OfAnotherFrameOrOfNothingChangesNothing) {
  const std::vector<Highlight> one{disc(100, 100)};
  EXPECT_EQ(edited(one, {ignoreEdit(3, one[0])}).highlights.size(), 1u);
  EXPECT_EQ(edited(one, {ignoreEdit(0, disc(400, 400))}).highlights.size(), 1u);
}

TEST(IgnoredByHand, TheLastOneIsAFrameWithoutHighlights) {
  const std::vector<Highlight> one{disc(100, 100)};
  const FrameEvidence e = edited(one, {ignoreEdit(0, one[0])});
  ASSERT_TRUE(e.failure);
  EXPECT_EQ(e.failure->reason, Reason::NoHighlight);
}

/// A crescent: neither peak nor centroid lies inside.
TEST(IgnoredByHand, ACrescentIsNamedByAPlaceInside) {
  Highlight h = disc(100, 100);
  const std::vector<Pixel> inner = Ellipse{{110, 100}, {18, 18}, 0}.sample(720);
  h.contour.points.clear();
  for (int i = 0; i <= 600; ++i) {
    const double a = pi / 2.5 + i * (2 * pi - 2 * pi / 2.5) / 600;
    h.contour.points.emplace_back(100 + 20 * std::cos(a), 100 + 20 * std::sin(a));
  }
  for (int i = 600; i >= 0; --i) {
    const double a = pi / 2.5 + i * (2 * pi - 2 * pi / 2.5) / 600;
    h.contour.points.emplace_back(101 + 18 * std::cos(a), 100 + 18 * std::sin(a));
  }
  h.areaPx2 = std::abs(signedArea(h.contour));
  h.peak = {101, 100};
  ASSERT_FALSE(contains(h.contour, h.peak));
  EXPECT_TRUE(contains(h.contour, ignoreEdit(0, h).places[0]));
  EXPECT_TRUE(edited({h}, {ignoreEdit(0, h)}).highlights.empty());
}

TEST(IgnoredByHand, OfTwoAroundAPlaceTheSmaller) {
  const std::vector<Highlight> nested{disc(100, 100, 5), disc(100, 100, 40)};
  const FrameEvidence e = edited(nested, {{HighlightEdit::Kind::Ignore, 0, {{100, 100}}}});
  ASSERT_EQ(e.ignored.size(), 1u);
  EXPECT_EQ(e.ignored[0].areaPx2, nested[0].areaPx2);
}

/// The hull of two equal discs, a distance d apart: area pi r^2 + 2 r d, and two straight lines of d join them.
TEST(MergedByHand, IsTheHullOfBoth) {
  for (const double d : {45.0, 90.0}) {
    const std::vector<Highlight> two{disc(100, 100), disc(100 + d * 0.6, 100 + d * 0.8)};
    const FrameEvidence e = edited(two, {mergeEdit(0, two[0], two[1])});
    ASSERT_EQ(e.highlights.size(), 1u);
    EXPECT_NEAR(e.highlights[0].areaPx2, pi * kRadius * kRadius + 2 * kRadius * d, 0.02 * kRadius);
    EXPECT_NEAR(centroid(e.highlights[0].contour).x(), 100 + d * 0.3, 0.01);
    EXPECT_EQ(e.asFound(0), 0);
    // A point of a line is farther than a pixel from both discs but for the sqrt(2 r) px at either end.
    const double seen = 2 * std::sqrt(2 * kRadius + 1), joins = 2 * (d - 2 * seen / 2) / (2 * pi * kRadius + 2 * d);
    int said = 0;
    ASSERT_EQ(std::sscanf(e.highlights[0].byHand.c_str(), "merged by hand: %d %%", &said), 1) << e.highlights[0].byHand;
    EXPECT_NEAR(said, 100 * joins, 3);
    EXPECT_TRUE(e.highlights[0].ellipse);
  }
}

TEST(MergedByHand, KeepsThePeakOfTheBrighter) {
  std::vector<Highlight> two{disc(100, 100), disc(160, 100)};
  two[1].peakValue = 2;
  EXPECT_EQ(edited(two, {mergeEdit(0, two[0], two[1])}).highlights[0].peak, two[1].peak);
}

TEST(MergedByHand, IsCutOrClippedWhereEitherIs) {
  std::vector<Highlight> two{disc(100, 100), disc(160, 100)};
  for (const int i : {0, 1}) {
    two[std::size_t(i)].clipped = two[std::size_t(i)].touchesBorder = true;
    two[std::size_t(1 - i)].clipped = two[std::size_t(1 - i)].touchesBorder = false;
    const Highlight whole = edited(two, {mergeEdit(0, two[0], two[1])}).highlights[0];
    EXPECT_TRUE(whole.clipped && whole.touchesBorder) << i;
  }
}

/// Two discs that overlap, as one contour; its neck is the chord through both crossings.
Highlight hourglass(double d) {
  Highlight h = disc(100, 100);
  const double a = std::acos(0.5 * d / kRadius);
  h.contour.points.clear();
  for (int i = 0; i <= 360; ++i) {
    const double t = a + i * (2 * pi - 2 * a) / 360;
    h.contour.points.emplace_back(100 + kRadius * std::cos(t), 100 + kRadius * std::sin(t));
  }
  for (int i = 1; i < 360; ++i) {
    const double t = -(pi - a) + i * (2 * pi - 2 * a) / 360;
    h.contour.points.emplace_back(100 + d + kRadius * std::cos(t), 100 + kRadius * std::sin(t));
  }
  h.areaPx2 = std::abs(signedArea(h.contour));
  return h;
}

TEST(SplitByHand, CutsAtTheNeckThatOneClicksAt) {
  const double d = 32;
  const Highlight whole = hourglass(d);
  const double neck = 2 * std::sqrt(kRadius * kRadius - 0.25 * d * d);
  const Outcome<HighlightEdit> edit = splitEdit(0, whole, {100 + d / 2, 101});
  ASSERT_TRUE(edit) << edit.failure().message();
  EXPECT_NEAR((edit->places[1] - edit->places[2]).norm(), neck, 0.05);
  EXPECT_NEAR(edit->places[1].x(), 100 + d / 2, 0.3);
  const FrameEvidence e = edited({whole}, {*edit});
  ASSERT_EQ(e.highlights.size(), 2u);
  EXPECT_NEAR(e.highlights[0].areaPx2, whole.areaPx2 / 2, 0.01 * whole.areaPx2);
  EXPECT_NEAR(e.highlights[0].areaPx2 + e.highlights[1].areaPx2, whole.areaPx2, 1e-6);
  EXPECT_EQ(e.highlights[0].peak, whole.peak) << "the part with the peak keeps it";
  EXPECT_NEAR(e.highlights[1].peak.x(), 200 + d - 100, 4) << "no image: the centroid of the other part";
  EXPECT_EQ(e.asFound(0), 0);
  EXPECT_EQ(e.asFound(1), 1);
  const double arc = kRadius * (2 * pi - 2 * std::acos(0.5 * d / kRadius));
  int said = 0;
  ASSERT_EQ(std::sscanf(e.highlights[0].byHand.c_str(), "split by hand: %d %%", &said), 1);
  EXPECT_NEAR(said, 100 * neck / (neck + arc), 1);
}

TEST(SplitByHand, ThePartWithThePeakStaysTheHighlight) {
  const double d = 32;
  for (const double peak : {100.0, 100 + d}) {
    Highlight whole = hourglass(d);
    whole.peak = {peak, 100};
    const Outcome<HighlightEdit> edit = splitEdit(0, whole, {100 + d / 2, 101});
    ASSERT_TRUE(edit) << edit.failure().message();
    const FrameEvidence e = edited({whole}, {*edit});
    ASSERT_EQ(e.highlights.size(), 2u);
    EXPECT_EQ(e.highlights[0].peak, whole.peak) << "peak at " << peak;
    EXPECT_TRUE(contains(e.highlights[0].contour, whole.peak)) << "peak at " << peak;
  }
}

TEST(SplitByHand, OutsideIsRefusedAndAPlaceThatIsGoneIsNoCut) {
  const Outcome<HighlightEdit> edit = splitEdit(0, disc(100, 100), {300, 300});
  ASSERT_FALSE(edit);
  EXPECT_EQ(edit.failure().reason, Reason::NotReached);
  const Outcome<HighlightEdit> good = splitEdit(0, disc(100, 100), {100, 100});
  ASSERT_TRUE(good);
  EXPECT_EQ(edited({disc(300, 300)}, {*good}).highlights.size(), 1u);
}

TEST(EditsByHand, WorkOnWhatEarlierOnesMade) {
  const std::vector<Highlight> two{disc(100, 100), disc(150, 100)};
  const FrameEvidence merged = edited(two, {mergeEdit(0, two[0], two[1])});
  const FrameEvidence e = edited(two, {mergeEdit(0, two[0], two[1]), ignoreEdit(0, merged.highlights[0])});
  EXPECT_TRUE(e.highlights.empty());
}

/// Gaussian spots of standard deviation s: at half of its own peak each has the radius s sqrt(2 log 2).
class GrownByHand : public testing::Test {
 protected:
  struct Spot {
    double x, y, height;
  };
  static constexpr double kSigma = 6;
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("glint-grown-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  Scene photographed(const std::vector<Spot>& spots, double scale = 1, double noise = 0, unsigned seed = 1) const {
    cv::Mat image(480, 640, CV_32F);
    std::mt19937 engine(seed);
    std::normal_distribution<double> gauss(0, 1);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x) {
        double v = 0.05;
        for (const Spot& s : spots)
          v += s.height * std::exp(-(std::pow(x - s.x, 2) + std::pow(y - s.y, 2)) / (2 * kSigma * kSigma));
        image.at<float>(y, x) = float(scale * std::max(0.0, v + noise * gauss(engine)));
      }
    Scene scene = sceneOf({});
    scene.frames[0].radiance = folder_ / "a.tiff";
    cv::imwrite(scene.frames[0].radiance.string(), image);
    return scene;
  }
  static double radiusOf(const Highlight& h) { return std::sqrt(h.areaPx2 / pi); }
  /// The frame's evidence, at first none, with a highlight grown at a place.
  static FrameEvidence grownAt(const Scene& scene, const Pixel& place) {
    InspectionRequest request;
    const Outcome<HighlightEdit> edit = seedEdit(scene, request, 0, place, "lamp");
    EXPECT_TRUE(edit) << edit.failure().message();
    if (edit) request.whatIf.edits = {*edit};
    FrameEvidence e;
    e.frame = 0;
    e.failure = Failure{Reason::NoHighlight, "none"};
    applyEdits(e, scene, request);
    return e;
  }
  std::filesystem::path folder_;
};

TEST_F(GrownByHand, FindsASpotThatDetectionLeavesOut) {
  const Scene scene = photographed({{200, 200, 1}, {420.3, 300.6, 0.2}});
  const FrameEvidence e = grownAt(scene, {422, 299});
  ASSERT_EQ(e.highlights.size(), 1u);
  EXPECT_FALSE(e.failure);
  EXPECT_EQ(e.highlights[0].light, "lamp");
  EXPECT_NEAR(radiusOf(e.highlights[0]), kSigma * std::sqrt(2 * std::log(2)), 0.1);
  EXPECT_NEAR((e.highlights[0].peak - Pixel(420.3, 300.6)).norm(), 0, 0.05);
}

TEST_F(GrownByHand, IsTheSameAtAnyExposure) {
  for (const double scale : {1e-4, 1e4}) {
    const Scene scene = photographed({{200, 200, 1}, {420.3, 300.6, 0.2}}, scale);
    const FrameEvidence e = grownAt(scene, {422, 299});
    ASSERT_EQ(e.highlights.size(), 1u) << scale;
    EXPECT_NEAR(radiusOf(e.highlights[0]), kSigma * std::sqrt(2 * std::log(2)), 0.1) << scale;
  }
}

TEST_F(GrownByHand, StandsNoise) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Scene scene = photographed({{200, 200, 1}, {420.3, 300.6, 0.2}}, 1, 0.004, seed);
    const FrameEvidence e = grownAt(scene, {421, 300});
    ASSERT_EQ(e.highlights.size(), 1u) << seed;
    EXPECT_NEAR(radiusOf(e.highlights[0]), kSigma * std::sqrt(2 * std::log(2)), 0.35) << seed;
  }
}

TEST_F(GrownByHand, NothingGrowsWhereNothingIs) {
  const Scene scene = photographed({{200, 200, 1}});
  const Outcome<HighlightEdit> flat = seedEdit(scene, {}, 0, {500, 400}, "lamp");
  ASSERT_FALSE(flat);
  EXPECT_EQ(flat.failure().reason, Reason::NoHighlight);
  const Outcome<HighlightEdit> outside = seedEdit(scene, {}, 0, {900, 400}, "lamp");
  ASSERT_FALSE(outside);
  EXPECT_EQ(outside.failure().reason, Reason::OutsideImage);
  const Outcome<HighlightEdit> none = seedEdit(sceneOf({}), {}, 0, {100, 100}, "lamp");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.failure().reason, Reason::FrameUnreadable);
}

TEST_F(GrownByHand, TakesThePlaceOfWhatItHolds) {
  const Scene scene = photographed({{200, 200, 1}});
  FrameEvidence e;
  e.frame = 0;
  e.highlights = {disc(200, 200, 3), disc(400, 400)};
  InspectionRequest request;
  const Outcome<HighlightEdit> edit = seedEdit(scene, request, 0, {201, 200}, "lamp");
  ASSERT_TRUE(edit);
  request.whatIf.edits = {*edit};
  applyEdits(e, scene, request);
  ASSERT_EQ(e.highlights.size(), 2u);
  EXPECT_EQ(e.asFound(0), 1);
  EXPECT_EQ(e.asFound(1), 2) << "a new one";
  EXPECT_NEAR(radiusOf(e.highlights[1]), kSigma * std::sqrt(2 * std::log(2)), 0.1);
}

/// What is ignored in a training frame leaves the fit as if the frame did not train; in a held-out frame nothing of it counts.
TEST(EditsInAnInspection, WhatIsIgnoredNeitherTrainsNorIsScored) {
  const auto scene = exactScene(sphere(0.5), 9);
  InspectionRequest request;
  request.models = {"limit-angle"};
  request.train = "0-5";
  const Inspection before = inspect(scene, request);
  InspectionRequest ignoring = request;
  ignoring.whatIf.edits = {ignoreEdit(2, before.evidence[2].highlights[0]), ignoreEdit(7, before.evidence[7].highlights[0])};
  const Inspection after = inspect(scene, ignoring, {}, &before);
  InspectionRequest excluding = request;
  excluding.excluded = {2};
  const Inspection without = inspect(scene, excluding);
  const auto light = [](const Inspection& r) { return r.lights.begin()->second->light.homogeneous(); };
  EXPECT_EQ(light(after), light(without));
  EXPECT_NE(light(after), light(before));
  const ModelSummary was = summarise(before, before.models.at("limit-angle")),
                     is = summarise(after, after.models.at("limit-angle"));
  EXPECT_EQ(was.matched, 3);
  EXPECT_EQ(is.matched, 2);
  EXPECT_EQ(is.missed, 0);
  EXPECT_EQ(is.spurious, 0) << "what is predicted where one ignores a highlight is not invented";
  // Taken back, everything is as it was.
  const Inspection again = inspect(scene, request, {}, &after);
  EXPECT_EQ(light(again), light(before));
  EXPECT_EQ(again.evidence[7].highlights.size(), 1u);
}

TEST(EditsInAnInspection, SayWhatTheyLeaveInDoubt) {
  const auto scene = exactScene(sphere(0.5), 9);
  InspectionRequest request;
  request.models = {"limit-angle"};
  request.train = "0-5";
  const Inspection before = inspect(scene, request);
  const Highlight& whole = before.evidence[1].highlights[0];
  const Pixel middle = centroid(whole.contour), rim = whole.contour.points[0] - middle;
  const Outcome<HighlightEdit> cut = splitEdit(1, whole, middle + 0.9 * rim);
  ASSERT_TRUE(cut);
  request.whatIf.edits = {*cut, {HighlightEdit::Kind::Ignore, 1, {middle + 0.98 * rim}}};  // a sliver that is cut off
  const Inspection after = inspect(scene, request);
  ASSERT_EQ(after.evidence[1].highlights.size(), 1u);
  ASSERT_TRUE(after.models.at("limit-angle").fits[0].fit) << after.models.at("limit-angle").fits[0].failure()->message();
  EXPECT_THAT(after.models.at("limit-angle").fits[0].fit->remarks, testing::Contains(HasSubstr("split by hand")));
}

TEST(EditsInJson, RoundTripAndAreRefusedByName) {
  WhatIf w;
  w.edits = {{HighlightEdit::Kind::Ignore, 3, {{1.5, 2.25}}},
             {HighlightEdit::Kind::Merge, 0, {{1, 2}, {3, 4}}},
             {HighlightEdit::Kind::Split, 1, {{1, 2}, {3, 4}, {0.1, 1e-7}}},
             {HighlightEdit::Kind::Seed, 2, {{7, 8}}, "lamp"}};
  EXPECT_EQ(readWhatIf(JsonNode::parse(toJson(w).dump(), "x")), w);
  for (const char* bad : {R"({"edits": [{"frame": 0, "kind": "melt", "places": [[1,2]]}]})",
                          R"({"edits": [{"frame": -1, "kind": "ignore", "places": [[1,2]]}]})",
                          R"({"edits": [{"frame": 0, "kind": "merge", "places": [[1,2]]}]})",
                          R"({"edits": [{"frame": 0, "kind": "split", "places": [[1,2],[3,4],[1e300,0]]}]})",
                          R"({"edits": [{"frame": 0, "kind": "seed"}]})"})
    EXPECT_THROW((void)readWhatIf(JsonNode::parse(bad, "x")), InputError) << bad;
}

}  // namespace glint::hand_edits_tests

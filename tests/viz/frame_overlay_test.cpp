// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/frame_overlay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/draw/plots.h"
#include "core/model/models.h"
#include "tests/tolerances.h"
#include "tests/viz/small_inspection.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

using test::heldOutInput;
using test::smallInspection;
using test::TemporaryFolder;

std::vector<OverlayLine> ofRole(const FrameOverlay& overlay, OverlayRole role) {
  std::vector<OverlayLine> lines;
  for (const OverlayLine& line : overlay.lines) {
    if (line.role == role) lines.push_back(line);
  }
  return lines;
}

TEST(FrameOverlay, ContoursAndPeaksLieExactlyWhereTheInspectionHasThem) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const FrameOverlay overlay = frameOverlay(*inspection, 2);
  const Highlight& observed = inspection->evidence[2].highlights[0];
  const auto contours = ofRole(overlay, OverlayRole::ObservedContour);
  ASSERT_EQ(contours.size(), 1u);
  ASSERT_EQ(contours[0].points.size(), observed.contour.points.size());
  for (std::size_t i = 0; i < observed.contour.points.size(); ++i) EXPECT_EQ(contours[0].points[i], observed.contour.points[i]);
  EXPECT_TRUE(contours[0].closed);
  EXPECT_TRUE(contours[0].halo);
  const auto predicted = ofRole(overlay, OverlayRole::PredictedContour);
  ASSERT_EQ(predicted.size(), 1u);
  EXPECT_EQ(predicted[0].model, "canonical");
  EXPECT_EQ(predicted[0].colour, modelColour("canonical"));
  ASSERT_FALSE(overlay.marks.empty());
  EXPECT_EQ(overlay.marks[0].role, OverlayRole::ObservedPeak);
  EXPECT_EQ(overlay.marks[0].at, observed.peak);
}

/// A highlight of Blinn-Phong's lobe, written out here: the camera above a plane, the light turned by 0.025 rad per pixel about
/// it.
std::shared_ptr<FrameSamples> blinnPhongSamples(int frame, double m) {
  auto samples = std::make_shared<FrameSamples>();
  samples->frame = frame;
  FrameSamples::Lobe lobe;
  lobe.observed = 0;
  lobe.level = 0.5;
  LobeSamples s;
  s.grid = {Pixel(20, 30), 1, 41, 41, std::vector<std::optional<LobePixel>>(41 * 41)};
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 41; ++x) {
      const Eigen::Vector2d turn = 0.025 * Eigen::Vector2d(x - 20, y - 20);
      LobePixel p;
      p.alpha = turn.norm() / 2;
      p.normal = p.toCamera = Eigen::Vector3d::UnitZ();
      p.toLight << (turn.norm() > 0 ? (std::sin(turn.norm()) * turn.normalized()).eval() : turn), std::cos(turn.norm());
      p.radiance = std::pow(std::cos(p.alpha), 2 / (m * m));
      s.pixels.push_back(p);
      s.grid.places[std::size_t(41 * y + x)] = p;
    }
  lobe.comparison = *compareLobes(s);
  lobe.samples = s;
  samples->lobes = {lobe};
  return samples;
}

TEST(FrameOverlay, EveryLobeHasItsContoursAndItsCaption) {
  constexpr double kRoughness = 0.1, kLinearPx = 0.05;  // linear between pixels
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  OverlayOptions options;
  EXPECT_TRUE(ofRole(frameOverlay(*inspection, 2, options), OverlayRole::Lobes).empty());
  options.samples = blinnPhongSamples(2, kRoughness);
  EXPECT_TRUE(ofRole(frameOverlay(*inspection, 1, options), OverlayRole::Lobes).empty()) << "samples of another frame";
  const FrameOverlay overlay = frameOverlay(*inspection, 2, options);
  const auto lines = ofRole(overlay, OverlayRole::Lobes);
  ASSERT_EQ(lines.size(), 8u);  // four lobes at two levels
  int own = 0;
  for (const OverlayLine& line : lines) {
    EXPECT_TRUE(line.closed);
    if (line.label.rfind("blinn-phong", 0) != 0) continue;
    const double level = own++ == 0 ? 0.5 : 0.15;
    // cos^(2 / m^2) alpha = level, and alpha is half of the 0.025 rad a pixel.
    const double radius = std::acos(std::pow(level, kRoughness * kRoughness / 2)) / 0.0125;
    for (const Pixel& p : line.points) EXPECT_NEAR((p - Pixel(40, 50)).norm(), radius, kLinearPx);
    EXPECT_NE(line.label.find("best"), std::string::npos) << line.label;
  }
  EXPECT_EQ(own, 2);
  // Each lobe's contour lies where its curve in the plot has the level; the angle alone tells a lobe's radiance here.
  constexpr double kBetweenBins = 0.02;  // of the angle: the curve is linear between its bins
  const LobeComparison& comparison = *options.samples->lobes[0].comparison;
  for (std::size_t k = 0; k < comparison.matches.size(); ++k) {
    const std::vector<double>& profile = comparison.matches[k].profile;
    std::size_t i = 0;
    while (i + 2 < profile.size() && profile[i + 1] >= 0.5) ++i;
    const double t = (profile[i] - 0.5) / (profile[i] - profile[i + 1]);
    const double alpha = (1 - t) * comparison.measured[i].alpha + t * comparison.measured[i + 1].alpha;
    const OverlayLine& line = lines[2 * k];
    double radius = 0;
    for (const Pixel& p : line.points) radius += (p - Pixel(40, 50)).norm() / double(line.points.size());
    EXPECT_NEAR(0.0125 * radius / alpha, 1, kBetweenBins) << line.label;
  }
  int captions = 0;
  for (const OverlayCaption& c : overlay.captions) captions += c.model.empty() && !c.problem;
  EXPECT_EQ(captions, 4);
  options.hidden.insert(OverlayRole::Lobes);
  EXPECT_TRUE(ofRole(frameOverlay(*inspection, 2, options), OverlayRole::Lobes).empty());

  auto none = std::make_shared<FrameSamples>();
  none->frame = 2;
  none->failure = "Frame 0002 shows no highlight.";
  options.hidden.clear();
  options.samples = none;
  const auto said = frameOverlay(*inspection, 2, options).captions;
  EXPECT_TRUE(std::any_of(said.begin(), said.end(), [](const OverlayCaption& c) {
    return c.problem && c.text == "every lobe: Frame 0002 shows no highlight.";
  }));
}

TEST(FrameOverlay, EllipsesAreSampledOnTheirCurve) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const FrameOverlay overlay = frameOverlay(*inspection, 0);
  const Ellipse ellipse = *inspection->evidence[0].highlights[0].ellipse;
  const auto lines = ofRole(overlay, OverlayRole::ObservedEllipse);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].dash, Dash::Dashed);
  EXPECT_EQ(lines[0].points.size(), 96u);
  for (const Pixel& p : lines[0].points) EXPECT_NEAR((p - ellipse.centre).norm(), ellipse.semiAxes.x(), tolerance::kPixel);
}

TEST(FrameOverlay, LensDistortionIsAppliedBecauseThePhotographHasIt) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  auto scene = std::make_shared<Scene>(*inspection->scene);
  scene->frames[1].camera.lens.parameters = {-0.2, 0.05, 1e-3, -5e-4, 0};
  inspection->scene = scene;
  const Camera& camera = scene->frames[1].camera;
  const Pixel ideal = inspection->evidence[1].highlights[0].contour.points[5];
  const auto contours = ofRole(frameOverlay(*inspection, 1), OverlayRole::ObservedContour);
  ASSERT_EQ(contours.size(), 1u);
  EXPECT_LT((camera.undistorted(contours[0].points[5]) - ideal).norm(), tolerance::kPixel);
  EXPECT_GT((contours[0].points[5] - ideal).norm(), 0.01);  // or the test could not fail
}

TEST(FrameOverlay, GapsAreDottedAndNothingIsLost) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  PredictedHighlight& highlight = inspection->models["canonical"].frames[0].prediction.editable()[0];
  highlight.gaps = {{70, 3}, {20, 21}};  // the first one runs over the end of the list
  const auto lines = ofRole(frameOverlay(*inspection, 0), OverlayRole::PredictedContour);
  ASSERT_EQ(lines.size(), 4u);
  int solid = 0, dotted = 0, segments = 0;
  for (const OverlayLine& line : lines) {
    EXPECT_FALSE(line.closed);
    (line.dash == Dash::Dotted ? dotted : solid) += 1;
    segments += static_cast<int>(line.points.size()) - 1;
    if (line.dash == Dash::Dotted && line.points.size() == 2) {
      EXPECT_EQ(line.points[0], highlight.contour.points[20]);
      EXPECT_EQ(line.points[1], highlight.contour.points[21]);
    }
  }
  EXPECT_EQ(solid, 2);
  EXPECT_EQ(dotted, 2);
  EXPECT_EQ(segments, 72);
}

TEST(FrameOverlay, EveryModelHasACaptionWithItsErrorOrItsReason) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const FrameOverlay overlay = frameOverlay(*inspection, 4);
  ASSERT_EQ(overlay.captions.size(), 2u);
  EXPECT_EQ(overlay.captions[0].model, "dual");  // from simple to rich
  EXPECT_TRUE(overlay.captions[0].problem);
  EXPECT_NE(overlay.captions[0].text.find("hyperboloid"), std::string::npos) << overlay.captions[0].text;
  EXPECT_EQ(overlay.captions[1].model, "canonical");
  EXPECT_FALSE(overlay.captions[1].problem);
  EXPECT_NE(overlay.captions[1].text.find("3.57 %"), std::string::npos) << overlay.captions[1].text;
}

TEST(FrameOverlay, HiddenRolesAndModelsAreLeftOut) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  OverlayOptions options;
  options.hidden = {OverlayRole::PredictedContour, OverlayRole::ObservedPeak};
  const FrameOverlay overlay = frameOverlay(*inspection, 0, options);
  EXPECT_TRUE(ofRole(overlay, OverlayRole::PredictedContour).empty());
  EXPECT_FALSE(ofRole(overlay, OverlayRole::ObservedContour).empty());
  for (const OverlayMark& mark : overlay.marks) EXPECT_NE(mark.role, OverlayRole::ObservedPeak);
  OverlayOptions onlyDual;
  onlyDual.models = {"dual"};
  for (const OverlayLine& line : frameOverlay(*inspection, 0, onlyDual).lines) EXPECT_NE(line.model, "canonical");
}

/// Models that are almost right lie on each other: the selected one is seen.
TEST(FrameOverlay, TheSelectedModelIsDrawnLast) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  OverlayOptions options;
  inspection->models["primal"] = inspection->models.at("canonical");
  for (const char* model : {"primal", "canonical"}) {
    options.selection = Selection{};
    options.selection->frame = 0;
    options.selection->model = model;
    const FrameOverlay overlay = frameOverlay(*inspection, 0, options);
    ASSERT_FALSE(overlay.lines.empty());
    EXPECT_EQ(overlay.lines.back().model, model);
    EXPECT_EQ(overlay.marks.back().model, model);
    EXPECT_EQ(overlay.captions[0].model, "primal") << "what is written keeps its order";
  }
  // Before the walk back there is the ellipse on T: with the predicted ellipse where no canonical one is shown anyway.
  options.hidden = {OverlayRole::CanonicalEllipse};
  const auto predicted = ofRole(frameOverlay(*inspection, 0, options), OverlayRole::PredictedEllipse);
  EXPECT_TRUE(std::any_of(predicted.begin(), predicted.end(), [](const OverlayLine& l) { return l.dash == Dash::Dotted; }));
  const auto both = ofRole(frameOverlay(*inspection, 0), OverlayRole::PredictedEllipse);
  EXPECT_TRUE(std::none_of(both.begin(), both.end(), [](const OverlayLine& l) { return l.dash == Dash::Dotted; }));
}

/// An ellipse in the colour of a model that was fitted to nothing would say that there is one.
TEST(FrameOverlay, AFailedFitHasNoCanonicalEllipse) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  EXPECT_FALSE(ofRole(frameOverlay(*inspection, 0), OverlayRole::CanonicalEllipse).empty());
  inspection->models.at("canonical").fits.at(0).fit = Failure{Reason::LightBehindSurface, "a stand-in"};
  for (FrameComparison& c : inspection->models.at("canonical").frames) c.prediction = Failure{Reason::LightBehindSurface, ""};
  for (const int frame : {0, 4}) EXPECT_TRUE(ofRole(frameOverlay(*inspection, frame), OverlayRole::CanonicalEllipse).empty());
}

TEST(Layers, AFailedFitHasNoCanonicalEllipse) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const LayerInput input = heldOutInput(*inspection);
  EXPECT_FALSE(canonicalEllipsesLayer(input).drawn.empty());
  inspection->models.at("canonical").fits.at(0).fit = Failure{Reason::LightBehindSurface, "a stand-in"};
  for (FrameComparison& c : inspection->models.at("canonical").frames) c.prediction = Failure{Reason::LightBehindSurface, ""};
  EXPECT_TRUE(canonicalEllipsesLayer(input).drawn.empty());
}

TEST(FrameOverlay, EarlierPredictionsArePaleAndSaySo) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  OverlayOptions options;
  options.predictionsEarlier = true;
  const auto now = ofRole(frameOverlay(*inspection, 4), OverlayRole::PredictedContour),
             earlier = ofRole(frameOverlay(*inspection, 4, options), OverlayRole::PredictedContour);
  ASSERT_EQ(now.size(), earlier.size());
  ASSERT_FALSE(now.empty());
  const Colour c = modelColour("canonical");
  for (std::size_t i = 0; i < now.size(); ++i) {
    EXPECT_NE(earlier[i].label.find("updating"), std::string::npos) << earlier[i].label;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(earlier[i].colour[std::size_t(k)], 0.5 * (c[std::size_t(k)] + 0.5), 1e-12);
  }
}

TEST(FrameOverlay, AFrameWithoutEvidenceSaysWhy) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  inspection->evidence[3].highlights.clear();
  inspection->evidence[3].failure = Failure{Reason::NoHighlight, "too dark"};
  const FrameOverlay overlay = frameOverlay(*inspection, 3);
  EXPECT_TRUE(ofRole(overlay, OverlayRole::ObservedContour).empty());
  ASSERT_FALSE(overlay.captions.empty());
  EXPECT_NE(overlay.captions[0].text.find("too dark"), std::string::npos);
  EXPECT_THROW(frameOverlay(*inspection, 6), std::invalid_argument);
}

TEST(FrameScore, CountsMatchedMissedAndSpurious) {
  ModelResult result;
  FrameComparison comparison;
  comparison.frame = 3;
  comparison.prediction = std::vector<PredictedHighlight>(2);
  comparison.iou = 0.8;
  ContourMetrics a, b;
  a.contourErrorPct = 1;
  a.contourErrorPx = 0.5;
  b.contourErrorPct = 3;
  b.contourErrorPx = 1.5;
  comparison.rows = {{0, 0, a, {}, {}}, {1, 1, b, {}, {}}, {2, -1, {}, {}, {}}, {-1, 2, {}, {}, {}}};
  result.frames = {comparison};
  const FrameScore score = frameScore(result, 3);
  EXPECT_EQ(score.matched, 2);
  EXPECT_EQ(score.missed, 1);
  EXPECT_EQ(score.spurious, 1);
  EXPECT_DOUBLE_EQ(*score.errorPct, 2);
  EXPECT_DOUBLE_EQ(*score.errorPx, 1);
  EXPECT_DOUBLE_EQ(*score.iou, 0.8);
  EXPECT_FALSE(frameScore(result, 4).errorPct);
  // A prediction that could not be compared is no good one: the others' mean must not stand for the frame.
  result.frames[0].rows = {{0, 0, a, {}, {}}, {1, 1, {}, Failure{Reason::NotConverged, "no distance"}, {}}};
  EXPECT_EQ(frameScore(result, 3).missed, 1);
  EXPECT_FALSE(wholeErrorPct(frameScore(result, 3)));
}

TEST(Style, ReportsAndViewsUseTheSameColours) {
  for (const char* model : {"primal", "dual", "canonical", "limit-angle", "reflectance"}) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(255 * modelColour(model)[c], modelRgb(model)[c], 0.51) << model;
  }
}

TEST(FrameOverlayExtent, IsThatOfTheClosedLinesAboutThePixel) {
  FrameOverlay overlay;
  const auto add = [&](OverlayRole role, bool closed, std::vector<Pixel> points) {
    OverlayLine line;
    line.role = role;
    line.closed = closed;
    line.points = std::move(points);
    overlay.lines.push_back(line);
  };
  add(OverlayRole::CanonicalEllipse, true, {{0, 0}, {10, 2}, {4, 8}});
  add(OverlayRole::CanonicalEllipse, true, {{1, -3}, {7, 3}, {2, 6}});
  add(OverlayRole::CanonicalEllipse, true, {{50, 50}, {60, 52}, {54, 58}});  // of another highlight
  add(OverlayRole::CanonicalEllipse, false, {{-90, -90}, {90, 90}});
  add(OverlayRole::ObservedContour, true, {{-50, -50}, {70, 0}, {0, 70}});
  const Eigen::AlignedBox2d box = extentAround(overlay, OverlayRole::CanonicalEllipse, {4, 2});
  EXPECT_EQ(box.min(), Pixel(0, -3));
  EXPECT_EQ(box.max(), Pixel(10, 8));
  EXPECT_TRUE(extentAround(overlay, OverlayRole::CanonicalEllipse, {30, 30}).isEmpty());
}

}  // namespace
}  // namespace glint::viz

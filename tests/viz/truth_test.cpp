// SPDX-License-Identifier: BSD-3-Clause
// A picture must not look better than what it shows: missed highlights, excluded frames, influences without an answer, what is
// loading.
#include <gmock/gmock.h>
#include <vtkActor.h>
#include <vtkMapper.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>

#include <algorithm>
#include <cmath>

#include "core/draw/plots.h"
#include "core/pipeline/frame_score.h"
#include "tests/viz/image_checks.h"
#include "tests/viz/small_inspection.h"
#include "viz/camera_colours.h"
#include "viz/layers.h"
#include "viz/pictures.h"
#include "viz/plot_export.h"
#include "viz/scene_legend.h"
#include "viz/scene_questions.h"
#include "viz/timeline_data.h"

namespace glint::viz {
namespace {

using test::countNear;
using test::smallInspection;
using test::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

constexpr double kPct = 100.0 / 28;  // error of every frame of smallInspection: 1 px of a diameter of 28
constexpr double kSmallPct = 0.25;   // of the highlight that is matched beside a missed one
constexpr int kTwo = 4;              // the frame with two highlights, held out

/// smallInspection with a second highlight in one frame that canonical misses; the first it predicts better than any other.
std::shared_ptr<Inspection> withAMiss(const std::filesystem::path& folder) {
  auto inspection = smallInspection(folder);
  Highlight second = inspection->evidence[kTwo].highlights[0];
  for (Pixel& p : second.contour.points) p.x() += 60;
  second.peak.x() += 60;
  inspection->evidence[kTwo].highlights.push_back(second);
  FrameComparison& c = inspection->models["canonical"].frames[kTwo];
  c.rows[0].metrics->contourErrorPct = kSmallPct;
  c.rows.push_back({1, -1, {}, Failure{Reason::NotReached, "no prediction overlaps this highlight"}, {}});
  return inspection;
}

const PlotSeries& seriesOf(const PlotData& plot, const std::string& name) {
  return *std::find_if(plot.series.begin(), plot.series.end(), [&](const PlotSeries& s) { return s.name == name; });
}

LayerInput inputOf(const Inspection& inspection, int frame = 0) {
  LayerInput input;
  input.inspection = &inspection;
  input.selection.frame = frame;
  input.models = modelsInOrder(inspection);
  for (int i = 0; i < int(inspection.scene->frames.size()); ++i) input.frames.push_back(i);
  return input;
}

TEST(Missed, AFrameWithAMissedHighlightHasNoErrorAlone) {
  const TemporaryFolder folder;
  const auto inspection = withAMiss(folder.path());
  const FrameScore score = frameScore(inspection->models.at("canonical"), kTwo);
  EXPECT_EQ(score.missed, 1);
  EXPECT_NEAR(*score.errorPct, kSmallPct, 1e-12);
  EXPECT_FALSE(wholeErrorPct(score));
  EXPECT_EQ(missedText(score), "missed 1 of 2 highlights, the other: 0.25 %");
  EXPECT_NEAR(*wholeErrorPct(frameScore(inspection->models.at("canonical"), 0)), kPct, 1e-12);
  EXPECT_EQ(missedText(frameScore(inspection->models.at("canonical"), 0)), "");
  EXPECT_EQ(missedText(frameScore(inspection->models.at("dual"), 0)), "missed the highlight");
}

class MissedDrawing : public test::PictureTest {};

TEST_F(MissedDrawing, TheLadderSaysItInsteadOfASmallError) {
  const TemporaryFolder folder;
  const auto inspection = withAMiss(folder.path()), whole = smallInspection(folder.path());
  for (const auto& i : {inspection, whole}) i->models.erase("dual");  // which misses every highlight
  const Outcome<Image> photograph = readPhotograph(inspection->scene->frames[kTwo]);
  const auto red = [&](const Inspection& i) { return countNear(ladderPicture(i, kTwo, photograph, 600, 400), kFailed, 0.1); };
  EXPECT_GT(red(*inspection), red(*whole) + 50) << "the words are in the colour of failures, and nothing else changed";
}

TEST(Missed, ThePlotHasACrossInsteadOfASmallError) {
  const TemporaryFolder folder;
  const PlotData plot = errorPlot(*withAMiss(folder.path()));
  const std::vector<PlotPoint>& points = seriesOf(plot, "canonical").points;
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(std::isfinite(points[std::size_t(i)].y), i != kTwo) << i;
    EXPECT_EQ(points[std::size_t(i)].noValue, i == kTwo) << i;
  }
  EXPECT_THAT(points[kTwo].label, HasSubstr("missed 1 of 2 highlights"));
  EXPECT_THAT(plot.noValue, HasSubstr("missed"));
  EXPECT_THAT(plot.title, HasSubstr("dual")) << "which predicts nothing at all is named";
  Selection s;
  s.frame = kTwo;
  s.model = "canonical";
  EXPECT_EQ(selectedSamples(plot, s).size(), 1u) << "the cross can be selected";
}

TEST_F(MissedDrawing, TheCrossStandsAboveAllErrorsAndIsPicked) {
  const TemporaryFolder folder;
  PlotView view;
  view.show(errorPlot(*withAMiss(folder.path())));
  Canvas canvas(600, 400, kDarkBackground);
  view.paint(canvas, 600, 400);
  const auto at = view.positionOf({0, kTwo});
  ASSERT_TRUE(at);
  for (int i = 0; i < 6; ++i) {
    if (i != kTwo) {
      EXPECT_LT(at->y(), view.positionOf({0, i})->y() - 5) << "higher up than " << i;
    }
  }
  const auto picked = view.at(*at + Eigen::Vector2d(1, 1), 6);
  ASSERT_TRUE(picked);
  EXPECT_EQ(picked->point, kTwo);
  // The mark is drawn: without it there is less of the model's colour.
  const PlotData with = errorPlot(*withAMiss(folder.path()));
  PlotData without = with;
  without.series[0].points[kTwo].noValue = false;
  const auto ink = [](const PlotData& plot) {
    return countNear(plotImage(plot, {true, 1}, {}, 600, 400), modelColour("canonical"), 0.04);
  };
  EXPECT_GT(ink(with), ink(without) + 8);
}

TEST(Missed, TheTimelineHasAMarkInsteadOfASmallError) {
  const TemporaryFolder folder;
  const auto inspection = withAMiss(folder.path());
  const TimelineData data = timelineData(*inspection->scene, inspection.get());
  const auto canonical =
      std::find_if(data.series.begin(), data.series.end(), [](const auto& s) { return s.model == "canonical"; });
  ASSERT_NE(canonical, data.series.end());
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(canonical->errorPct[std::size_t(i)].has_value(), i != kTwo) << i;
    EXPECT_EQ(canonical->missed[std::size_t(i)] != 0, i == kTwo) << i;
  }
  EXPECT_THAT(canonical->reason[kTwo], HasSubstr("missed 1 of 2 highlights"));
  EXPECT_TRUE(canonical->answers());
  EXPECT_FALSE(data.series.front().answers()) << "dual refused every frame";
  // More frames than columns: a mark is not lost.
  std::vector<char> marks(1000, 0);
  marks[537] = 1;
  const std::vector<char> columns = columnMarks(marks, 0, 1000, 100);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(columns[std::size_t(i)] != 0, i == 53) << i;
  EXPECT_TRUE(columnMarks({1, 0}, 1, 2, 1)[0] == 0) << "out of view";
}

TEST(Missed, ACameraIsNotColouredByTheErrorOfTheRest) {
  const TemporaryFolder folder;
  const auto inspection = withAMiss(folder.path());
  LayerInput input = inputOf(*inspection);
  input.colours.by = CameraColours::By::Error;
  input.colours.model = "canonical";
  EXPECT_EQ(cameraColour(input, 0).colour, errorColour(kPct));
  EXPECT_EQ(cameraColour(input, kTwo).colour, kMissed);
  EXPECT_THAT(cameraColour(input, kTwo).meaning, HasSubstr("missed"));
  input.colours.by = CameraColours::By::Model;
  EXPECT_EQ(cameraColour(input, 0).meaning, "best: canonical");
  EXPECT_THAT(cameraColour(input, kTwo).meaning, HasSubstr("missed")) << "none is best where all miss";
  EXPECT_THAT(cameraPicked(*inspection, {"canonical"}, kTwo).text, HasSubstr("missed 1 of 2"));
  EXPECT_THAT(cameraPicked(*inspection, {"canonical"}, kTwo).text, Not(HasSubstr("contour error")));
}

TEST(Excluded, TheCaptionOfAFrameSaysThatItIsNotEvaluated) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  inspection->request.excluded = {5};
  for (int frame = 0; frame < 6; ++frame)
    for (const OverlayCaption& caption : frameOverlay(*inspection, frame).captions)
      EXPECT_EQ(caption.text.find("excluded, not evaluated") != std::string::npos, frame == 5) << frame << " " << caption.text;
}

TEST(Excluded, FramesAreAKindOfTheirOwn) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  inspection->request.excluded = {5};
  const PlotData plot = errorPlot(*inspection);
  const PlotPoint& p = seriesOf(plot, "canonical").points[5];
  EXPECT_FALSE(std::isfinite(p.y)) << "it is not evaluated";
  EXPECT_FALSE(p.noValue) << "nor missed";
  EXPECT_THAT(p.label, HasSubstr("excluded"));
  ASSERT_EQ(plot.shades.size(), 2u);
  EXPECT_EQ(plot.shades[0].name, "training");
  EXPECT_EQ(plot.shades[1].name, "excluded");
  EXPECT_EQ(plot.shades[1].colour, kExcluded);
  EXPECT_EQ(plot.shades[1].from, 4.5);
  EXPECT_EQ(plot.shades[1].to, 5.5);
  LayerInput input = inputOf(*inspection);
  input.colours.model = "canonical";
  input.colours.influence = {{5, 1.0}};
  for (const auto by :
       {CameraColours::By::Role, CameraColours::By::Model, CameraColours::By::Error, CameraColours::By::Influence}) {
    input.colours.by = by;
    EXPECT_EQ(cameraColour(input, 5).colour, kExcluded) << int(by);
    EXPECT_NE(cameraColour(input, 4).colour, kExcluded) << int(by);
  }
  // A prediction in the colour of its frame's role.
  OverlayOptions options;
  options.colourByRole = true;
  const auto colourIn = [&](int frame) {
    for (const OverlayLine& line : frameOverlay(*inspection, frame, options).lines)
      if (line.role == OverlayRole::PredictedContour) return line.colour;
    return kObserved;
  };
  EXPECT_EQ(colourIn(5), kExcluded);
  EXPECT_EQ(colourIn(4), kHeldOut);
}

Influence influenceOfFour() {
  Influence influence;
  influence.trainingFrames = 4;
  influence.probes = {4, 5};
  for (int f = 0; f < 4; ++f) {
    FrameInfluence one;
    one.frame = f;
    one.models["canonical"].heldOutPct = 3;
    one.models["canonical"].changePct = 0.5;
    one.models["canonical"].axesChange = 0.12;
    influence.frames.push_back(one);
  }
  return influence;
}

TEST(InfluencePlot, SaysPointsWherePointsAreMeant) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  Influence influence = influenceOfFour();
  const PlotData plot = influencePlot(*inspection, influence, "canonical");
  EXPECT_EQ(plot.y.title, "change (percentage points)");
  const std::string& label = seriesOf(plot, "canonical").points[1].label;
  EXPECT_THAT(label, HasSubstr("3 % instead of 2.5 %: +0.5 points"));
  EXPECT_THAT(label, HasSubstr("12 % of its length"));
  EXPECT_THAT(influenceBar("canonical", 2).title, HasSubstr("percentage points"));
  // Without held-out frames the same places hold errors, which help and harm nobody.
  influence.probes.clear();
  for (FrameInfluence& f : influence.frames) f.models["canonical"].leftOutPct = 7;
  EXPECT_EQ(influencePlot(*inspection, influence, "canonical").y.title, "contour error (%)");
}

TEST(InfluencePlot, WithoutAFitItSaysWhy) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  Influence influence = influenceOfFour();
  for (FrameInfluence& f : influence.frames)
    f.models["canonical"] = {{}, {}, {}, {}, {}, Failure{Reason::TooFewViews, "3 views, 4 needed"}};
  const PlotData none = influencePlot(*inspection, influence, "canonical");
  EXPECT_TRUE(none.series.empty());
  EXPECT_THAT(none.empty, HasSubstr("canonical has no fit without frame 0000"));
  EXPECT_THAT(none.empty, HasSubstr("3 views, 4 needed"));
  EXPECT_THAT(influencePlot(*inspection, influence, "primal").empty, HasSubstr("'primal' was not computed"));
  // One frame alone without a fit: a cross, not a bar of no height.
  Influence some = influenceOfFour();
  some.frames[2].models["canonical"] = influence.frames[2].models["canonical"];
  const PlotData plot = influencePlot(*inspection, some, "canonical");
  ASSERT_TRUE(plot.empty.empty());
  for (int i = 0; i < 4; ++i) EXPECT_EQ(seriesOf(plot, "canonical").points[std::size_t(i)].noValue, i == 2) << i;
  EXPECT_THAT(seriesOf(plot, "canonical").points[2].label, HasSubstr("no fit"));
}

TEST(Layers, ASurfaceThatIsOnItsWayIsNoFailure) {
  const TemporaryFolder folder;
  Inspection before = *smallInspection(folder.path());
  LayerInput input = inputOf(before);
  before.surfaces = nullptr;
  EXPECT_EQ(surfaceLayer(input).notes.size(), 1u) << "results without one";
  before.evidence.clear();  // as it is before there are results
  const LayerContent loading = surfaceLayer(input);
  EXPECT_TRUE(loading.notes.empty()) << "notes are red";
  ASSERT_EQ(loading.remarks.size(), 1u);
  EXPECT_EQ(loading.remarks[0], "surface: loading\u2026");
  input.surfaceProblem = "no such file";
  before = *smallInspection(folder.path());
  EXPECT_THAT(surfaceLayer(input).notes.at(0), HasSubstr("no such file"));
}

/// The first thing that a layer draws for a model: its colour, and of how many lines it consists.
std::pair<Colour, int> lookOf(const LayerContent& content, const std::string& model) {
  for (const Drawn& drawn : content.drawn) {
    auto* const actor = vtkActor::SafeDownCast(drawn.prop);
    if (drawn.info.model != model || !actor) continue;
    auto* const data = vtkPolyData::SafeDownCast(actor->GetMapper()->GetInputDataObject(0, 0));
    const double* const c = actor->GetProperty()->GetColor();
    return {{c[0], c[1], c[2]}, int(data->GetNumberOfLines())};
  }
  return {};
}

TEST(PoorModel, IsPaleAndItsContoursAreDashed) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input = test::heldOutInput(*inspection);
  const Colour full = modelColour("canonical"), half = pale(full);
  const auto expectColour = [](const Colour& found, const Colour& wanted, const char* what) {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], wanted[i], 1e-9) << what;
  };
  EXPECT_EQ(lookOf(predictedContoursLayer(input), "canonical").second, 1) << "one line all around";
  expectColour(lookOf(predictedContoursLayer(input), "canonical").first, full, "contour");
  ModelFit& fit = *inspection->models["canonical"].fits[0].fit;
  fit.poor = "it misses its own training views";
  const auto [colour, lines] = lookOf(predictedContoursLayer(input), "canonical");
  expectColour(colour, half, "contour");
  EXPECT_GT(lines, 10) << "dashes";
  expectColour(lookOf(peaksLayer(input), "canonical").first, half, "brightest point");
  expectColour(lookOf(ellipsoidsLayer(input), "canonical").first, half, "ellipsoid");
  fit.lightEstimate = Light::at(Eigen::Vector3d(0, 0, 2));
  expectColour(lookOf(lightLayer(input), "canonical").first, half, "lamp");
  input.selection.model = "canonical";
  expectColour(lookOf(tangentPlanesLayer(input), "canonical").first, half, "tangent plane");
}

TEST(Samples, PlotsOfOneFrameNameIt) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const FrameSamples samples = frameSamples(*inspection, 5, "canonical");
  EXPECT_THAT(limitAnglePlot(samples, -1).title, HasSubstr("frame 0005"));
  EXPECT_THAT(lobePlot(samples, -1).title, HasSubstr("frame 0005"));
}

}  // namespace
}  // namespace glint::viz

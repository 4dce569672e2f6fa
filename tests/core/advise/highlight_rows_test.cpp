// SPDX-License-Identifier: BSD-3-Clause
// Rows of an evaluation made by hand: circles, whose areas and distances are known in closed form, and one of each status.
#include "core/advise/highlight_rows.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "core/advise/row_changes.h"
#include "core/base/numeric.h"

namespace glint {
namespace highlight_rows_tests {

using testing::HasSubstr;
using testing::Not;

Polyline circle(const Pixel& centre, double radius) {
  Polyline line;
  for (int i = 0; i < 720; ++i) {
    const double t = 2 * std::numbers::pi * i / 720;
    line.points.push_back(centre + radius * Pixel(std::cos(t), std::sin(t)));
  }
  return line;
}

Highlight seenAt(const Pixel& centre, double radius = 10) {
  Highlight h;
  h.light = "lamp";
  h.contour = circle(centre, radius);
  h.peak = centre;
  return h;
}

PredictedHighlight predictedAt(const Pixel& centre, double radius = 10) {
  PredictedHighlight p;
  p.contour = circle(centre, radius);
  p.brightest.pixel = centre;
  // Seen under 60 degrees: cameras stand in (0, 0, -2) and look along z.
  p.brightest.point.position = {0, 0, 0};
  p.brightest.point.normal = {std::sin(std::numbers::pi / 3), 0, -std::cos(std::numbers::pi / 3)};
  return p;
}

/// Frames with what they show; nothing predicted.
Inspection sequence(const std::vector<std::vector<Highlight>>& frames, const std::string& train = "first:1") {
  auto scene = std::make_shared<Scene>();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    Frame f;
    f.id = "f" + std::to_string(i);
    f.camera.camFromWorld = Eigen::Translation3d(0, 0, 2);
    scene->frames.push_back(f);
  }
  Inspection in;
  in.scene = in.given = scene;
  in.request.models = {"canonical"};
  in.request.train = train;
  in.train = parseTrainSpec(train, *scene);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    FrameEvidence e;
    e.frame = int(i);
    e.highlights = frames[i];
    in.evidence.push_back(e);
  }
  ModelFit fit;
  fit.model = "canonical";
  fit.light = "lamp";
  fit.family = LimitAngleFit{radians(12), {}};
  ModelResult& model = in.models["canonical"];
  model.model = "canonical";
  model.fits.push_back({"lamp", {}, fit, {}});
  return in;
}

void predict(Inspection& in, int frame, Prediction prediction, const std::vector<FrameComparison::Row>& rows) {
  FrameComparison c;
  c.frame = frame;
  c.light = "lamp";
  c.fit = 0;
  c.prediction = std::move(prediction);
  c.rows = rows;
  in.models.at("canonical").frames.push_back(std::move(c));
}

FrameComparison::Row pair(int observed, int predicted, double pct) {
  ContourMetrics m;
  m.contourErrorPct = pct;
  m.ellipseErrorPct = std::nan("");
  return {observed, predicted, m, {}, {}};
}
FrameComparison::Row alone(int observed, int predicted) { return {observed, predicted, {}, {}, {}}; }

/// One word, one meaning: as `evaluate --json` says it, with the same reason.
TEST(HighlightRows, AMatchByAPoorFitSaysSo) {
  Inspection in = sequence({{seenAt({50, 50})}, {seenAt({50, 50})}}, "first:1");
  predict(in, 0, std::vector{predictedAt({50, 50})}, {pair(0, 0, 1.0)});
  predict(in, 1, std::vector{predictedAt({50, 50})}, {pair(0, 0, 9.0)});
  in.models.at("canonical").fits[0].fit->poor = "4 px remain";
  for (const HighlightRow& row : highlightRows(in)) {
    EXPECT_EQ(nameOf(row.status), std::string("poor"));
    EXPECT_EQ(row.reason, "4 px remain");
  }
}

TEST(HighlightRows, EveryStatusHasItsRow) {
  Inspection in = sequence({{seenAt({50, 50})}, {seenAt({50, 50}), seenAt({90, 50})}, {}, {seenAt({50, 50})}, {}}, "first:1");
  in.request.excluded = {3};
  predict(in, 0, std::vector{predictedAt({50, 50})}, {pair(0, 0, 5.0)});
  predict(in, 1, std::vector{predictedAt({50, 50}), predictedAt({20, 20})}, {pair(0, 0, 5.001), alone(1, -1), alone(-1, 1)});
  predict(in, 2, Failure{Reason::NoBrightestPoint, "not visible"}, {});
  predict(in, 3, Failure{Reason::NoBrightestPoint, "not visible"}, {alone(0, -1)});
  predict(in, 4, Failure{Reason::NoBrightestPoint, "x"}, {{-1, -1, {}, Failure{Reason::FrameUnreadable, "no file"}, {}}});
  const std::vector<HighlightRow> rows = highlightRows(in);
  ASSERT_EQ(rows.size(), 7u);
  const std::vector<RowStatus> statuses{RowStatus::Ok,     RowStatus::FarOff, RowStatus::Missed,     RowStatus::Spurious,
                                        RowStatus::Failed, RowStatus::Failed, RowStatus::NotCompared};
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(nameOf(rows[i].status), std::string(nameOf(statuses[i]))) << i;
  EXPECT_EQ(rows[0].role, RowRole::Training);
  EXPECT_EQ(rows[1].role, RowRole::HeldOut);
  EXPECT_EQ(rows[5].role, RowRole::Excluded);
  EXPECT_EQ(rows[2].place, "lamp, highlight 2");
  EXPECT_EQ(rows[3].place, "lamp, predicted 2");
  for (const HighlightRow& r : rows) EXPECT_NE(r.reason.empty(), std::isnan(r.value(RowValue::ErrorPct))) << r.frame;
  // A model without a fit is refused, whatever its predictions say.
  in.models.at("canonical").fits[0].fit = Failure{Reason::NotConverged, "leaves too much"};
  EXPECT_EQ(highlightRows(in)[4].status, RowStatus::Refused);
}

TEST(HighlightRows, NumbersOfCircles) {
  Inspection in = sequence({{seenAt({50, 50}, 10)}});
  predict(in, 0, std::vector{predictedAt({50, 50}, 12)}, {pair(0, 0, 1)});
  const HighlightRow row = highlightRows(in).at(0);
  EXPECT_NEAR(row.value(RowValue::AreaRatio), 1.44, 1e-9);                                                // (12 / 10)^2
  const double polygon = std::sqrt(std::sin(2 * std::numbers::pi / 720) / (2 * std::numbers::pi / 720));  // of 720 sides
  EXPECT_NEAR(row.value(RowValue::ObservedPx), 20 * polygon, 1e-9);
  EXPECT_NEAR(row.value(RowValue::PredictedPx), 24 * polygon, 1e-9);
  EXPECT_NEAR(row.value(RowValue::IncidentDeg), 60, 1e-9);
  EXPECT_NEAR(row.value(RowValue::LimitDeg), 12, 1e-9);
  EXPECT_TRUE(std::isnan(row.value(RowValue::EllipsePct)));
  EXPECT_TRUE(std::isnan(row.value(RowValue::PeakRadiance))) << "0 means unknown";
  EXPECT_TRUE(std::isnan(row.value(RowValue::ResidualPx)));
  in.evidence[0].highlights[0].touchesBorder = true;
  EXPECT_TRUE(std::isnan(highlightRows(in).at(0).value(RowValue::AreaRatio))) << "nobody knows the whole area";
}

TEST(HighlightRows, EveryMetricHasItsColumn) {
  Inspection in = sequence({{seenAt({50, 50})}});
  FrameComparison::Row row = pair(0, 0, 1);
  row.metrics = ContourMetrics{.contourErrorPx = 2,
                               .contourErrorPct = 1,
                               .ellipseErrorPct = 3,
                               .hausdorffPx = 4,
                               .iou = 0.5,
                               .centreOffsetPx = 6,
                               .axisRatioError = 0.7,
                               .angleErrorDeg = 8,
                               .peakOffsetPx = 9};
  predict(in, 0, std::vector{predictedAt({50, 50})}, {row});
  const HighlightRow r = highlightRows(in).at(0);
  const std::vector<std::pair<RowValue, double>> expected{
      {RowValue::ErrorPx, 2},     {RowValue::ErrorPct, 1},    {RowValue::EllipsePct, 3},
      {RowValue::HausdorffPx, 4}, {RowValue::Iou, 0.5},       {RowValue::CentrePx, 6},
      {RowValue::PeakPx, 9},      {RowValue::AxisRatio, 0.7}, {RowValue::AxisAngleDeg, 8}};
  for (const auto& [column, value] : expected) EXPECT_EQ(r.value(column), value) << columnOf(column).id;
}

/// The fit says residuals in the order of the views it used; a view that was not usable has none.
TEST(HighlightRows, ResidualsBelongToTheirViews) {
  Inspection in = sequence({{seenAt({50, 50})}, {seenAt({30, 50}), seenAt({90, 50})}, {seenAt({50, 50})}}, "0-2");
  const std::vector<std::pair<int, int>> order{{0, 0}, {1, 0}, {1, 1}, {2, 0}};
  for (std::size_t i = 0; i < order.size(); ++i) {
    TrainingView v;
    v.frame = order[i].first;
    v.highlight = in.evidence[std::size_t(order[i].first)].highlights[std::size_t(order[i].second)];
    if (i != 1) v.seen = SeenOnSurface{};
    in.views.push_back(v);
  }
  ModelFit fit = *in.models.at("canonical").fits[0].fit;
  fit.frames = {0, 1, 2};  // the first highlight of frame 1 could not be used
  fit.residualPx = {0.1, 0.2, 0.3};
  in.models.at("canonical").fits[0].fit = fit;
  predict(in, 0, std::vector{predictedAt({50, 50})}, {pair(0, 0, 1)});
  predict(in, 1, std::vector{predictedAt({30, 50}), predictedAt({90, 50})}, {pair(0, 0, 1), pair(1, 1, 1)});
  predict(in, 2, std::vector{predictedAt({50, 50})}, {pair(0, 0, 1)});
  const std::vector<HighlightRow> rows = highlightRows(in);
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0].value(RowValue::ResidualPx), 0.1);
  EXPECT_TRUE(std::isnan(rows[1].value(RowValue::ResidualPx)));
  EXPECT_EQ(rows[2].value(RowValue::ResidualPx), 0.2);
  EXPECT_EQ(rows[3].value(RowValue::ResidualPx), 0.3);
}

TEST(HighlightRows, ColumnsHaveIdsOfTheirOwn) {
  for (std::size_t i = 0; i < kRowValues; ++i) EXPECT_EQ(rowValueOf(highlightColumns()[i].id), RowValue(i));
  EXPECT_EQ(rowValueOf("no such column"), RowValue::Count);
}

/// Frame 0 trains; 1 to 5 are held out. Errors by hand.
Inspection errorsOf(const std::vector<double>& pct, const std::vector<Highlight>& seen) {
  std::vector<std::vector<Highlight>> frames;
  for (const Highlight& h : seen) frames.push_back({h});
  Inspection in = sequence(frames);
  for (std::size_t i = 0; i < pct.size(); ++i) {
    if (std::isnan(pct[i]))
      predict(in, int(i), std::vector{predictedAt({5, 5})}, {alone(0, -1), alone(-1, 0)});
    else
      predict(in, int(i), std::vector{predictedAt(seen[i].peak)}, {pair(0, 0, pct[i])});
  }
  return in;
}

TEST(RowChanges, MeansAreOverWhatBothHave) {
  const double none = std::nan("");
  const std::vector<Highlight> seen(6, seenAt({50, 50}));
  const Inspection before = errorsOf({1, 4, 2, 6, none, 8}, seen);
  Inspection after = errorsOf({9, 2, 3, 6, 5, none}, seen);
  const auto a = highlightRows(before), b = highlightRows(after);
  const std::vector<ErrorChange> changes = errorChanges(before, a, after, b);
  ASSERT_EQ(changes.size(), 1u);
  const ErrorChange& c = changes[0];
  EXPECT_EQ(c.highlights, 3);  // of frames 1 to 3: 4, 2, 6 -> 2, 3, 6
  EXPECT_EQ(c.frames, 3);
  EXPECT_DOUBLE_EQ(c.meanBefore, 4);
  EXPECT_DOUBLE_EQ(c.meanAfter, 11.0 / 3);
  EXPECT_EQ(c.better, 1);
  EXPECT_EQ(c.worse, 1);
  EXPECT_EQ(c.gained, 1);  // frame 4
  EXPECT_EQ(c.lost, 1);    // frame 5
  EXPECT_EQ(c.withoutBefore, 1);
  EXPECT_EQ(c.withoutAfter, 1);
  EXPECT_EQ(c.spuriousBefore, 1);
  EXPECT_EQ(c.elsewhere, 1);  // frame 0 trains
  EXPECT_EQ(
      textOf(c),
      "held-out mean 4 % \u2192 3.67 % (3 highlights in 3 frames: 1 better, 1 worse, 1 the same); 1 highlight lost the "
      "prediction and "
      "is in no mean; 1 highlight gained a prediction and is in no mean; without prediction 1 \u2192 1; spurious 1 \u2192 1");
  // Nothing in common is said, and no number stands for it.
  after.request.excluded = {1, 2, 3, 4, 5};
  const auto c2 = errorChanges(before, a, after, highlightRows(after));
  EXPECT_EQ(c2[0].highlights, 0);
  EXPECT_TRUE(std::isnan(c2[0].meanAfter));
  EXPECT_THAT(textOf(c2[0]), HasSubstr("no held-out highlight has an error in both"));
  EXPECT_THAT(textOf(c2[0]), Not(HasSubstr("nan")));
}

/// No count is that of its opposite.
TEST(RowChanges, SaysWhichWayItWent) {
  const double none = std::nan("");
  const std::vector<Highlight> seen(9, seenAt({50, 50}));
  const Inspection before = errorsOf({1, 4, 4, 4, 2, none, none, none, 8}, seen);
  const Inspection after = errorsOf({1, 2, 2, 2, 3, 5, 5, none, none}, seen);
  const ErrorChange c = errorChanges(before, highlightRows(before), after, highlightRows(after)).at(0);
  EXPECT_EQ(c.better, 3);  // frames 1 to 3
  EXPECT_EQ(c.worse, 1);
  EXPECT_EQ(c.gained, 2);  // 5 and 6
  EXPECT_EQ(c.lost, 1);    // 8
  EXPECT_EQ(c.withoutBefore, 3);
  EXPECT_EQ(c.withoutAfter, 2);
  EXPECT_EQ(c.spuriousBefore, 3);
  EXPECT_EQ(c.spuriousAfter, 2);
}

/// Detection may order and place highlights anew: the one in the same place is the same one.
TEST(RowChanges, HighlightsAreFollowedByTheirPlace) {
  Inspection before = sequence({{}, {seenAt({30, 50}), seenAt({90, 50}), seenAt({150, 50})}});
  Inspection after = sequence({{}, {seenAt({91, 50}), seenAt({30, 50}), seenAt({300, 50})}});
  const std::vector<PredictedHighlight> three(3, predictedAt({0, 0}));
  predict(before, 1, three, {pair(0, 0, 1), pair(1, 1, 2), pair(2, 2, 3)});
  predict(after, 1, three, {pair(0, 0, 4), pair(1, 1, 5), pair(2, 2, 6)});
  const auto a = highlightRows(before), b = highlightRows(after);
  EXPECT_EQ(counterparts(before, a, after, b), (std::vector<int>{1, 0, -1}));
  // The only one of its light is the same one, wherever it is now.
  Inspection one = sequence({{}, {seenAt({30, 50})}}), moved = sequence({{}, {seenAt({70, 50})}});
  predict(one, 1, std::vector{predictedAt({30, 50})}, {pair(0, 0, 1)});
  predict(moved, 1, std::vector{predictedAt({70, 50})}, {pair(0, 0, 1)});
  EXPECT_EQ(counterparts(one, highlightRows(one), moved, highlightRows(moved)), std::vector<int>{0});
}

}  // namespace highlight_rows_tests
}  // namespace glint

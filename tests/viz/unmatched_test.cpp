// SPDX-License-Identifier: BSD-3-Clause
// A contour is taken away from its prediction: both must look, be picked and be described as what has no partner.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/draw/frame_overlay.h"
#include "core/draw/plots.h"
#include "core/draw/selection.h"
#include "core/pipeline/comparison.h"
#include "tests/viz/small_inspection.h"
#include "viz/frame_pick.h"
#include "viz/timeline_data.h"

namespace glint::unmatched_tests {

using test::smallInspection;
using test::TemporaryFolder;
using namespace viz;

constexpr int kFrame = 2;
constexpr double kAway = 60;  // px: more than both radii, so that nothing overlaps

/// smallInspection with the observed highlight of frame 2 beside its prediction.
std::shared_ptr<Inspection> apart(const TemporaryFolder& folder) {
  std::shared_ptr<Inspection> r = smallInspection(folder.path());
  Highlight& h = r->evidence[kFrame].highlights[0];
  for (Pixel& p : h.contour.points) p.x() += kAway;
  h.peak.x() += kAway;
  h.ellipse->centre.x() += kAway;
  for (FrameComparison& c : r->models.at("canonical").frames)
    if (c.frame == kFrame) {
      c = compareFrame(r->evidence[kFrame], c.light, r->scene->frames[kFrame].camera, c.prediction);
    }
  return r;
}

const OverlayLine* lineOf(const FrameOverlay& overlay, OverlayRole role) {
  for (const OverlayLine& line : overlay.lines)
    if (line.role == role) return &line;
  return nullptr;
}

TEST(Unmatched, HasDashesAndASymbolOfItsOwn) {
  const TemporaryFolder folder;
  const auto r = apart(folder);
  const FrameOverlay overlay = frameOverlay(*r, kFrame), usual = frameOverlay(*r, kFrame + 1);
  EXPECT_EQ(lineOf(overlay, OverlayRole::ObservedContour)->dash, Dash::Dashed);
  EXPECT_EQ(lineOf(overlay, OverlayRole::PredictedContour)->dash, Dash::DashDotted);
  EXPECT_EQ(lineOf(usual, OverlayRole::ObservedContour)->dash, Dash::Solid);
  EXPECT_NE(lineOf(usual, OverlayRole::PredictedContour)->dash, Dash::DashDotted);
  EXPECT_NE(lineOf(overlay, OverlayRole::ObservedContour)->label.find("missed by canonical"), std::string::npos);
  EXPECT_NE(lineOf(overlay, OverlayRole::PredictedContour)->label.find("spurious"), std::string::npos);
  const auto count = [](const FrameOverlay& o, MarkShape shape) {
    return std::count_if(o.marks.begin(), o.marks.end(), [&](const OverlayMark& m) { return m.shape == shape; });
  };
  EXPECT_EQ(count(overlay, MarkShape::Square), 1);
  EXPECT_EQ(count(overlay, MarkShape::Triangle), 1);
  EXPECT_EQ(count(usual, MarkShape::Square) + count(usual, MarkShape::Triangle), 0);
  OverlayOptions hidden;
  hidden.hidden = {OverlayRole::Unmatched};
  EXPECT_EQ(count(frameOverlay(*r, kFrame, hidden), MarkShape::Square), 0);
}

TEST(Unmatched, IsMissedOnlyByTheSelectedModel) {
  const TemporaryFolder folder;
  const auto r = apart(folder);
  OverlayOptions options;
  options.selection = Selection{kFrame, "dual"};  // it refuses everywhere: its fit says why
  EXPECT_EQ(lineOf(frameOverlay(*r, kFrame, options), OverlayRole::ObservedContour)->dash, Dash::Solid);
  options.selection = Selection{kFrame, "canonical"};
  EXPECT_EQ(lineOf(frameOverlay(*r, kFrame, options), OverlayRole::ObservedContour)->dash, Dash::Dashed);
}

/// By one pass over all frames the same as frame by frame; a model that refuses everywhere misses nothing.
TEST(Unmatched, OfAllFramesAtOnce) {
  const TemporaryFolder folder;
  const auto r = apart(folder);
  const std::map<int, draw::FrameUnmatched> all = draw::unmatchedByFrame(*r);
  ASSERT_EQ(all.size(), 1u);
  const draw::FrameUnmatched& here = all.at(kFrame);
  EXPECT_EQ(here.missedBy, (std::map<int, std::vector<std::string>>{{0, {"canonical"}}}));
  ASSERT_EQ(here.spurious.size(), 1u);
  EXPECT_EQ(here.spurious[0], (draw::FrameUnmatched::Spurious{"canonical", "lamp", 0}));
  for (int f = 0; f < 6; ++f)
    EXPECT_EQ(draw::missedBy(*r, f, 0, [](const std::string&) { return true; }).empty(), !all.count(f)) << f;
}

TEST(Unmatched, AClickSelectsEither) {
  const TemporaryFolder folder;
  const auto r = apart(folder);
  const FrameOverlay overlay = frameOverlay(*r, kFrame);
  Selection now;
  now.frame = kFrame;
  const Selection spurious = pickInFrame(*r, now, overlay, lineOf(overlay, OverlayRole::PredictedContour)->points[3], 2);
  EXPECT_EQ(spurious.model, "canonical");
  EXPECT_EQ(spurious.predicted, 0);
  EXPECT_EQ(spurious.highlight, -1);
  EXPECT_FALSE(spurious.light.empty());
  const PredictedHighlight* const h = draw::selectedSpurious(*r, spurious);
  ASSERT_TRUE(h);
  EXPECT_EQ(h->contour.points[3], lineOf(overlay, OverlayRole::PredictedContour)->points[3]);
  const Selection missed = pickInFrame(*r, spurious, overlay, lineOf(overlay, OverlayRole::ObservedContour)->points[3], 2);
  EXPECT_EQ(missed.highlight, 0);
  EXPECT_EQ(missed.predicted, -1);
  EXPECT_EQ(missed.model, "canonical");
  const draw::UnmatchedRow row = draw::selectedUnmatched(*r, missed, "");
  ASSERT_TRUE(row.row);
  EXPECT_EQ(row.row->observed, 0);
  EXPECT_EQ(row.row->predicted, -1);
}

TEST(Unmatched, IsGoneWhereItHasAPartner) {
  const TemporaryFolder folder;
  const auto r = smallInspection(folder.path());
  Selection s{kFrame, "canonical"};
  s.predicted = 0;
  EXPECT_FALSE(draw::selectedSpurious(*r, s));
  s.predicted = 17;
  EXPECT_FALSE(draw::selectedSpurious(*r, s));
}

TEST(Unmatched, TimelineAndPlotMarkTheFrameAndGiveItNoError) {
  const TemporaryFolder folder;
  const auto r = apart(folder);
  const TimelineData data = timelineData(*r->scene, r.get());
  const auto series =
      std::find_if(data.series.begin(), data.series.end(), [](const TimelineData::Series& s) { return s.model == "canonical"; });
  ASSERT_NE(series, data.series.end());
  EXPECT_TRUE(series->missed[kFrame]);
  EXPECT_TRUE(series->spurious[kFrame]);
  EXPECT_FALSE(series->errorPct[kFrame]);
  EXPECT_FALSE(series->spurious[kFrame + 1]);
  const draw::PlotData plot = draw::errorPlot(*r, {});
  for (const draw::PlotSeries& s : plot.series)
    for (const draw::PlotPoint& p : s.points)
      if (s.name.rfind("canonical", 0) == 0) {
        EXPECT_EQ(p.triangle, p.target.frame == kFrame) << p.target.frame;
      }
}

TEST(Unmatched, FilteredOnesAreGhostsThatNoClickSelects) {
  const TemporaryFolder folder;
  const auto r = smallInspection(folder.path());
  FrameComparison* shown = nullptr;
  for (FrameComparison& c : r->models.at("canonical").frames)
    if (c.frame == kFrame) shown = &c;
  ASSERT_TRUE(shown);
  PredictedHighlight ghost = shown->prediction.highlights()[0];
  for (Pixel& p : ghost.contour.points) p.x() -= kAway;
  shown->prediction.filtered.push_back({ghost, "small"});
  const FrameOverlay overlay = frameOverlay(*r, kFrame);
  const auto line = std::find_if(overlay.lines.begin(), overlay.lines.end(),
                                 [](const OverlayLine& l) { return l.label.find("filtered: small") != std::string::npos; });
  ASSERT_NE(line, overlay.lines.end());
  EXPECT_EQ(line->dash, Dash::Dotted);
  EXPECT_LT(line->width, 1);
  Selection now;
  now.frame = kFrame;
  const Selection picked = pickInFrame(*r, now, overlay, line->points[3], 2);
  EXPECT_EQ(picked.model, "");
  EXPECT_EQ(picked.predicted, -1);
}

}  // namespace glint::unmatched_tests

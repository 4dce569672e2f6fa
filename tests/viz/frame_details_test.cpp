// SPDX-License-Identifier: BSD-3-Clause
// Arrows, marks, picking and epipolar lines on the hand-built inspection: observed circles of 14 px, predicted ones of 15 px.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/draw/epipolar_overlay.h"
#include "tests/viz/small_inspection.h"
#include "viz/frame_pick.h"
#include "viz/timeline_data.h"

namespace glint::viz {
namespace {

using test::smallInspection;
using test::TemporaryFolder;

constexpr double kSag = 0.02;  // a circle of 72 vertices is that much flatter between them, px

TEST(FrameDetails, ResidualArrowsGoFromObservedToPredicted) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  for (const double scale : {1.0, 10.0}) {
    OverlayOptions options;
    options.residualScale = scale;
    int arrows = 0;
    const Pixel centre = inspection->evidence[1].highlights[0].ellipse->centre;
    for (const OverlayLine& line : frameOverlay(*inspection, 1, options).lines) {
      if (line.role != OverlayRole::ResidualArrows) continue;
      ++arrows;
      EXPECT_NEAR((line.points[0] - centre).norm(), 14, kSag);
      EXPECT_NEAR((line.points[1] - centre).norm(), 14 + scale, scale * 2 * kSag);
    }
    EXPECT_EQ(arrows, 36);
  }
}

TEST(FrameDetails, TheSelectedPointIsMarkedOnAllContours) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  OverlayOptions options;
  options.selection = Selection{1, "", 0};
  options.selection->direction = 0.7;
  const Pixel centre = inspection->evidence[1].highlights[0].ellipse->centre, along(std::cos(0.7), std::sin(0.7));
  std::vector<OverlayMark> marks;
  for (const OverlayMark& mark : frameOverlay(*inspection, 1, options).marks)
    if (mark.role == OverlayRole::SelectedPoint) marks.push_back(mark);
  ASSERT_EQ(marks.size(), 2u);
  EXPECT_LT((marks[0].at - (centre + 14 * along)).norm(), kSag);
  EXPECT_EQ(marks[1].model, "canonical");
  EXPECT_LT((marks[1].at - (centre + 15 * along)).norm(), kSag);
  options.hiddenModels = {"canonical"};
  const FrameOverlay hidden = frameOverlay(*inspection, 1, options);
  for (const OverlayLine& line : hidden.lines) EXPECT_NE(line.model, "canonical");
  EXPECT_EQ(hidden.captions.size(), 2u);  // the numbers stay
}

TEST(FrameDetails, HeldOutPredictionsAreDashed) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  for (int frame = 0; frame < 6; ++frame)
    for (const OverlayLine& line : frameOverlay(*inspection, frame).lines) {
      if (line.role != OverlayRole::PredictedContour) continue;
      EXPECT_EQ(line.dash, inspection->isTraining(frame) ? Dash::Solid : Dash::Dashed) << frame;
    }
}

TEST(FramePick, ContoursInsideAndOutside) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const FrameOverlay overlay = frameOverlay(*inspection, 1);
  const Pixel centre = inspection->evidence[1].highlights[0].ellipse->centre;
  Selection now{1, "dual"};
  const Selection observed = pickInFrame(*inspection, now, overlay, centre + Pixel(0, 13.8), 2);
  EXPECT_EQ(observed.highlight, 0);
  EXPECT_EQ(observed.model, "dual");
  ASSERT_TRUE(observed.direction);
  EXPECT_NEAR(*observed.direction, std::acos(0.0), 1e-3);
  const Selection predicted = pickInFrame(*inspection, now, overlay, centre + Pixel(-15.2, 0), 2);
  EXPECT_EQ(predicted.model, "canonical");
  EXPECT_EQ(predicted.highlight, 0);
  EXPECT_NEAR(std::abs(*predicted.direction), std::acos(-1.0), 1e-3);
  const Selection inside = pickInFrame(*inspection, now, overlay, centre, 2);
  EXPECT_EQ(inside.highlight, 0);
  EXPECT_FALSE(inside.direction);
  EXPECT_EQ(pickInFrame(*inspection, now, overlay, centre + Pixel(60, 0), 2).highlight, -1);
  EXPECT_NE(labelAt(overlay, centre + Pixel(-15.2, 0), 2).find("canonical"), std::string::npos);
}

/// Two models that predict the same: a click there leaves the selected one selected, whichever is drawn on top.
TEST(FramePick, TheSelectedModelStaysWhereContoursOverlap) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  FrameOverlay overlay = frameOverlay(*inspection, 1);
  // The contour of one model, drawn a second time for another, on top.
  const auto canonical = std::find_if(overlay.lines.begin(), overlay.lines.end(), [](const OverlayLine& line) {
    return line.role == OverlayRole::PredictedContour && line.model == "canonical";
  });
  ASSERT_NE(canonical, overlay.lines.end());
  OverlayLine second = *canonical;
  second.model = "dual";
  overlay.lines.push_back(second);
  const Pixel centre = inspection->evidence[1].highlights[0].ellipse->centre, at = centre + Pixel(-15.2, 0);
  for (const std::string model : {"dual", "canonical"}) {
    const Selection picked = pickInFrame(*inspection, {1, model}, overlay, at, 2);
    EXPECT_EQ(picked.model, model);
  }
  EXPECT_NE(pickInFrame(*inspection, {1, ""}, overlay, at, 2).model, "");
}

TEST(EpipolarPicture, LinesTouchTheEllipsesAndTheMissIsTheirs) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  PairRequest request;
  request.frames = {0, 4};
  const EpipolarPicture picture = epipolarPicture(*inspection, request);
  ASSERT_TRUE(picture.tangents) << picture.failure->message();
  for (std::size_t i = 0; i < 2; ++i) {
    const Ellipse& e = *inspection->evidence[static_cast<std::size_t>(request.frames[i])].highlights[0].ellipse;
    const EpipolarView& view = i == 0 ? picture.tangents->first : picture.tangents->second;
    int solid = 0, dashed = 0;
    for (const OverlayLine& line : picture.frames[i].lines) {
      const Eigen::Vector3d through = line.points[0].homogeneous().cross(line.points[1].homogeneous());
      const double distance = std::abs(through.dot(e.centre.homogeneous())) / through.head<2>().norm();
      const double miss = line.dash == Dash::Solid ? 0 : view.missPx[static_cast<std::size_t>(dashed)];
      EXPECT_NEAR(distance - e.semiAxes.x(), miss, 1e-6);
      ++(line.dash == Dash::Solid ? solid : dashed);
    }
    EXPECT_EQ(solid, 2);
    EXPECT_EQ(dashed, 2);
  }
  request.frames = {2, 2};
  EXPECT_EQ(epipolarPicture(*inspection, request).failure->reason, Reason::RankDeficient);
  request.frames = {0, 6};
  EXPECT_THROW((void)epipolarPicture(*inspection, request), std::invalid_argument);
}

/// A scene that states no lights: its rows are of those that were found, also in a frame where one is switched off.
TEST(TimelineData, LightsThatWereFound) {
  Scene scene;
  scene.frames.resize(3);
  Inspection inspection;
  inspection.evidence.resize(3);
  const auto show = [](FrameEvidence& e, const char* light) { e.highlights.emplace_back().light = light; };
  show(inspection.evidence[0], "light 1");
  EXPECT_TRUE(lightRows(scene, &inspection).empty()) << "a single one";
  show(inspection.evidence[1], "light 1");
  show(inspection.evidence[1], "light 2");
  inspection.evidenceBefore[2] = inspection.evidence[1];
  EXPECT_TRUE(lightRows(scene, nullptr).empty()) << "nothing is known before the first result";
  const std::vector<LightRow> rows = lightRows(scene, &inspection);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].light, "light 2");
  EXPECT_EQ(rows[1].captured, (std::vector<LightState>{LightState::NotStated, LightState::On, LightState::On}));
}

TEST(TimelineData, LightsErrorsAndColumns) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  auto scene = std::make_shared<Scene>(*inspection->scene);
  for (Frame& frame : scene->frames) frame.lightsOn = {"a"};
  EXPECT_TRUE(timelineData(*scene, nullptr).lights.empty());  // one light, always on: nothing to show
  scene->frames[1].lightsOn = {"a", "b"};
  scene->frames[2].lightsOn = {};
  TimelineData data = timelineData(*scene, inspection.get());
  data.lights = lightRows(*scene, nullptr);
  ASSERT_EQ(data.lights.size(), 2u);
  EXPECT_EQ(data.lights[1].light, "b");
  // In the order of the scene, whatever their names are.
  Scene named = *scene;
  named.lights.clear();
  for (const char* id : {"b", "a"}) {
    TrueLight light;
    light.id = id;
    named.lights.push_back(light);
  }
  ASSERT_EQ(timelineData(named, nullptr).lights.size(), 2u);
  EXPECT_EQ(timelineData(named, nullptr).lights[0].light, "b");
  const LightRow& b = data.lights[1];
  EXPECT_EQ(std::vector<LightState>(b.captured.begin(), b.captured.begin() + 3),
            (std::vector<LightState>{LightState::Off, LightState::On, LightState::NotStated}));
  // As switched by hand; what was captured dark can be lit only where contours are synthesised.
  WhatIf w = switched(switched({}, *scene, 0, "b", true), *scene, 1, "b", false);
  EXPECT_EQ(lightState(b, *scene, w, 0), LightState::Off);
  EXPECT_EQ(lightState(b, *scene, w, 1), LightState::SwitchedOff);
  w.synthesise = true;
  EXPECT_EQ(lightState(b, *scene, w, 0), LightState::SwitchedOn);
  EXPECT_EQ(lightState(b, *scene, w, 3), LightState::Off);
  ASSERT_EQ(data.series.size(), 2u);
  for (int frame = 0; frame < 6; ++frame) {
    EXPECT_EQ(data.series[1].errorPct[static_cast<std::size_t>(frame)],
              frameScore(inspection->models.at("canonical"), frame).errorPct);
  }
  const ErrorAxis axis = errorAxis(data, "canonical", {});
  EXPECT_FALSE(axis.logarithmic);
  EXPECT_DOUBLE_EQ(axis.highPct, 5);  // errors of 15 px circles about 14 px ones are 1 / 28
  EXPECT_DOUBLE_EQ(axis.place(2.5), 0.5);
  ErrorAxis wide;
  wide.lowPct = 0.1;
  wide.highPct = 1000;
  wide.logarithmic = true;
  EXPECT_NEAR(wide.place(10), 0.5, 1e-12);
  std::vector<std::optional<double>> errors(1000, 1.0);
  errors[503] = 7;
  errors[10].reset();
  const auto columns = columnMaxima(errors, 0, 1000, 100);
  EXPECT_EQ(columns[50], 7.0);
  EXPECT_EQ(columns[49], 1.0);
  EXPECT_FALSE(columnMaxima({std::nullopt, 3.0}, 0, 2, 2)[0]);
}

}  // namespace
}  // namespace glint::viz

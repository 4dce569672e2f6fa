// SPDX-License-Identifier: BSD-3-Clause
// A hand in the picture: what it holds goes where it goes.
#include <gtest/gtest.h>

#include "core/geometry/polyline.h"
#include "core/pipeline/what_if.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {

using namespace testing_support;

constexpr double kPx = 1e-9;  // rounding of pixels of some hundreds

struct Dragging {
  std::shared_ptr<Scene> scene = exactScene(sheet(0.3), 6);
  const Highlight& highlight(int frame) const { return scene->frames[std::size_t(frame)].highlights.front(); }
  Camera camera(int frame, const WhatIf& w) const { return changedScene(*scene, w, 0.5)->frames[std::size_t(frame)].camera; }
};

TEST(Dragged, APeakAndAContourMoveByWhatTheHandMoves) {
  const Dragging d;
  const Highlight before = d.highlight(2);
  const Pixel from(100, 80), to(103.5, 78.25);
  const Highlight peak = changed(before, dragged({}, Held::Peak, 2, d.camera(2, {}), 0, before, from, to).highlights.at({2, 0}));
  EXPECT_LT((peak.peak - before.peak - Pixel(3.5, -1.75)).norm(), kPx);
  EXPECT_EQ(peak.contour.points, before.contour.points);
  const Highlight whole =
      changed(before, dragged({}, Held::Contour, 2, d.camera(2, {}), 0, before, from, to).highlights.at({2, 0}));
  EXPECT_LT((whole.contour.points[7] - before.contour.points[7] - Pixel(3.5, -1.75)).norm(), kPx);
  EXPECT_EQ(whole.peak, before.peak);
}

TEST(Dragged, AContourPointHeldForItsSizeStaysUnderTheHand) {
  const Dragging d;
  const Highlight before = d.highlight(1);
  const Pixel centre = centroid(before.contour), from = before.contour.points[5], to = centre + 1.7 * (from - centre);
  WhatIf w = dragged({}, Held::ContourSize, 1, d.camera(1, {}), 0, before, from, to);
  Highlight now = changed(before, w.highlights.at({1, 0}));
  EXPECT_LT((now.contour.points[5] - to).norm(), kPx);
  // Once more, from where it is now.
  const Pixel further = centre + 0.6 * (from - centre);
  w = dragged(w, Held::ContourSize, 1, d.camera(1, {}), 0, now, to, further);
  now = changed(before, w.highlights.at({1, 0}));
  EXPECT_LT((now.contour.points[5] - further).norm(), kPx);
}

TEST(Dragged, WhatACameraSeesUnderTheHandStaysUnderIt) {
  const Dragging d;
  const Eigen::Vector3d thing = d.camera(3, {}).ray({210, 160}).direction * 7.0 + d.camera(3, {}).centreInWorld();
  WhatIf w = dragged({}, Held::Camera, 3, d.camera(3, {}), -1, {}, {210, 160}, {260, 120});
  ASSERT_TRUE(d.camera(3, w).project(thing));
  EXPECT_LT((*d.camera(3, w).project(thing) - Pixel(260, 120)).norm(), kPx);
  EXPECT_LT((d.camera(3, w).centreInWorld() - d.camera(3, {}).centreInWorld()).norm(), kPx);
  // A second drag goes on from the first.
  w = dragged(w, Held::Camera, 3, d.camera(3, w), -1, {}, {260, 120}, {190, 200});
  EXPECT_LT((*d.camera(3, w).project(thing) - Pixel(190, 200)).norm(), 10 * kPx);
}

TEST(Dragged, NothingHappensWhereNothingCan) {
  const Dragging d;
  const Highlight h = d.highlight(0);
  const Camera c = d.camera(0, {});
  for (const Held held : {Held::Peak, Held::Contour, Held::ContourSize, Held::Camera}) {
    EXPECT_TRUE(dragged({}, held, 0, c, 0, h, {5, 5}, {5, 5}).none());
    EXPECT_TRUE(dragged({}, held, 0, c, 0, h, {5, 5}, {std::nan(""), 5}).none());
  }
  EXPECT_TRUE(dragged({}, Held::ContourSize, 0, c, 0, h, centroid(h.contour), {50, 50}).none());
  EXPECT_GT(
      dragged({}, Held::ContourSize, 0, c, 0, h, h.contour.points[0], centroid(h.contour)).highlights.at({0, 0}).contourScale, 0);
}

TEST(DraggedLight, MovesByTheVectorUnlessItIsAtInfinity) {
  TrueLight lamp;
  lamp.id = "lamp";
  lamp.lamp = lampAt(Eigen::Vector3d(1, 2, 3));
  WhatIf w = draggedLight({}, lamp, {0.1, 0, -0.2});
  w = draggedLight(w, lamp, {0.1, 0.5, 0});
  EXPECT_LT((w.lightsBy.at("lamp") - Eigen::Vector3d(0.2, 0.5, -0.2)).norm(), 1e-15);
  lamp.lamp = lampTowards(Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(draggedLight({}, lamp, {0.1, 0, 0}).none());
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/comparison.h"

#include <gtest/gtest.h>

#include <random>

namespace glint {
namespace {

Camera imageOf(int width, int height) {
  Camera c;
  c.pixelFromRay << 800, 0, 319.5, 0, 800, 239.5, 0, 0, 1;
  c.width = width;
  c.height = height;
  return c;
}

Polyline circle(double x, double y, double r) { return {Ellipse{{x, y}, {r, r}, 0}.sample(720), true}; }

FrameEvidence observed(const std::vector<Polyline>& contours, bool cut = false) {
  FrameEvidence e;
  e.frame = 0;
  for (const Polyline& c : contours) {
    Highlight h;
    h.light = "lamp";
    h.contour = c;
    h.peak = centroid(c);
    h.touchesBorder = cut;
    e.highlights.push_back(h);
  }
  return e;
}

Prediction predicted(const std::vector<Polyline>& contours) {
  std::vector<PredictedHighlight> found;
  for (const Polyline& c : contours) {
    PredictedHighlight h;
    h.contour = c;
    h.brightest.pixel = centroid(c);
    found.push_back(h);
  }
  return found;
}

struct Counts {
  int matched = 0, missed = 0, spurious = 0;
};
Counts countsOf(const FrameComparison& c) {
  Counts n;
  for (const FrameComparison::Row& r : c.rows) {
    n.matched += r.observed >= 0 && r.predicted >= 0;
    n.missed += r.observed >= 0 && r.predicted < 0;
    n.spurious += r.observed < 0 && r.predicted >= 0;
  }
  return n;
}

TEST(CompareFrame, WhatHasNoPartnerIsCountedNotDropped) {
  const FrameComparison c = compareFrame(observed({circle(100, 100, 20), circle(300, 100, 20), circle(500, 100, 20)}), "lamp",
                                         imageOf(640, 480), predicted({circle(302, 100, 20), circle(100, 300, 20)}));
  const Counts n = countsOf(c);
  EXPECT_EQ(n.matched, 1);
  EXPECT_EQ(n.missed, 2);
  EXPECT_EQ(n.spurious, 1);
  // Union of three discs against two, of which two overlap: A common, 3 + 2 - A in all, A of two discs 2 px apart with radius 20.
  const double d = 2, r = 20, area = M_PI * r * r;
  const double lens = 2 * r * r * std::acos(d / (2 * r)) - 0.5 * d * std::sqrt(4 * r * r - d * d);
  EXPECT_NEAR(c.iou, lens / (5 * area - lens), 1e-3);
}

TEST(CompareFrame, ALightThatIsNotTheOneAskedForIsLeftAlone) {
  const FrameComparison c = compareFrame(observed({circle(100, 100, 20)}), "sun", imageOf(640, 480), Prediction{});
  EXPECT_TRUE(c.rows.empty());
}

TEST(CompareFrame, APredictionThatNobodyCouldSeeIsNotSpurious) {
  const FrameComparison c = compareFrame(observed({circle(100, 100, 20)}), "lamp", imageOf(640, 480),
                                         predicted({circle(100, 100, 20), circle(900, 100, 20)}));
  EXPECT_EQ(countsOf(c).spurious, 0);
  EXPECT_EQ(countsOf(c).matched, 1);
}

TEST(CompareFrame, APredictionIsCutWhereTheImageCutTheObservation) {
  // The observed half disc ends at the last column of pixel centres; the whole predicted disc agrees with it.
  Polyline half{{}, true};
  for (int i = 0; i <= 720; ++i) {
    const double t = M_PI / 2 + M_PI * i / 720;
    half.points.emplace_back(639 + 30 * std::cos(t), 200 + 30 * std::sin(t));
  }
  const FrameComparison c = compareFrame(observed({half}, true), "lamp", imageOf(640, 480), predicted({circle(639, 200, 30)}));
  ASSERT_EQ(c.rows.size(), 1u);
  ASSERT_TRUE(c.rows[0].metrics);
  EXPECT_LT(c.rows[0].metrics->contourErrorPx, 2e-3);  // chords of both polygons
  EXPECT_GT(c.rows[0].metrics->iou, 0.999);
}

/// The left half of a circle around the right edge of a 640 px wide image, open, as truth files have it.
Polyline openHalf(double radius, double y) {
  Polyline half{{}, false};
  for (int i = 0; i <= 2000; ++i) {
    const double t = M_PI / 2 + M_PI * i / 2000;
    half.points.emplace_back(639.5 + radius * std::cos(t), y + radius * std::sin(t));
  }
  return half;
}

/// Error of a prediction that is the same circle, moved to the left.
ContourMetrics movedCircle(double radius, double by, const Polyline& half) {
  const FrameComparison c =
      compareFrame(observed({half}, true), "lamp", imageOf(640, 2000), predicted({circle(639.5 - by, 1000, radius)}));
  EXPECT_EQ(c.rows.size(), 1u);
  return c.rows.empty() || !c.rows[0].metrics ? ContourMetrics{} : *c.rows[0].metrics;
}

TEST(CompareFrame, ACutContourIsComparedWhereItIsSeen) {
  // Moved by d, the arc is off by d |cos t|: 2 d / pi on average. The chord that closes it is no contour.
  EXPECT_NEAR(movedCircle(30, 0.5, openHalf(30, 1000)).contourErrorPx, 0.5 * 2 / M_PI, 0.01);
  EXPECT_LT(movedCircle(30, 0, openHalf(30, 1000)).contourErrorPx, 1e-3);
}

TEST(CompareFrame, TheErrorOfACutContourDoesNotDependOnItsSize) {
  EXPECT_NEAR(movedCircle(300, 5, openHalf(300, 1000)).contourErrorPct, movedCircle(60, 1, openHalf(60, 1000)).contourErrorPct,
              0.01);
}

TEST(CompareFrame, NoiseOfACutContourCountsAsNoise) {
  Polyline half = openHalf(100, 1000);
  std::mt19937 engine(3);
  std::normal_distribution<double> gauss(0, 0.2);
  for (Pixel& p : half.points) p += gauss(engine) * (p - Pixel(639.5, 1000)).normalized();
  const double mean = 0.2 * std::sqrt(2 / M_PI);  // of |gauss|; the way back finds nearer places
  const double error = movedCircle(100, 0, half).contourErrorPx;
  EXPECT_GT(error, 0.3 * mean);
  EXPECT_LT(error, 1.1 * mean);
}

TEST(CompareFrame, WhatFillsTheImageOrLiesOutsideHasNoError) {
  const Polyline frame{{{0, 0}, {639, 0}, {639, 479}, {0, 479}}, true};
  const FrameComparison full =
      compareFrame(observed({frame}, true), "lamp", imageOf(640, 480), predicted({circle(320, 240, 900)}));
  ASSERT_EQ(full.rows.size(), 1u);
  ASSERT_TRUE(full.rows[0].metrics);
  EXPECT_EQ(full.rows[0].metrics->contourErrorPx, 0);
  EXPECT_GT(full.iou, 0.999);
  EXPECT_TRUE(compareFrame(observed({circle(900, 100, 20)}, true), "lamp", imageOf(640, 480), Prediction{}).rows.empty());
  EXPECT_TRUE(compareFrame(observed({circle(900, 100, 20)}, true), "lamp", imageOf(640, 480), predicted({circle(903, 100, 20)}))
                  .rows.empty());
}

TEST(CompareFrame, AnUnreadableFrameKeepsItsReason) {
  FrameEvidence e;
  e.failure = Failure{Reason::FrameUnreadable, "a.png"};
  const FrameComparison c = compareFrame(e, "lamp", imageOf(640, 480), predicted({circle(100, 100, 20)}));
  ASSERT_EQ(c.rows.size(), 1u);
  ASSERT_TRUE(c.rows[0].failure);
  EXPECT_EQ(c.rows[0].failure->reason, Reason::FrameUnreadable);
}

}  // namespace
}  // namespace glint

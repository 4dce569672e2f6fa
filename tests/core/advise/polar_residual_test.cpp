// SPDX-License-Identifier: BSD-3-Clause
// Two circles have their residual in closed form; contours of one limit angle have that angle in every direction.
#include "core/advise/polar_residual.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/core/pipeline/exact_scene.h"
#include "tests/tolerances.h"

namespace glint {
namespace {
using namespace testing_support;

constexpr int kVertices = 2000;

Polyline circle(const Pixel& centre, double radius) {
  Polyline line;
  for (int i = 0; i < kVertices; ++i) {
    const double t = 2 * std::numbers::pi * i / kVertices;
    line.points.push_back(centre + radius * Pixel(std::cos(t), std::sin(t)));
  }
  return line;
}

/// Height of a circle of this radius over the edges of its polygon.
double sagitta(double radius) { return radius * (1 - std::cos(std::numbers::pi / kVertices)); }

Inspection twoContours(const Polyline& observed, const Polyline& predicted, double size = 1) {
  auto scene = std::make_shared<Scene>();
  scene->frames.resize(1);
  scene->frames[0].camera.width = scene->frames[0].camera.height = int(400 * size);
  Inspection inspection;
  inspection.scene = scene;
  Highlight h;
  h.light = "lamp";
  h.contour = observed;
  FrameEvidence evidence;
  evidence.frame = 0;
  evidence.highlights = {h};
  inspection.evidence = {evidence};
  FrameComparison c;
  c.frame = 0;
  c.light = "lamp";
  PredictedHighlight p;
  p.contour = predicted;
  c.prediction = std::vector{p};
  c.rows.push_back({0, 0, ContourMetrics{}, {}, {}});
  ModelResult& model = inspection.models["dual"];
  model.model = "dual";
  model.frames = {c};
  return inspection;
}

TEST(ContourPointAt, Square) {
  const Polyline square{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, true};
  EXPECT_NEAR((*contourPointAt(square, {5, 5}, 0) - Pixel(10, 5)).norm(), 0, tolerance::kExact);
  EXPECT_NEAR((*contourPointAt(square, {5, 5}, std::numbers::pi / 2) - Pixel(5, 10)).norm(), 0, tolerance::kExact);  // down
  EXPECT_NEAR((*contourPointAt(square, {5, 5}, std::numbers::pi) - Pixel(0, 5)).norm(), 0, tolerance::kExact);
  EXPECT_FALSE(contourPointAt(square, {20, 5}, 0));
  EXPECT_FALSE(contourPointAt(Polyline{}, {0, 0}, 0));
}

TEST(ContourPointAt, TakesTheFurthestOfSeveral) {  // a C that opens to the right, seen from its hollow
  const Polyline c{{{0, 0}, {10, 0}, {10, 2}, {2, 2}, {2, 8}, {10, 8}, {10, 10}, {0, 10}}, true};
  EXPECT_NEAR((*contourPointAt(c, {5, 5}, std::numbers::pi) - Pixel(0, 5)).norm(), 0, tolerance::kExact);
}

// Observed: radius R about the origin; predicted: radius R + g about (d, 0). The point at direction t lies R + g - |(R cos t - d,
// R sin t)| inside.
TEST(PolarResiduals, NominalCircles) {
  const double radius = 50, wider = 3, shift = 4;
  const std::vector<PolarResidual> all =
      polarResiduals(twoContours(circle({200, 200}, radius), circle({200 + shift, 200}, radius + wider)), 0, "dual", 72);
  ASSERT_EQ(all.size(), 1u);
  const PolarResidual& r = all[0];
  EXPECT_NEAR((r.centre - Pixel(200, 200)).norm(), 0, tolerance::kSolve);
  ASSERT_EQ(r.samples.size(), 72u);
  for (const DirectionSample& s : r.samples) {
    ASSERT_TRUE(s.value);
    const double expected = radius + wider - std::hypot(radius * std::cos(s.direction) - shift, radius * std::sin(s.direction));
    EXPECT_NEAR(*s.value, expected, 2 * sagitta(radius + wider)) << s.direction;
    EXPECT_NEAR(std::atan2(s.at.y() - 200, s.at.x() - 200),
                s.direction == std::numbers::pi ? std::atan2(s.at.y() - 200, s.at.x() - 200) : s.direction, 1e-9);
  }
  EXPECT_NEAR(r.samples.back().direction, std::numbers::pi, tolerance::kExact);
  EXPECT_NEAR(*r.samples.back().value, wider - shift,
              2 * sagitta(radius + wider));  // the prediction is shifted to the right: left of it lies inside
  EXPECT_NEAR(r.largestAbsPx, wider + shift, 2 * sagitta(radius + wider));
}

TEST(PolarResiduals, ScaleAndNoise) {
  const PolarResidual small = polarResiduals(twoContours(circle({200, 200}, 50), circle({201, 200}, 52)), 0, "dual")[0];
  const PolarResidual large = polarResiduals(twoContours(circle({2000, 2000}, 500), circle({2010, 2000}, 520), 10), 0, "dual")[0];
  for (std::size_t i = 0; i < small.samples.size(); ++i) EXPECT_NEAR(*large.samples[i].value, 10 * *small.samples[i].value, 1e-6);
  // A contour against itself, jittered by up to 0.1 px: no residual is larger than twice that.
  Polyline jittered = circle({200, 200}, 50);
  for (std::size_t i = 0; i < jittered.points.size(); ++i)
    jittered.points[i] += 0.1 * Pixel(std::sin(17.0 * double(i)), std::cos(23.0 * double(i)));
  EXPECT_LT(polarResiduals(twoContours(circle({200, 200}, 50), jittered), 0, "dual")[0].largestAbsPx, 0.2);
}

TEST(PolarResiduals, DegenerateGapsBordersAndMisses) {
  const Polyline square{{{150, 150}, {250, 150}, {250, 250}, {150, 250}}, true};
  Inspection inspection = twoContours(circle({200, 200}, 40), square);
  inspection.models["dual"].frames[0].prediction.editable()[0].gaps = {{1, 2}};  // the right side only bridges
  const PolarResidual r = polarResiduals(inspection, 0, "dual", 4)[0];
  EXPECT_TRUE(r.samples[0].value);   // up
  EXPECT_FALSE(r.samples[1].value);  // right
  EXPECT_TRUE(r.samples[2].value);   // down
  EXPECT_NEAR(*r.samples[2].value, 10, 1e-3);
  inspection.evidence[0].highlights[0].contour = circle({30, 200}, 30.0);
  inspection.evidence[0].highlights[0].touchesBorder = true;  // x = 0 on the left is where the image ends
  EXPECT_FALSE(polarResiduals(inspection, 0, "dual", 4)[0].samples[3].value);
  inspection.models["dual"].frames[0].rows = {{0, -1, {}, Failure{Reason::NotReached, ""}, {}}};
  EXPECT_TRUE(polarResiduals(inspection, 0, "dual").empty());
  EXPECT_TRUE(polarResiduals(inspection, 0, "primal").empty());
  EXPECT_TRUE(polarResiduals(inspection, 7, "dual").empty());
  EXPECT_THROW(polarResiduals(inspection, 0, "dual", 2), std::invalid_argument);
}

TEST(LimitAngles, AreTheOneTheContoursWereMadeWith) {
  InspectionRequest request;
  request.models = {"limit-angle"};
  request.train = "0-3";
  for (const AnalyticSpec& spec : {sheet(0), sphere(0.5)}) {
    const Inspection inspection = inspect(exactScene(spec, 6), request);
    const Outcome<std::shared_ptr<const Surface>> surface = surfaceOfFrame(inspection, 5, "lamp");
    ASSERT_TRUE(surface);
    const std::vector<AngleByDirection> all = limitAngles(inspection, 5, "limit-angle", **surface, 36);
    ASSERT_EQ(all.size(), 1u);
    ASSERT_TRUE(all[0].limitAngle);
    EXPECT_NEAR(*all[0].limitAngle, kLimitAngle, 1e-5);
    ASSERT_EQ(all[0].measured.size(), 36u);
    ASSERT_EQ(all[0].predicted.size(), 36u);
    for (int k = 0; k < 36; ++k) {
      ASSERT_TRUE(all[0].measured[std::size_t(k)].value && all[0].predicted[std::size_t(k)].value);
      EXPECT_NEAR(*all[0].measured[std::size_t(k)].value, kLimitAngle, 5e-5);   // contours are exact to 5e-3 px of about 15
      EXPECT_NEAR(*all[0].predicted[std::size_t(k)].value, kLimitAngle, 1e-4);  // predicted from 36 directions
    }
  }
}

TEST(LimitAngles, NeedALight) {
  Inspection inspection = twoContours(circle({200, 200}, 40), circle({200, 200}, 41));
  const Outcome<Light> light = lightOfModel(inspection, 0, "dual", "lamp");
  ASSERT_FALSE(light);
  EXPECT_EQ(light.failure().reason, Reason::NoLight);
  EXPECT_TRUE(limitAngles(inspection, 0, "dual", *makeAnalytic(sheet(0))).empty());
}

}  // namespace
}  // namespace glint

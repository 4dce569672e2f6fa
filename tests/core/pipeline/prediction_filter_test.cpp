// SPDX-License-Identifier: BSD-3-Clause
// What the filters take out: discs of known area, brightest points tilted by a known angle, and a ball in its own way.
#include <gmock/gmock.h>

#include <cmath>

#include "core/pipeline/live_prediction.h"
#include "core/pipeline/summary.h"
#include "core/surface/analytic.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint::prediction_filter_tests {

using namespace testing_support;
using testing::HasSubstr;

PredictedHighlight discAt(const Pixel& at, double area) {
  PredictedHighlight h;
  const double r = std::sqrt(area / M_PI);
  h.contour = {Ellipse{at, {r, r}, 0}.sample(2000), true};
  h.brightest.pixel = at;
  return h;
}

/// The camera and the lamp are straight above the origin; the normal there leans by alpha: the angle to the half vector.
PredictedHighlight leaning(double alpha) {
  PredictedHighlight h = discAt({319.5, 239.5}, 400);
  h.brightest.point.position = Eigen::Vector3d::Zero();
  h.brightest.point.normal = {std::sin(alpha), 0, std::cos(alpha)};
  return h;
}

Camera above() { return lookingAt({1e-9, 0, 2}, {0, 0, 0}); }

ModelFit limitAngleFit(double limit) {
  ModelFit fit;
  fit.lightEstimate = Light::at(Eigen::Vector3d(0, 0, 3));
  fit.family = LimitAngleFit{limit, std::nullopt};
  return fit;
}

TEST(FilteredPrediction, NothingByDefault) {
  Prediction p({discAt({100, 100}, 1), leaning(0.5)});
  filterPrediction(p, limitAngleFit(0.1), above(), nullptr, {});
  EXPECT_EQ(p.highlights().size(), 2u);
  EXPECT_TRUE(p.filtered.empty());
}

TEST(FilteredPrediction, TheAreaIsThatOfDetection) {
  Settings settings;
  settings.set("predict.filter_area", true);
  Prediction p({discAt({100, 100}, 11.9), discAt({200, 100}, 12.1), discAt({300, 100}, 500)});
  filterPrediction(p, {}, above(), nullptr, settings);
  EXPECT_EQ(p.highlights().size(), 2u);
  ASSERT_EQ(p.filtered.size(), 1u);
  EXPECT_NEAR(p.filtered[0].highlight.brightest.pixel.x(), 100, 1e-12);
  EXPECT_THAT(p.filtered[0].reason, HasSubstr("of 12 px^2"));
  settings.set("detect.min_area", 600.0);
  filterPrediction(p, {}, above(), nullptr, settings);
  ASSERT_TRUE(p.failure());
  EXPECT_EQ(p.failure()->reason, Reason::NoHighlight);
  EXPECT_EQ(p.filtered.size(), 3u) << "the first one stays filtered";
}

/// At the limit angle itself a lobe is at the level q; at half of it (in tangents) at q^(1/4).
TEST(FilteredPrediction, TheBrightnessFallsAsTheLevelSays) {
  const double limit = 0.1, half = std::atan(std::tan(limit) / 2);
  for (const double level : {0.5, 0.2}) {
    for (const double off : {-1e-6, 1e-6}) {
      Settings settings;
      settings.set("detect.level", level);
      settings.set("predict.filter_brightness", level + off);
      Prediction p({leaning(0), leaning(limit)});
      filterPrediction(p, limitAngleFit(limit), above(), nullptr, settings);
      EXPECT_EQ(p.filtered.size(), off > 0 ? 1u : 0u) << level;
      settings.set("predict.filter_brightness", std::pow(level, 0.25) + off);
      Prediction q({leaning(0), leaning(half)});
      filterPrediction(q, limitAngleFit(limit), above(), nullptr, settings);
      EXPECT_EQ(q.filtered.size(), off > 0 ? 1u : 0u) << level;
    }
  }
}

TEST(FilteredPrediction, TheBrightestStaysHoweverFaintItIs) {
  Settings settings;
  settings.set("predict.filter_brightness", 1.0);
  Prediction p({leaning(0.09)});
  filterPrediction(p, limitAngleFit(0.1), above(), nullptr, settings);
  EXPECT_EQ(p.highlights().size(), 1u);
}

TEST(FilteredPrediction, WithoutALightNothingIsFaintOrShadowed) {
  Settings settings;
  settings.set("predict.filter_brightness", 1.0);
  settings.set("predict.filter_shadow", true);
  Prediction p({leaning(0), leaning(0.3)});
  filterPrediction(p, {}, above(), makeAnalytic(sphere(0.5)).get(), settings);
  EXPECT_EQ(p.highlights().size(), 2u);
}

TEST(FilteredPrediction, TheBallIsInTheWayOfALampBelow) {
  Settings settings;
  settings.set("predict.filter_shadow", true);
  const auto ball = makeAnalytic(sphere(0.5));
  for (const double height : {-5.0, 5.0}) {
    ModelFit fit = limitAngleFit(0.1);
    fit.lightEstimate = Light::at(Eigen::Vector3d(0, 0, height));
    Prediction p({leaning(0)});
    filterPrediction(p, fit, above(), ball.get(), settings);
    EXPECT_EQ(p.filtered.size(), height < 0 ? 1u : 0u);
  }
}

/// In an inspection: what is filtered is neither spurious nor matched, and it is counted.
TEST(FilteredPrediction, IsCountedInTheSummary) {
  InspectionRequest request;
  request.models = {"limit-angle"};
  request.train = "0-5";
  request.settings.set("detect.min_area", 5000.0);  // contours that the scene gives stay
  const auto scene = exactScene(sphere(0.5), 9);
  const Inspection before = inspect(scene, request);
  request.settings.set("predict.filter_area", true);
  const Inspection after = inspect(scene, request, {}, &before);
  const ModelSummary was = summarise(before, before.models.at("limit-angle")),
                     is = summarise(after, after.models.at("limit-angle"));
  int small = 0;
  for (int f = 6; f < 9; ++f) small += scene->frames[std::size_t(f)].highlights[0].areaPx2 < 5000;
  EXPECT_EQ(was.filtered, 0);
  EXPECT_EQ(is.filtered, small);
  EXPECT_EQ(is.matched, 3 - small);
  EXPECT_EQ(is.missed, small);
  EXPECT_EQ(is.spurious, 0);
  EXPECT_GT(small, 0);
}

}  // namespace glint::prediction_filter_tests

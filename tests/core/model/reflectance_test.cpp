// SPDX-License-Identifier: BSD-3-Clause
// The reflectance model end to end on exact contours: fit, choice of the lobe, prediction of views that did not train.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/model/models.h"
#include "core/pipeline/metrics.h"
#include "tests/core/reflectance/radiance_views.h"

namespace glint {
namespace {

using namespace test;

/// Training contours have chords within 2e-3 px of the curve, on highlights 20 px wide and more: a few thousandths of a percent.
constexpr double kPredictedPct = 0.01;

/// A low camera over a bent sheet with the lamp opposite: up to 80 degrees of incidence, where the limit angle has no answer.
Synthetic grazingScene(int n) {
  Synthetic s;
  s.surface = sheet(0.5);
  s.light = trueLampAt({-0.2, 1.9, 0.55});
  for (int i = 0; i < n; ++i) {
    const double a = -1.85 + 0.6 * i / (n - 1);
    s.cameras.push_back(lookAt({1.9 * std::cos(a), 1.9 * std::sin(a), 0.5}, {0, 0, 0}));
  }
  return s;
}

Highlight observed(const RadianceScene& s, const Camera& camera) {
  ExactOptions options;
  options.level = s.level;
  const auto found = exactHighlights(*s.surface, camera, s.geometry.light, s.material, options);
  if (!found) throw std::runtime_error("exact highlight: " + found.failure().message());
  Highlight h = found->front();
  h.light = "lamp";
  h.fromScene = true;
  return h;
}

FitInput inputOf(const RadianceScene& s, int views) {
  FitInput input;
  for (int i = 0; i < views; ++i) {
    FrameEvidence evidence;
    evidence.frame = i;
    evidence.highlights = {observed(s, s.geometry.cameras[i])};
    input.views.push_back(trainingView(evidence, 0, s.geometry.cameras[i], s.surface));
  }
  if (const Outcome<LightEstimate> light = estimateLight(input.views, {}))
    input.light = *light;
  else
    input.lightFailure = light.failure();
  return input;
}

double reflectanceErrorPct(const RadianceScene& s, const ModelFit& fit, const Camera& camera) {
  const Prediction p = modelByName("reflectance").predict(fit, camera, s.surface.get(), {});
  if (p.highlights().size() != 1) return std::numeric_limits<double>::infinity();
  const Highlight truth = observed(s, camera);
  const PredictedHighlight& h = p.highlights().front();
  EXPECT_EQ(h.coverage, 1);
  return compareContours(truth.contour, h.contour, h.gaps, h.ellipse, truth.peak, h.brightest.pixel).contourErrorPct;
}

TEST(Reflectance, FindsTheLobeAndPredictsOtherViews) {
  for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx}) {
    const RadianceScene s = radianceScene(ellipsoidScene(8), lobe, 0.12);
    const Outcome<ModelFit> fit = modelByName("reflectance").fit(inputOf(s, 6), {});
    ASSERT_TRUE(fit) << fit.failure().message();
    EXPECT_EQ(fit->as<ReflectanceFit>()->lobe, lobe);
    EXPECT_NEAR(fit->as<ReflectanceFit>()->roughness, 0.12, 1e-4);
    for (int i = 6; i < 8; ++i)
      EXPECT_LT(reflectanceErrorPct(s, *fit, s.geometry.cameras[i]), kPredictedPct) << nameOf(lobe) << " " << i;
  }
}

// The light of the limit angle does not exist here: the peaks' rays must do as a start.
TEST(Reflectance, AnswersAtGrazingIncidenceWhereTheLimitAngleDoesNot) {
  const RadianceScene s = radianceScene(grazingScene(8), Lobe::TorranceSparrow, 0.2);
  FitInput input = inputOf(s, 6);
  input.light.reset();
  input.lightFailure = Failure{Reason::NotConverged, "light bundle"};
  const Outcome<ModelFit> fit = modelByName("reflectance").fit(input, {});
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_EQ(fit->as<ReflectanceFit>()->lobe, Lobe::TorranceSparrow);
  for (int i = 6; i < 8; ++i) EXPECT_LT(reflectanceErrorPct(s, *fit, s.geometry.cameras[i]), kPredictedPct) << i;
}

// A narrow Phong highlight at grazing incidence: from the first guess of the light no lobe converges, and the first lobe tried is
// the wrong one.
TEST(Reflectance, FindsANarrowPhongLobeAtGrazingIncidence) {
  const RadianceScene s = radianceScene(grazingScene(12), Lobe::Phong, 0.05);
  const Outcome<ModelFit> fit = modelByName("reflectance").fit(inputOf(s, 6), {});
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_EQ(fit->as<ReflectanceFit>()->lobe, Lobe::Phong);
  EXPECT_NEAR(fit->as<ReflectanceFit>()->roughness, 0.05, 1e-4);
  EXPECT_LT(reflectanceErrorPct(s, *fit, s.geometry.cameras[11]), kPredictedPct);
}

// The peak of a wide Beckmann lobe lies far from the mirror point: the first guess of the light is off, and a cosine power may
// converge where the right lobe does not. Highlights are 100 px wide and more, so the chords' share of them is a thousandth of a
// percent.
TEST(Reflectance, FindsWideBeckmannLobes) {
  constexpr double kWidePct = 1.5e-3;
  for (const bool round : {false, true})
    for (const double m : {0.4, 0.7})
      for (const double level : {0.5, 0.8}) {
        Synthetic geometry = ellipsoidScene(8);
        if (round) geometry.surface = sphere(0.3);
        RadianceScene s = radianceScene(std::move(geometry), Lobe::TorranceSparrow, m);
        s.level = level;
        const Outcome<ModelFit> fit = modelByName("reflectance").fit(inputOf(s, 6), {});
        ASSERT_TRUE(fit) << round << " " << m << " " << level << " " << fit.failure().message();
        EXPECT_EQ(fit->as<ReflectanceFit>()->lobe, Lobe::TorranceSparrow) << round << " " << m << " " << level;
        for (int i = 6; i < 8; ++i)
          EXPECT_LT(reflectanceErrorPct(s, *fit, s.geometry.cameras[i]), kWidePct) << round << " " << m << " " << level;
      }
}

// Contours at 0.3, 0.5 and 0.7 with independent noise of one pixel, the peak's once, tell a microfacet lobe from every other; the
// one at 0.5 alone leaves it open (method.md section 15).
TEST(Reflectance, SeveralLevelsNameTheLobe) {
  const auto noisy = [](const Polyline& contour, unsigned seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> gauss(0, 1);
    Polyline line{resample(contour, 72), true};
    for (Pixel& p : line.points) p += Pixel(gauss(engine), gauss(engine));
    return line;
  };
  Settings settings;
  settings.set("fit.evidence", std::string("levels"));
  int right = 0, rightFromOne = 0, runs = 0;
  for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      RadianceScene s = radianceScene(ellipsoidScene(6), lobe, 0.1);
      FitInput input = inputOf(s, 6);
      for (TrainingView& v : input.views)
        for (const double level : {0.3, 0.5, 0.7}) {
          s.level = level;
          const Polyline contour = noisy(observed(s, v.camera).contour, 100 * seed + 10 * v.frame + unsigned(10 * level));
          if (level == 0.5)
            v.highlight.contour = contour;
          else
            v.levels.push_back({level, contour});
        }
      const Outcome<ModelFit> fit = modelByName("reflectance").fit(input, settings),
                              one = modelByName("reflectance").fit(input, {});
      ASSERT_TRUE(fit && one);
      EXPECT_EQ(fit->as<ReflectanceFit>()->evidence, "levels");
      EXPECT_EQ(fit->as<ReflectanceFit>()->levels, std::vector<double>({0.3, 0.5, 0.7}));
      EXPECT_EQ(fit->residualPx.size(), 6u);
      EXPECT_EQ(one->as<ReflectanceFit>()->evidence, "contours");
      right += fit->as<ReflectanceFit>()->lobe == lobe;
      rightFromOne += one->as<ReflectanceFit>()->lobe == lobe;
      ++runs;
    }
  EXPECT_EQ(right, runs);
  EXPECT_LT(rightFromOne, runs);
}

// Nothing is given at another level: the fit says so.
TEST(Reflectance, LevelsThatAreNotThereAreRemarked) {
  const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, 0.1);
  Settings settings;
  settings.set("fit.evidence", std::string("levels"));
  const Outcome<ModelFit> fit = modelByName("reflectance").fit(inputOf(s, 6), settings);
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_EQ(fit->as<ReflectanceFit>()->evidence, "contours");
  EXPECT_EQ(fit->remarks.size(), 1u);
}

// The whole way: a lamp of 60 cm is found as one, predicts views that did not train, and has a band.
TEST(Reflectance, FindsALongLampAndPredictsOtherViews) {
  Synthetic geometry = ellipsoidScene(8);
  const Eigen::Vector3d middle = 2 * geometry.light.lamp.position().normalized(), half(0.18, 0.24, 0);
  geometry.light.lamp = segmentLamp(Eigen::Vector3d(middle - half), Eigen::Vector3d(middle + half));
  geometry.light.lamp = withRadius(geometry.light.lamp, 0.015);
  const RadianceScene s = radianceScene(std::move(geometry), Lobe::TorranceSparrow, 0.08);
  const Outcome<ModelFit> fit = modelByName("reflectance").fit(inputOf(s, 6), {});
  ASSERT_TRUE(fit) << fit.failure().message();
  const ReflectanceFit& lobe = *fit->as<ReflectanceFit>();
  ASSERT_TRUE(std::holds_alternative<SegmentShape<>>(lobe.shape));
  EXPECT_NEAR(2 * reachOf(lobe.shape), 0.6, 0.006);
  for (int i = 6; i < 8; ++i) {
    const Camera& camera = s.geometry.cameras[i];
    EXPECT_LT(reflectanceErrorPct(s, *fit, camera), 0.15) << i;
    const Prediction p = modelByName("reflectance").predict(*fit, camera, s.surface.get(), {});
    ASSERT_EQ(p.highlights().size(), 1u);
    for (const double sigma : modelByName("reflectance").bandSigmaPx(*fit, p.highlights()[0], camera, s.surface.get(), {}))
      EXPECT_TRUE(std::isfinite(sigma) && sigma < 1) << sigma;
  }
  Settings point;
  point.set("fit.light_size", std::string("point"));
  const Outcome<ModelFit> blind = modelByName("reflectance").fit(inputOf(s, 6), point);
  EXPECT_FALSE(blind && std::holds_alternative<SegmentShape<>>(blind->as<ReflectanceFit>()->shape));
}

ModelFit fitOf(const Light& light, Lobe lobe, double roughness) {
  ModelFit fit;
  fit.lightEstimate = light;
  fit.family = ReflectanceFit{lobe, roughness, 0.5};
  return fit;
}

// The largest radiance of the image is then at its border, or far down the lobe: no highlight is seen, and none is predicted.
TEST(Reflectance, HighlightsThatNobodySeesAreNamed) {
  struct Row {
    AnalyticSpec surface;
    Eigen::Vector3d light;
    Reason reason;
  };
  const Camera camera = lookAt({0, -1.5, 1.5}, {0, 0, 0});
  AnalyticSpec patch = sheet(0.0);
  patch.length = patch.width = 0.3;
  const Row rows[] = {{plane(), {3, 0, 1}, Reason::OutsideImage},   // mirror point 1.8 m to the right, the image ends at 0.9 m
                      {plane(), {12, 0, 1}, Reason::OutsideImage},  // further than anybody looks
                      {plane(), {0, 0.5, -2}, Reason::NoBrightestPoint},  // behind
                      {patch, {3, 0, 1}, Reason::NoBrightestPoint}};      // the mirror point is off the surface
  for (const Row& row : rows)
    for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong}) {
      const Prediction p = modelByName("reflectance")
                               .predict(fitOf(Light::at(row.light), lobe, 0.06), camera, makeAnalytic(row.surface).get(), {});
      ASSERT_TRUE(p.highlights().empty()) << nameOf(lobe) << " " << row.light.transpose();
      ASSERT_TRUE(p.failure());
      EXPECT_EQ(p.failure()->reason, row.reason) << nameOf(lobe) << " " << row.light.transpose();
    }
}

// The peak lies beyond the border, a part of the highlight inside: the level is that of the true peak.
TEST(Reflectance, HighlightsWithTheirPeakBeyondTheBorderKeepTheirShape) {
  RadianceScene s = radianceScene(Synthetic{plane(), {lookAt({0, -1.5, 1.5}, {0, 0, 0})}, trueLampAt({1.5, 0.9, 1.2}), 0.1, {}},
                                  Lobe::Ggx, 0.15);
  ExactOptions options;
  options.marginPx = 300;
  const auto truth = exactHighlights(*s.surface, s.geometry.cameras[0], s.geometry.light, s.material, options);
  ASSERT_TRUE(truth);
  ASSERT_GT(truth->front().peak.x(), 640);
  const Prediction p =
      modelByName("reflectance")
          .predict(fitOf(Light::at({1.5, 0.9, 1.2}), Lobe::Ggx, 0.15), s.geometry.cameras[0], s.surface.get(), {});
  ASSERT_EQ(p.highlights().size(), 1u) << p.failure()->message();
  const PredictedHighlight& h = p.highlights().front();
  EXPECT_LT(compareContours(truth->front().contour, h.contour, h.gaps, h.ellipse, truth->front().peak, h.brightest.pixel)
                .contourErrorPct,
            kPredictedPct);
}

TEST(Reflectance, NoLightAndNoViewAreNamed) {
  FitInput empty;
  const Outcome<ModelFit> none = modelByName("reflectance").fit(empty, {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.failure().reason, Reason::TooFewViews);
}

// Contours that no light and roughness explain: the views' contours exchanged.
TEST(Reflectance, ContoursThatNothingExplainsAreANamedFailure) {
  const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, 0.12);
  FitInput input = inputOf(s, 6);
  for (int i = 0; i < 3; ++i) {
    const Pixel shift = input.views[5 - i].highlight.peak - input.views[i].highlight.peak;
    for (Pixel& p : input.views[i].highlight.contour.points)
      p = input.views[i].highlight.peak + 0.3 * shift + 3 * (p - input.views[i].highlight.peak);
  }
  const Outcome<ModelFit> fit = modelByName("reflectance").fit(input, {});
  ASSERT_FALSE(fit);
  EXPECT_TRUE(fit.failure().reason == Reason::NotConverged || fit.failure().reason == Reason::PeakOffSurface)
      << fit.failure().message();
}

}  // namespace
}  // namespace glint

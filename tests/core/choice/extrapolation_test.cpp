// SPDX-License-Identifier: BSD-3-Clause
// What the automatic choice learns from views to predict and from the surface. Expected values are from closed forms: circles in
// the image, spheres seen from straight above.
#include "core/choice/extrapolation.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <random>

#include "core/base/solver_trace.h"
#include "core/choice/choice_ground.h"
#include "core/choice/surface_assumption.h"
#include "core/model/pixel_evidence.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {
using namespace testing_support;

Polyline circle(double radius, const Pixel& centre = {319.5, 239.5}, int points = 360) {
  Polyline line;
  for (int i = 0; i < points; ++i) {
    const double a = 2 * std::numbers::pi * i / points;
    line.points.push_back(centre + radius * Pixel(std::cos(a), std::sin(a)));
  }
  return line;
}

PredictedHighlight highlight(const Polyline& contour) {
  PredictedHighlight h;
  h.contour = contour;
  return h;
}

/// Straight above the origin; the image's up is world y.
Camera fromAbove(double height, double aside = 0) {
  Camera c = lookingAt({0, -1, 0}, {0, 0, 0});
  c.camFromWorld.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  c.camFromWorld.translation() = -(c.camFromWorld.linear() * Eigen::Vector3d(aside, 0, height));
  return c;
}

// A circle moved by d: the mean distance along it is (2 / pi) d.
TEST(DifferencePct, OfAMovedCircle) {
  const std::vector<PredictedHighlight> a{highlight(circle(50))}, b{highlight(circle(50, {320.5, 239.5}))};
  EXPECT_NEAR(differencePct(a, b), 2 / std::numbers::pi, 5e-3) << "of a diameter of 100 px; chords cost little";
  EXPECT_NEAR(differencePct(a, a), 0, 1e-9);
}

TEST(DifferencePct, WhatOnlyOneHasIsMissing) {
  const std::vector<PredictedHighlight> none, one{highlight(circle(50))},
      two{highlight(circle(50)), highlight(circle(20, {500, 100}))};
  EXPECT_EQ(differencePct(one, none), kNoPredictionPct);
  EXPECT_NEAR(differencePct(one, two), kNoPredictionPct / 2, 1e-9) << "one of two";
  EXPECT_TRUE(std::isnan(differencePct(none, none)));
  EXPECT_EQ(differencePct(one, {highlight(circle(50, {5000, 100}))}), kNoPredictionPct);
}

// The expectation is the definition itself: the distance of noisy contours from the circle that they were made from.
TEST(ContourNoise, IsTheDistanceFromTheTrueContour) {
  EXPECT_LT(contourNoisePct(circle(50)), 1e-9);
  Polyline ellipse = circle(50);
  for (Pixel& p : ellipse.points) p.x() = 319.5 + 0.4 * (p.x() - 319.5);
  EXPECT_LT(contourNoisePct(ellipse), 1e-9);
  ellipse.points = resample(ellipse, 72);
  EXPECT_LT(contourNoisePct(ellipse), 0.2) << "equal steps along an ellipse need more harmonics";
  std::mt19937 random(7);
  for (const double sigma : {0.1, 0.7, 2.0}) {
    std::normal_distribution<double> normal(0, sigma);
    double told = 0, truth = 0;
    for (int k = 0; k < 20; ++k) {
      Polyline noisy = circle(50, {319.5, 239.5}, 72);
      for (Pixel& p : noisy.points) p += Pixel(normal(random), normal(random));
      told += contourNoisePct(noisy) / 20;
      truth += differencePct({highlight(noisy)}, {highlight(circle(50))}) / 20;
    }
    EXPECT_LT(told, 1.02 * truth) << sigma << " px";  // too much noise taken off an error would hide the rest
    EXPECT_GT(told, 0.8 * truth) << sigma << " px";
  }
  EXPECT_EQ(contourNoisePct(circle(50, {0, 0}, 24)), 0) << "too few points tell nothing";
}

HighlightOnSurface seen(const AnalyticSpec& spec, const Camera& camera, double radiusPx) {
  return {camera, makeAnalytic(spec), circle(radiusPx)};
}

// Nominal: the ray at psi from the axis of a sphere of radius R whose top is at distance D meets it where the normal has turned
// by t, R sin t = (D + R - R cos t) tan psi.
TEST(SurfaceShape, Nominal) {
  EXPECT_LT(surfaceShape({seen(sheet(0), fromAbove(1.5), 40)}).bend, 1e-9);
  const double radius = 0.5, distance = 1.5, psi = std::atan(40.0 / 800);
  double t = psi;
  for (int i = 0; i < 100; ++i) t = std::asin((distance + radius - radius * std::cos(t)) * std::tan(psi) / radius);
  const SurfaceShape s = surfaceShape({seen(sphere(radius), fromAbove(distance), 40)});
  EXPECT_EQ(s.highlights, 1);
  EXPECT_NEAR(s.bend, t / (t + psi / 2), 0.01) << "the turn is taken linear over the highlight";
  EXPECT_GT(s.bend, kNoPlaneBend);
  EXPECT_NEAR(s.curvatureChange, 0, 1e-9) << "one highlight has one curvature";
}

TEST(SurfaceShape, ConstantCurvatureIsSeenAsSuch) {
  for (const AnalyticSpec& spec : {sphere(0.5), cylinder(0.4)}) {
    const SurfaceShape s = surfaceShape({seen(spec, fromAbove(1.5), 30), seen(spec, fromAbove(1.5, 0.1), 30)});
    EXPECT_LT(s.curvatureChange, 0.03) << spec.type;
    EXPECT_LT(s.curvatureChange, kNotConstantCurvature);
  }
  AnalyticSpec ellipsoid;
  ellipsoid.type = "ellipsoid";
  ellipsoid.semiAxes = {0.6, 0.3, 0.3};
  const SurfaceShape s = surfaceShape({seen(ellipsoid, fromAbove(1.5), 30), seen(ellipsoid, fromAbove(1.5, 0.5), 30)});
  EXPECT_GT(s.curvatureChange, kNotConstantCurvature) << "from 0.8 to several per metre along the long axis";
}

// Two flat steps are no plane: the mirrored light moves with them.
TEST(SurfaceShape, ParallelPlanesAreNotOne) {
  AnalyticSpec lower = sheet(0);
  lower.worldFromSurface.translation() = Eigen::Vector3d(0, 0, -0.1);
  EXPECT_GT(surfaceShape({seen(sheet(0), fromAbove(1.5), 40), seen(lower, fromAbove(1.5), 40)}).bend, kNoPlaneBend);
}

TEST(SurfaceShape, Scale) {
  const SurfaceShape one = surfaceShape({seen(sphere(0.5), fromAbove(1.5), 40)});
  for (const double scale : {1e-3, 1e3})
    EXPECT_NEAR(surfaceShape({seen(sphere(0.5 * scale), fromAbove(1.5 * scale), 40)}).bend, one.bend, 1e-9);
}

// Noise: a contour of a pixel more or less says the same about the surface.
TEST(SurfaceShape, Noise) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1);
  HighlightOnSurface flat = seen(sheet(0), fromAbove(1.5), 40), round = seen(sphere(0.5), fromAbove(1.5), 40);
  const double before = surfaceShape({round}).bend;
  for (HighlightOnSurface* h : {&flat, &round})
    for (Pixel& p : h->contour.points) p += Pixel(normal(random), normal(random));
  EXPECT_LT(surfaceShape({flat}).bend, 1e-9);
  EXPECT_NEAR(surfaceShape({round}).bend, before, 0.02);
}

TEST(SurfaceShape, Degenerate) {
  EXPECT_EQ(surfaceShape({}).highlights, 0);
  HighlightOnSurface away = seen(sphere(0.1), fromAbove(1.5), 40);
  away.contour = circle(40, {-3000, 0});
  EXPECT_EQ(surfaceShape({away}).highlights, 0) << "no ray meets the surface";
  EXPECT_EQ(surfaceShape({{fromAbove(1), nullptr, circle(10)}}).highlights, 0);
}

Inspection extrapolationEvidence(std::shared_ptr<const Scene> scene, const std::string& train) {
  InspectionRequest request;
  request.models.clear();
  request.train = train;
  return inspect(std::move(scene), request);
}

// Cameras on a circle: every other one lies as near to its neighbours as those that were left out; the other half of the circle
// does not.
TEST(ViewsToPredict, SayWhetherTheyLieAmongTheTrainingViews) {
  const auto scene = exactScene(sphere(0.5), 16);
  const Inspection among = extrapolationEvidence(scene, "0,2,4,6,8,10,12,14");
  const std::vector<ViewToPredict> between = viewsToPredict(among, foldsOf(among, LeaveOut::Place), 20);
  EXPECT_EQ(between.size(), 8u);
  for (const ViewToPredict& v : between) EXPECT_FALSE(v.outside) << v.frame << " at " << v.distanceDeg << " of " << v.testedDeg;
  const Inspection narrow = extrapolationEvidence(scene, "0-3");
  const std::vector<ViewToPredict> beyond = viewsToPredict(narrow, foldsOf(narrow, LeaveOut::Place), 20);
  EXPECT_EQ(beyond.size(), 12u);
  int outside = 0;
  for (const ViewToPredict& v : beyond) outside += v.outside;
  EXPECT_GE(outside, 8);
  EXPECT_FALSE(beyond.front().outside) << "one step further, as was tested";
  EXPECT_EQ(viewsToPredict(narrow, foldsOf(narrow, LeaveOut::Place), 5).size(), 5u);
}

// A second photograph from the place of the first one, its contour started elsewhere: as evidence it is another view.
TEST(FoldsOf, AViewFromTheSamePlaceIsLeftOutWithIt) {
  const auto scene = exactScene(sphere(0.5), 6);
  Frame again = scene->frames[2];
  again.id += " again";
  for (Highlight& h : again.highlights)
    std::rotate(h.contour.points.begin(), h.contour.points.begin() + 5, h.contour.points.end());
  scene->frames.push_back(again);
  const Inspection inspection = extrapolationEvidence(scene, "0-6");
  ASSERT_EQ(inspection.views.size(), 7u);
  for (const Fold& f : foldsOf(inspection, LeaveOut::Place))
    EXPECT_EQ(f.others.size(), f.left.frame == 2 || f.left.frame == 6 ? 5u : 6u);
  for (const Fold& f : foldsOf(inspection, LeaveOut::Frame)) EXPECT_EQ(f.others.size(), 6u);
}

int fitsToPixels(const SolverTrace& trace) {
  return static_cast<int>(std::count_if(trace.runs().begin(), trace.runs().end(),
                                        [](const SolverRun& run) { return run.what.find("from pixels") != std::string::npos; }));
}

// What a search that refuses poor fits has fitted serves one that takes them.
TEST(FitFold, APoorFitIsMadeOnce) {
  Inspection inspection = extrapolationEvidence(exactScene(cylinder(0.4), 6), "0-5");
  inspection.request.settings.set("fit.most_residual", 0.01);
  std::vector<Fold> folds = foldsOf(inspection, LeaveOut::Place);
  const auto fit = [&](PoorFits poor) { return fitFold(folds[0], modelByName("primal"), inspection.request.settings, poor); };
  const SolverTrace first;
  EXPECT_FALSE(fit(PoorFits::Refuse));
  EXPECT_GE(first.runs().size(), 1u);
  const SolverTrace again;
  const Outcome<ModelFit> poor = fit(PoorFits::Take);
  ASSERT_TRUE(poor) << poor.failure().message();
  EXPECT_NE(poor->poor, "");
  EXPECT_TRUE(again.runs().empty());
}

std::shared_ptr<const Scene> cyclesIfAny(const char* name) {
  const std::filesystem::path file = std::filesystem::path(GLINT_SHARED_DIR) / "data" / "cycles" / name / "scene.json";
  return std::filesystem::exists(file) ? std::make_shared<const Scene>(readScene(file.string())) : nullptr;
}

// The lamp is that of the path tracer. A search from anew tries four lobes over several backgrounds.
TEST(FitFold, PixelsWithAViewLeftOutStartFromTheFitOfAllViews) {
  const auto scene = cyclesIfAny("sphere");
  if (!scene) GTEST_SKIP() << "no shared/data/cycles/sphere beside the project";
  const Inspection inspection = extrapolationEvidence(scene, "spread:4");
  std::vector<Fold> folds = foldsOf(inspection, LeaveOut::Place);
  ASSERT_EQ(folds.size(), 4u);
  const SolverTrace trace;
  const Outcome<ModelFit> fit = fitFold(folds[0], radianceModel(), inspection.request.settings);
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_EQ(fit->solver, "pixels");
  EXPECT_LT((fit->lightEstimate->position() - Eigen::Vector3d(1.1, -1.2, 1.5)).norm(), 0.02);
  EXPECT_EQ(fitsToPixels(trace), 1) << "on all cells";
}

// Once the light of all views is known and corrects no surface, that fit needs no light either.
TEST(FitFold, PixelsWithAViewLeftOutNeedNoLight) {
  const auto scene = cyclesIfAny("sphere");
  if (!scene) GTEST_SKIP() << "no shared/data/cycles/sphere beside the project";
  ChoiceGround ground(extrapolationEvidence(scene, "spread:4"), 4);
  ground.findLights({});
  const Outcome<ModelFit> fit = fitFold(ground.folds.at(0), radianceModel(), ground.inspection.request.settings);
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_FALSE(ground.folds[0].light) << "it was estimated";
  EXPECT_LT((fit->lightEstimate->position() - Eigen::Vector3d(1.1, -1.2, 1.5)).norm(), 0.02) << "the path tracer's lamp";
}

// Where no lobe explains the pixels of all views, those of fewer views are not asked again.
TEST(FitFold, PixelsThatNoLobeExplainsAreNotFittedAgainForFewerViews) {
  const auto given = cyclesIfAny("sphere");
  if (!given) GTEST_SKIP() << "no shared/data/cycles/sphere beside the project";
  Inspection inspection = extrapolationEvidence(given, "spread:4");
  ASSERT_EQ(inspection.pixelFits.size(), 1u);
  const FitKey key = inspection.pixelFits.begin()->first;
  const Failure failure{Reason::NotConverged, "no lobe"};
  inspection.pixelFits.insert_or_assign(key, failure);
  inspection.unexplained.insert_or_assign(key, std::make_shared<const UnexplainedPixels>(UnexplainedPixels{
                                                   inspection.views, {}, inspection.request.settings, failure}));
  std::vector<Fold> folds = foldsOf(inspection, LeaveOut::Place);
  const SolverTrace trace;
  const Outcome<ModelFit> fit = fitFold(folds[0], radianceModel(), inspection.request.settings);
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_EQ(fit->solver, "contours");
  EXPECT_EQ(fitsToPixels(trace), 0);
}

}  // namespace
}  // namespace glint

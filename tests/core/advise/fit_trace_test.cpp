// SPDX-License-Identifier: BSD-3-Clause
// Exact contours of a known lamp: where a fit starts, where it ends, and what is left are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/advise/diagnosis.h"
#include "core/report/report.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint::fit_trace_tests {

using namespace testing_support;

const Eigen::Vector3d kLamp(0.1, 0.2, 1.4);  // of exactScene()
constexpr double kOnLamp = 1e-4;             // of the distance: contours to 5e-3 px
constexpr int kPointsPerView = 72, kViews = 6;

std::shared_ptr<Scene> noisyScene(double sigmaPx) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, sigmaPx);
  for (Frame& f : scene->frames)
    for (Pixel& p : f.highlights[0].contour.points) p += Pixel(noise(random), noise(random));
  return scene;
}

std::vector<FitTrace> traced(std::shared_ptr<const Scene> scene, const std::string& model) {
  InspectionRequest request;
  request.models = {model};
  request.train = "0-5";
  return traceFits(inspect(std::move(scene), request), modelByName(model));
}

const SolverRun* answerOf(const FitTrace& fit, const std::string& what) {
  const auto it =
      std::find_if(fit.runs.begin(), fit.runs.end(), [&](const SolverRun& r) { return r.answer && r.what.rfind(what, 0) == 0; });
  return it == fit.runs.end() ? nullptr : &*it;
}

/// With one light, all questions but the first come from within its fit.
TEST(FitTrace, AStopIsAcknowledgedWithinAFit) {
  InspectionRequest request;
  request.models = {"limit-angle"};
  request.train = "0-5";
  const Inspection inspection = inspect(noisyScene(0.1), request);
  const HighlightModel& model = modelByName("reflectance");  // has no fit yet
  const auto fit = [&](bool again, const ProgressFn& progress) {
    if (again)
      traceFits(inspection, model, progress);
    else
      highlightEvidence(inspection, model, progress);
  };
  for (const bool again : {true, false}) {
    int all = 0, asked = 0;
    fit(again, [&](const StageEvent&) { return ++all > 0; });
    ASSERT_GT(all, 10) << again;
    EXPECT_THROW(fit(again, [&](const StageEvent&) { return ++asked < all / 2; }), Stopped) << again;
    EXPECT_EQ(asked, all / 2) << "no question after the stop";
  }
}

TEST(FitTrace, ExactContoursEndAtTheLamp) {
  const std::vector<FitTrace> fits = traced(exactScene(sphere(0.5), 9), "limit-angle");
  ASSERT_EQ(fits.size(), 1U);
  EXPECT_EQ(fits[0].key.light, "lamp");
  EXPECT_FALSE(fits[0].failure);
  const SolverRun* const run = answerOf(fits[0], "light with one limit angle");
  ASSERT_TRUE(run && run->end && run->start);
  EXPECT_TRUE(run->converged);
  EXPECT_EQ(run->unit, "px^2");
  EXPECT_LT((run->end->hnormalized() - kLamp).norm(), kOnLamp * kLamp.norm());
  for (const std::vector<double>& round : run->rounds) {
    ASSERT_FALSE(round.empty());
    EXPECT_TRUE(std::is_sorted(round.rbegin(), round.rend())) << "a step that is taken never raises the cost";
  }
  // Contours to 5e-3 px, squared, of six views.
  EXPECT_LT(run->rounds.back().back(), kViews * kPointsPerView * 2.5e-5);
  EXPECT_FALSE(textOf(fits[0]).empty());
}

TEST(FitTrace, SaysHowFarTheLightMovedOrTurned) {
  const auto text = [](const Eigen::Vector4d& from, const Eigen::Vector4d& to) {
    SolverRun run;
    run.what = "light";
    run.unit = "px^2";
    run.rounds = {{812, 40, 0.31}};
    run.ending = "converged";
    run.start = from.normalized();
    run.end = to.normalized();
    return textOf(FitTrace{{"lamp", std::nullopt}, {run}, std::nullopt}).at(0);
  };
  EXPECT_EQ(text({1, 0, 0, 1}, {1, 3, 4, 1}), "light: cost 812 -> 0.31 px^2, 2 steps in all, moved 5 m; converged");
  EXPECT_EQ(text({1, 0, 0, 0}, {1, 1, 0, 0}), "light: cost 812 -> 0.31 px^2, 2 steps in all, turned by 45 deg; converged");
  EXPECT_EQ(text({1, 0, 0, 1}, {1, 1, 0, 0}), "light: cost 812 -> 0.31 px^2, 2 steps in all, ended at infinity; converged");
}

TEST(FitTrace, AnEllipsoidIsFittedAfterItsLight) {
  const std::vector<FitTrace> fits = traced(exactScene(sphere(0.5), 9), "canonical");
  ASSERT_EQ(fits.size(), 1U);
  const SolverRun* const light = answerOf(fits[0], "light with one limit angle");
  const SolverRun* const ellipsoid = answerOf(fits[0], "ellipsoid");
  ASSERT_TRUE(light && ellipsoid);
  EXPECT_LT(light, ellipsoid) << "in the order of the work";
  ASSERT_TRUE(ellipsoid->start && ellipsoid->end);
}

TEST(FitTrace, TheWorldsSizeScalesPlacesAndKeepsCosts) {
  const auto scaled = [](double s) {
    const std::shared_ptr<Scene> scene = noisyScene(0.2);
    for (Frame& f : scene->frames) f.camera.camFromWorld.translation() *= s;
    AnalyticSpec& ball = *scene->surfaces.at("body").analytic();
    ball.radius *= s;
    ball.worldFromSurface.translation() *= s;
    return traced(scene, "limit-angle").at(0);
  };
  const FitTrace one = scaled(1), large = scaled(1000);
  const SolverRun *const a = answerOf(one, "light"), *const b = answerOf(large, "light");
  ASSERT_TRUE(a && b && a->end && b->end);
  EXPECT_LT((b->end->hnormalized() / 1000 - a->end->hnormalized()).norm(), 1e-6);
  EXPECT_NEAR(b->rounds.back().back(), a->rounds.back().back(), 1e-6 * a->rounds.back().back());
}

TEST(FitTrace, WhatIsLeftIsTheNoise) {
  constexpr double kSigma = 0.2;
  const FitTrace fit = traced(noisyScene(kSigma), "limit-angle").at(0);
  const SolverRun* const run = answerOf(fit, "light with one limit angle");
  ASSERT_TRUE(run);
  // Across the contour, of 432 points resampled from noisy ones: between half of the noise (neighbours are averaged) and all of
  // it.
  const double noise = kViews * kPointsPerView * kSigma * kSigma;
  EXPECT_GT(run->rounds.back().back(), 0.25 * noise);
  EXPECT_LT(run->rounds.back().back(), 1.5 * noise);
}

/// Contours of two lamps as if of one: the fit ends far from a solution, and the diagnosis shows how it went.
TEST(FitTrace, AFitThatFailsShowsItsStartsAndEnds) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  for (std::size_t f = 1; f < scene->frames.size(); f += 2)
    scene->frames[f].highlights =
        exactContours(sphere(0.5), scene->frames[f].camera, {"lamp", {-0.4, -0.3, 0.9}}, 0.5 * kLimitAngle);
  InspectionRequest request;
  request.models = {"limit-angle"};
  request.train = "0-5";
  const Inspection inspection = inspect(scene, request);
  const Diagnosis diagnosis = diagnose(inspection);
  const ModelDiagnosis& d = diagnosis.models.at(0);
  ASSERT_NE(d.status, "ok");
  ASSERT_EQ(d.fits.size(), 1U);
  ASSERT_FALSE(d.fits[0].runs.empty());
  for (const SolverRun& run : d.fits[0].runs) {
    EXPECT_TRUE(run.start && run.end) << run.what;
    EXPECT_FALSE(run.ending.empty());
  }
  const std::vector<std::string> lines = textOf(d.fits[0]);
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](auto& l) { return l.rfind("light with one limit angle: ", 0) == 0; }));
  EXPECT_NE(diagnosisJson(inspection, diagnosis, "scene.json").find("\"taken\""), std::string::npos);
}

TEST(FitTrace, WithoutAViewThereIsNothingToShow) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  for (Frame& f : scene->frames) f.highlights[0].peak = Pixel(-4000, -4000);  // beside the ball
  EXPECT_TRUE(traced(scene, "limit-angle").empty());
}

}  // namespace glint::fit_trace_tests

// SPDX-License-Identifier: BSD-3-Clause
// Faults are put into exact contours: the diagnosis must name them, and the remedy that takes them out must be the best one.
#include "core/diagnose/diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/base/angle.h"
#include "core/diagnose/candidates.h"
#include "core/report/diagnosis_report.h"
#include "core/selection/selection.h"
#include "tests/core/inspect/exact_scene.h"

namespace glint::diagnosis_tests {

using namespace testing_support;

constexpr double kExactPct = 0.1;   // % of the diameter: exact contours, at most 0.05 % in the tests of the influence of frames
constexpr double kAngleDeg = 0.15;  // of a limit angle: the light that is fitted to odd contours stands a little off its lamp

Inspection inspected(std::shared_ptr<const Scene> scene, std::vector<std::string> models = {"limit-angle"}) {
  InspectionRequest request;
  request.models = std::move(models);
  request.train = "0-5";
  return inspect(std::move(scene), request);
}

/// The highlight of one frame lies 12 px beside its place, which is a tenth of its size.
std::shared_ptr<Scene> withMovedContour(int frame) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  Highlight& h = scene->frames[std::size_t(frame)].highlights[0];
  for (Pixel& p : h.contour.points) p.x() += 12;
  h.peak.x() += 12;
  return scene;
}

TEST(Diagnosis, ExactContoursAreOkAndNothingIsAdvised) {
  const Inspection inspection = inspected(exactScene(sphere(0.5), 9), {"limit-angle", "canonical"});
  const Diagnosis diagnosis = diagnose(inspection);
  ASSERT_EQ(diagnosis.models.size(), 2U);
  for (const ModelDiagnosis& d : diagnosis.models) {
    SCOPED_TRACE(d.model);
    EXPECT_EQ(d.status, ModelDiagnosis::Status::Ok);
    EXPECT_TRUE(d.causes.empty());
    EXPECT_TRUE(d.remedies.empty());
    EXPECT_EQ(d.unseen.views.size(), 9U) << "six left-out training views and three other frames";
    for (const HighlightEvidence& e : d.evidence) EXPECT_TRUE(e.against.empty()) << e.against.front();
  }
  for (const HighlightEvidence& e : diagnosis.models[0].evidence) {
    ASSERT_TRUE(e.limitAngle && e.residualPx);
    EXPECT_NEAR(*e.limitAngle, kLimitAngle, 1e-4);
    EXPECT_LT(*e.residualPx, 0.05);
  }
}

TEST(Diagnosis, AMovedContourIsNamedAndItsExclusionIsTheBestRemedy) {
  const Inspection inspection = inspected(withMovedContour(2));
  std::vector<Remedy> asFound;
  DiagnoseOptions options;
  options.found = [&](const std::string& model, const Remedy& r) {
    EXPECT_EQ(model, "limit-angle");
    asFound.push_back(r);
  };
  const ModelDiagnosis d = diagnose(inspection, options).models.at(0);
  EXPECT_EQ(d.status, ModelDiagnosis::Status::Poor);
  ASSERT_FALSE(d.causes.empty());
  const auto worst =
      std::max_element(d.evidence.begin(), d.evidence.end(), [](const auto& a, const auto& b) { return a.weight < b.weight; });
  EXPECT_EQ(worst->frame, 2);
  EXPECT_GE(worst->weight, 1);
  ASSERT_FALSE(d.remedies.empty());
  const Remedy& best = d.remedies.front();
  EXPECT_EQ(best.change.exclude, "v2");
  EXPECT_LT(best.after.meanPct(), kExactPct) << "what is left is exact";
  EXPECT_GT(best.before.meanPct(), best.after.meanPct());
  for (const LeftOutError::View& v : best.after.views) EXPECT_NE(v.frame, 2) << "a comparison over the views of both";
  EXPECT_EQ(best.before.views.size(), best.after.views.size());
  EXPECT_EQ(asFound.size(), d.remedies.size());
  // What it promises is what the request then gives.
  const Inspection after = inspect(inspection.given, with(inspection.request, best.change, *inspection.scene));
  for (const HighlightEvidence& e : highlightEvidence(after, modelByName("limit-angle"))) EXPECT_LT(*e.residualPx, 0.05);
}

TEST(Diagnosis, TwoLimitAnglesCannotBeOne) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  const double wide = radians(6.3), narrow = radians(3.5);
  for (std::size_t f = 0; f < scene->frames.size(); ++f)
    scene->frames[f].highlights =
        exactContours(sphere(0.5), scene->frames[f].camera, {"lamp", {0.1, 0.2, 1.4}}, f % 2 == 0 ? wide : narrow);
  const Inspection inspection = inspected(scene);
  const ModelDiagnosis d = diagnose(inspection).models.at(0);
  EXPECT_NE(d.status, ModelDiagnosis::Status::Ok);
  const LimitConflict conflict = limitConflict(d.evidence);
  ASSERT_TRUE(conflict.wide && conflict.narrow) << diagnosisText(inspection, {{d}});
  EXPECT_NEAR(degrees(*conflict.wide->limitAngle), 6.3, kAngleDeg);
  EXPECT_NEAR(degrees(*conflict.narrow->limitAngle), 3.5, kAngleDeg);
  EXPECT_TRUE(std::any_of(d.causes.begin(), d.causes.end(),
                          [](const std::string& c) { return c.find("one limit angle cannot fit both") != std::string::npos; }));
  for (const Remedy& r : d.remedies)
    EXPECT_NE(r.change.set.value_or("").rfind("fit.most_residual", 0), 0U) << "hides the failure";
}

TEST(Diagnosis, TheWorldsSizeChangesNothing) {
  const auto scaled = [](double s) {
    const std::shared_ptr<Scene> scene = withMovedContour(2);
    for (Frame& f : scene->frames) f.camera.camFromWorld.translation() *= s;
    AnalyticSpec& ball = *scene->surfaces.at("body").analytic;
    ball.radius *= s;
    ball.worldFromSurface.translation() *= s;
    return diagnose(inspected(scene)).models.at(0);
  };
  const ModelDiagnosis a = scaled(1), b = scaled(1000);
  ASSERT_EQ(a.remedies.size(), b.remedies.size());
  EXPECT_EQ(b.remedies.front().change.exclude, "v2");
  for (std::size_t i = 0; i < a.remedies.size(); ++i) {
    EXPECT_EQ(a.remedies[i].change, b.remedies[i].change);
    EXPECT_NEAR(a.remedies[i].after.meanPct(), b.remedies[i].after.meanPct(), 1e-3 * a.remedies[i].after.meanPct() + 1e-3);
  }
}

TEST(Diagnosis, NoiseAloneIsNoFault) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.2);  // px: twice what detection leaves on 8-bit frames
  for (Frame& f : scene->frames)
    for (Pixel& p : f.highlights[0].contour.points) p += Pixel(noise(random), noise(random));
  const ModelDiagnosis d = diagnose(inspected(scene)).models.at(0);
  EXPECT_EQ(d.status, ModelDiagnosis::Status::Ok) << (d.causes.empty() ? "" : d.causes.front());
  for (const HighlightEvidence& e : d.evidence) EXPECT_LT(e.weight, 1);
}

TEST(Diagnosis, WithoutAUsableViewItSaysSo) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  for (Frame& f : scene->frames) f.highlights[0].peak = Pixel(-4000, -4000);  // beside the ball
  const Inspection inspection = inspected(scene, {"limit-angle", "dual"});
  for (const ModelDiagnosis& d : diagnose(inspection).models) {
    SCOPED_TRACE(d.model);
    EXPECT_EQ(d.status, ModelDiagnosis::Status::Failed);
    ASSERT_FALSE(d.causes.empty());
    ASSERT_EQ(d.evidence.size(), 6U);
    for (const HighlightEvidence& e : d.evidence) {
      ASSERT_FALSE(e.against.empty());
      EXPECT_EQ(e.against.front().rfind("cannot be used: ", 0), 0U);
    }
  }
  EXPECT_NE(diagnosisText(inspection, diagnose(inspection)).find("failed"), std::string::npos);
}

/// Somebody waits: what costs next to nothing comes first for every model, and what costs fits first for the model that is nearest to being
/// good. The answer is in the order of the request all the same.
TEST(Diagnosis, WhatIsQuickComesFirstThenTheNearestModel) {
  std::vector<std::pair<std::string, bool>> found;  // model; the remedy is another model, or frames left out of the score
  DiagnoseOptions options;
  options.mostTried = 4;
  options.found = [&](const std::string& model, const Remedy& r) { found.emplace_back(model, r.change.model || !r.measured); };
  const Diagnosis all = diagnose(inspected(withMovedContour(2), {"primal", "limit-angle"}), options);
  ASSERT_EQ(all.models.size(), 2U);
  EXPECT_EQ(all.models[0].model, "primal");
  EXPECT_EQ(all.models[1].model, "limit-angle");
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front(), std::pair(std::string("primal"), true));
  const auto slow = std::find_if(found.begin(), found.end(), [](const auto& f) { return !f.second; });
  ASSERT_NE(slow, found.end());
  EXPECT_EQ(slow->first, "limit-angle");
  std::size_t remedies = 0;
  for (const ModelDiagnosis& d : all.models) remedies += d.remedies.size();
  EXPECT_EQ(found.size(), remedies);
}

/// A held-out frame that shows something else: leaving it out makes the score better by definition, so that it must not stand before what was
/// measured, and says what it is.
TEST(Diagnosis, LeavingAFrameOutOfTheScoreIsNoMeasuredRemedy) {
  const ModelDiagnosis d = diagnose(inspected(withMovedContour(7))).models.at(0);
  EXPECT_EQ(d.status, ModelDiagnosis::Status::Poor);
  const auto left = std::find_if(d.remedies.begin(), d.remedies.end(), [](const Remedy& r) { return r.change.exclude == "v7"; });
  ASSERT_NE(left, d.remedies.end());
  EXPECT_FALSE(left->measured);
  EXPECT_EQ(left + 1, d.remedies.end()) << "the last one";
  EXPECT_NE(left->why.find("right only if"), std::string::npos);
  EXPECT_LT(left->after.meanPct(), kExactPct) << "all others are exact";
}

/// Three other models help `dual` on a ball, one of them less. A held-out frame shows something else: the mean without it is smaller than that of
/// any better model, by definition.
TEST(Diagnosis, RemediesStandByWhatTheyLeaveAndWhatIsNotMeasuredLast) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.25), 9);
  for (Pixel& p : scene->frames[7].highlights[0].contour.points) p.x() += 25;
  DiagnoseOptions options;
  options.mostTried = 0;  // other models, and what is left out of the score
  const std::vector<Remedy> remedies = diagnose(inspected(scene, {"dual"}), options).models.at(0).remedies;
  ASSERT_GE(remedies.size(), 3U);
  const auto left = remedies.end() - 1;
  const auto leavesLess = [](const Remedy& a, const Remedy& b) { return a.after.meanPct() < b.after.meanPct(); };
  EXPECT_TRUE(std::is_sorted(remedies.begin(), left, leavesLess));
  EXPECT_LT(remedies.front().after.meanPct(), (left - 1)->after.meanPct() - 0.1) << "% of the diameter: not all alike";
  EXPECT_TRUE(std::all_of(remedies.begin(), left, [](const Remedy& r) { return r.measured; }));
  EXPECT_FALSE(left->measured);
  EXPECT_LT(left->after.meanPct(), remedies.front().after.meanPct());
}

LeftOutError errorsOf(const std::vector<double>& pct) {
  LeftOutError error;
  for (std::size_t i = 0; i < pct.size(); ++i) error.views.push_back({int(i), "lamp", true, pct[i], 20, pct[i] < 100});
  return error;
}

/// Standard errors by hand: gains of 3, -2, 3, -2 have the mean 0.5 and the standard error 1.44.
TEST(IsBetter, OnlyBeyondChance) {
  EXPECT_FALSE(isBetter(errorsOf({1, 6, 1, 6}), errorsOf({4, 4, 4, 4})));
  EXPECT_TRUE(isBetter(errorsOf({3, 3.5, 3, 3.5}), errorsOf({4, 4, 4, 4})));
  EXPECT_FALSE(isBetter(errorsOf({3.7, 3.7, 3.7, 3.7}), errorsOf({4, 4, 4, 4}))) << "less than a tenth";
  EXPECT_FALSE(isBetter(errorsOf({4, 4}), errorsOf({3, 3})));
  // One that went astray and does so no more: its gain of 96 is as large as its standard error.
  EXPECT_TRUE(isBetter(errorsOf({4.1, 4, 4, 4}), errorsOf({100, 4, 4, 3.9})));
  EXPECT_FALSE(isBetter(errorsOf({4, 4, 4, 5.1}), errorsOf({100, 4, 4, 4}))) << "another one goes astray";
}

TEST(Diagnosis, StopsWhenAsked) {
  const Inspection inspection = inspected(withMovedContour(2));
  EXPECT_THROW(diagnose(inspection, {}, [](const StageEvent&) { return false; }), Stopped);
}

TEST(Diagnosis, ItsBoundIsKept) {
  DiagnoseOptions options;
  options.mostTried = 1;
  const ModelDiagnosis d = diagnose(inspected(withMovedContour(2)), options).models.at(0);
  const int models = static_cast<int>(modelIds().size()) - 1;
  EXPECT_LE(d.tried, models + 2) << "the other models, one change, and what is left out of the score";
  EXPECT_GT(d.known, d.tried);
}

TEST(Changes, AreWhatTheFlagsTake) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  InspectionRequest request;
  request.excluded = {1};
  Change change;
  change.set = "light.solver=triangulated";
  change.exclude = "1,3";
  EXPECT_EQ(flagsOf(change), "--set light.solver=triangulated --exclude 1,3");
  const InspectionRequest changed = with(request, change, *scene);
  EXPECT_EQ(changed.settings.text("light.solver"), "triangulated");
  EXPECT_EQ(changed.excluded, (std::vector<int>{1, 3}));
  change.exclude = "17";
  EXPECT_ANY_THROW(with(request, change, *scene));
}

}  // namespace glint::diagnosis_tests

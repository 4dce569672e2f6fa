// SPDX-License-Identifier: BSD-3-Clause
// Faults are put into exact contours: the diagnosis must name them, and lead to what predicts the held-out frames best.
#include "core/advise/diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "core/base/numeric.h"
#include "core/choice/leave_one_out.h"
#include "core/choice/selection.h"
#include "core/pipeline/summary.h"
#include "core/report/report.h"
#include "tests/core/advise/eared_ball.h"

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

/// What the table of errors shows after a change, by another way than the diagnosis: the whole program with the changed request.
ModelSummary tableAfter(const Inspection& before, const Change& change, const std::string& model) {
  InspectionRequest request = with(before.request, change, *before.scene);
  request.models = {model};
  const Inspection after = inspect(before.given, request);
  return summarise(after, after.models.at(model));
}

DiagnoseOptions quick(std::string present = "") {
  DiagnoseOptions options;
  options.present = std::move(present);
  options.askAuto = false;
  return options;
}

TEST(Diagnosis, AFrameOfTheLightThatTheHighlightsSpeakAgainstIsNamedAndMended) {
  InspectionRequest request;
  request.models = {"limit-angle"};
  request.train = "0-5";
  for (const bool flash : {true, false}) {
    request.settings.set("light.frame", std::string(flash ? "world" : "camera"));
    const Inspection wrong = inspect(flash ? flashLitScene(sphere(0.5), 9) : exactScene(sphere(0.5), 9), request);
    const std::string stated = flash ? "light.frame=world, but the lamp moves" : "light.frame=camera, but the lamp stands still";
    const Diagnosis d = diagnose(wrong, quick());
    ASSERT_FALSE(d.remedies.empty()) << d.verdict;
    EXPECT_EQ(d.remedies.front().change.set, "light.frame=auto") << d.verdict;
    EXPECT_LT(d.remedies.front().after.pct(), kExactPct);
    EXPECT_NE(d.remedies.front().why.find("misses the peaks by"), std::string::npos) << d.remedies.front().why;
    EXPECT_LT(tableAfter(wrong, d.remedies.front().change, d.present).contourErrorPct.mean, kExactPct);
    ASSERT_FALSE(d.models.front().causes.empty());
    EXPECT_TRUE(std::any_of(d.models.front().causes.begin(), d.models.front().causes.end(), [&](const std::string& cause) {
      return cause.find(stated) != std::string::npos;
    })) << d.models.front().causes.front();
  }
}

TEST(Diagnosis, WhereNothingIsLeftToImproveItSaysSoAndTriesNothing) {
  const Inspection inspection = inspected(exactScene(sphere(0.5), 9), {"limit-angle", "canonical"});
  const Diagnosis d = diagnose(inspection);
  EXPECT_EQ(d.verdict.rfind("Nothing is left to improve: ", 0), 0U) << d.verdict;
  EXPECT_TRUE(d.remedies.empty());
  EXPECT_EQ(d.tried, 0);
  ASSERT_EQ(d.models.size(), 2U);
  for (const ModelDiagnosis& m : d.models) {
    SCOPED_TRACE(m.model);
    EXPECT_EQ(m.status, "ok");
    EXPECT_TRUE(m.causes.empty());
    EXPECT_EQ(m.error.observed(), 3) << "held-out highlights";
    for (const HighlightEvidence& e : m.evidence) EXPECT_TRUE(e.against.empty()) << e.against.front();
  }
  for (const HighlightEvidence& e : d.models[0].evidence) {
    ASSERT_TRUE(e.limitAngle && e.residualPx);
    EXPECT_NEAR(*e.limitAngle, kLimitAngle, 1e-4);
    EXPECT_LT(*e.residualPx, 0.05);
  }
}

TEST(Diagnosis, AMovedContourIsNamedAndItsExclusionIsARemedy) {
  const Inspection inspection = inspected(withMovedContour(2));
  const Diagnosis d = diagnose(inspection, quick());
  ASSERT_EQ(d.models.size(), 1U);
  const std::vector<HighlightEvidence>& evidence = d.models[0].evidence;
  const auto worst =
      std::max_element(evidence.begin(), evidence.end(), [](const auto& a, const auto& b) { return a.weight < b.weight; });
  EXPECT_EQ(worst->frame, 2);
  EXPECT_GE(worst->weight, 1);
  const auto left = std::find_if(d.remedies.begin(), d.remedies.end(), [](const Remedy& r) { return r.change.exclude == "v2"; });
  ASSERT_NE(left, d.remedies.end()) << diagnosisText(inspection, d);
  EXPECT_LT(left->after.pct(), kExactPct) << "what is left is exact";
}

/// The bound of the whole: whatever is on screen, no remedy leaves the table of errors worse than it is, and the one that stands
/// first leaves the smallest error of all models as they are, or a smaller one.
TEST(Diagnosis, RemediesAreWhatTheTableThenShows) {
  const Inspection inspection = inspected(withMovedContour(2), {"primal", "dual", "canonical", "limit-angle"});
  std::string least;
  double leastPct = 1e9;
  for (const auto& [model, result] : inspection.models)
    if (const double pct = summarise(inspection, result).wrongPct; pct < leastPct) least = model, leastPct = pct;
  for (const auto& [present, result] : inspection.models) {
    SCOPED_TRACE(present);
    DiagnoseOptions options = quick(present);
    options.mostTried = 4;
    const Diagnosis d = diagnose(inspection, options);
    EXPECT_EQ(d.present, present);
    EXPECT_EQ(d.best, least);
    EXPECT_NEAR(d.now.pct(), summarise(inspection, result).wrongPct, 1e-9);
    EXPECT_LE(d.remedies.size(), kMostRemedies);
    ASSERT_FALSE(d.remedies.empty());
    double first = 1e9;
    for (const Remedy& r : d.remedies) {
      EXPECT_NE(r.change.model, present) << "is on screen already";
      const ModelSummary after = tableAfter(inspection, r.change, r.change.model.value_or(present));
      EXPECT_LT(after.wrongPct, d.now.pct()) << flagsOf(r.change);
      first = std::min(first, r.after.pct());
    }
    EXPECT_EQ(d.remedies.front().after.pct(), first) << "best first";
    EXPECT_LE(first, leastPct + 1e-9);
    EXPECT_NE(d.verdict.find(textOf(d.remedies.front().after)), std::string::npos) << d.verdict;
  }
}

/// What was measured serves every model on screen.
TEST(Diagnosis, AnotherModelOnScreenGetsItsOwnAdviceAtOnce) {
  const Inspection inspection = inspected(exactScene(cylinder(0.3), 9), {"primal", "limit-angle"});
  Diagnosis d = diagnose(inspection, quick("primal"));
  EXPECT_EQ(d.best, "limit-angle");
  ASSERT_FALSE(d.remedies.empty());
  EXPECT_EQ(d.remedies.front().change, Change{.model = "limit-angle"});
  EXPECT_EQ(d.verdict.rfind("Use limit-angle: ", 0), 0U) << d.verdict;
  adviseFor(d, "limit-angle");
  EXPECT_TRUE(d.remedies.empty()) << flagsOf(d.remedies.front().change);
  EXPECT_EQ(d.verdict.rfind("Nothing is left to improve: limit-angle is best", 0), 0U) << d.verdict;
}

/// A model that was not computed is measured, the richest one, too.
TEST(Diagnosis, ModelsThatWereNotComputedAreTried) {
  const Inspection inspection = inspected(exactScene(cylinder(0.3), 9), {"primal"});
  DiagnoseOptions options = quick();
  options.mostTried = 0;
  const Diagnosis d = diagnose(inspection, options);
  ASSERT_FALSE(d.remedies.empty());
  EXPECT_EQ(d.present, "primal");
  EXPECT_NE(d.best, "primal");
  EXPECT_EQ(d.remedies.front().change.model, d.best);
}

/// Ears throw specks that detection does not take: contours are right, and what matters is the filter.
TEST(Diagnosis, SpuriousPredictionsCountAndTheirFilterIsTheRemedy) {
  const EaredBall ball;
  const Inspection inspection = inspected(ball.scene(), {"limit-angle"});
  const ModelSummary before = summarise(inspection, inspection.models.at("limit-angle"));
  ASSERT_GT(before.spurious, 0);
  ASSERT_EQ(before.missed, 0);
  DiagnoseOptions options = quick();
  options.mostTried = 3;
  const Diagnosis d = diagnose(inspection, options);
  ASSERT_FALSE(d.remedies.empty()) << diagnosisText(inspection, d);
  const Remedy& best = d.remedies.front();
  EXPECT_EQ(best.change.set, "predict.filter_area=true") << diagnosisText(inspection, d);
  const ModelSummary after = tableAfter(inspection, best.change, best.change.model.value_or("limit-angle"));
  EXPECT_EQ(best.before.spurious(), before.spurious);
  EXPECT_EQ(best.after.spurious(), after.spurious);
  EXPECT_LT(after.spurious, before.spurious);
  EXPECT_EQ(after.missed, 0);
  EXPECT_LT(after.wrongPct, before.wrongPct);
}

/// Every frame trains: views are left out instead, one by one.
TEST(Diagnosis, WithoutHeldOutFramesTrainingViewsAreLeftOut) {
  InspectionRequest request;
  request.models = {"primal", "limit-angle"};
  request.train = "0-8";
  const Diagnosis d = diagnose(inspect(exactScene(cylinder(0.3), 9), request), quick("primal"));
  EXPECT_TRUE(d.now.leftOut);
  EXPECT_EQ(d.now.observed(), 9);
  ASSERT_FALSE(d.remedies.empty());
  EXPECT_EQ(d.remedies.front().change.model, "limit-angle");
}

TEST(Diagnosis, TwoLimitAnglesCannotBeOne) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  const double wide = radians(6.3), narrow = radians(3.5);
  for (std::size_t f = 0; f < scene->frames.size(); ++f)
    scene->frames[f].highlights =
        exactContours(sphere(0.5), scene->frames[f].camera, {"lamp", {0.1, 0.2, 1.4}}, f % 2 == 0 ? wide : narrow);
  const Inspection inspection = inspected(scene);
  DiagnoseOptions options = quick();
  options.mostTried = 3;
  const Diagnosis all = diagnose(inspection, options);
  const ModelDiagnosis& d = all.models.at(0);
  const LimitConflict conflict = limitConflict(d.evidence);
  ASSERT_TRUE(conflict.wide && conflict.narrow) << diagnosisText(inspection, all);
  EXPECT_NEAR(degrees(*conflict.wide->limitAngle), 6.3, kAngleDeg);
  EXPECT_NEAR(degrees(*conflict.narrow->limitAngle), 3.5, kAngleDeg);
  EXPECT_TRUE(std::any_of(d.causes.begin(), d.causes.end(),
                          [](const std::string& c) { return c.find("one limit angle cannot fit both") != std::string::npos; }));
  for (const Measured& m : all.measured)
    EXPECT_NE(m.change.set.value_or("").rfind("fit.most_residual", 0), 0U) << "hides the failure";
}

TEST(Diagnosis, TheWorldsSizeChangesNothing) {
  const auto scaled = [](double s) {
    const std::shared_ptr<Scene> scene = withMovedContour(2);
    for (Frame& f : scene->frames) f.camera.camFromWorld.translation() *= s;
    AnalyticSpec& ball = *scene->surfaces.at("body").analytic();
    ball.radius *= s;
    ball.worldFromSurface.translation() *= s;
    DiagnoseOptions options = quick();
    options.mostTried = 4;
    return diagnose(inspected(scene), options);
  };
  const Diagnosis a = scaled(1), b = scaled(1000);
  ASSERT_EQ(a.remedies.size(), b.remedies.size());
  ASSERT_FALSE(a.remedies.empty());
  for (std::size_t i = 0; i < a.remedies.size(); ++i) {
    EXPECT_EQ(a.remedies[i].change, b.remedies[i].change);
    EXPECT_NEAR(a.remedies[i].after.pct(), b.remedies[i].after.pct(), 1e-3 * a.remedies[i].after.pct() + 1e-3);
  }
}

TEST(Diagnosis, NoiseAloneIsNoFault) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.2);  // px: twice what detection leaves on 8-bit frames
  for (Frame& f : scene->frames)
    for (Pixel& p : f.highlights[0].contour.points) p += Pixel(noise(random), noise(random));
  DiagnoseOptions options = quick();
  options.mostTried = 0;
  const ModelDiagnosis d = diagnose(inspected(scene), options).models.at(0);
  EXPECT_EQ(d.status, "ok");
  EXPECT_TRUE(d.causes.empty()) << d.causes.front();
  for (const HighlightEvidence& e : d.evidence) EXPECT_LT(e.weight, 1);
}

TEST(Diagnosis, WithoutAUsableViewItSaysSo) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  for (Frame& f : scene->frames) f.highlights[0].peak = Pixel(-4000, -4000);  // beside the ball
  const Inspection inspection = inspected(scene, {"limit-angle", "dual"});
  DiagnoseOptions options = quick();
  options.mostTried = 1;
  const Diagnosis all = diagnose(inspection, options);
  EXPECT_EQ(all.present, "dual") << "of those that were asked for";
  EXPECT_EQ(all.now.matched(), 0);
  ASSERT_FALSE(all.remedies.empty());
  EXPECT_EQ(all.remedies.front().change.model, "primal") << "needs no brightest point";
  for (const ModelDiagnosis& d : all.models) {
    SCOPED_TRACE(d.model);
    EXPECT_EQ(d.status, "failed");
    ASSERT_FALSE(d.causes.empty());
    ASSERT_EQ(d.evidence.size(), 6U);
    for (const HighlightEvidence& e : d.evidence) {
      ASSERT_FALSE(e.against.empty());
      EXPECT_EQ(e.against.front().rfind("cannot be used: ", 0), 0U);
    }
  }
}

/// A held-out frame that shows something else: without it the mean would be smaller by definition, which is no remedy.
TEST(Diagnosis, LeavingAFrameOutOfTheScoreIsNoRemedy) {
  const Inspection inspection = inspected(withMovedContour(7));
  const Diagnosis d = diagnose(inspection, quick());
  for (const Measured& m : d.measured) EXPECT_NE(m.change.exclude, "v7");
  const std::vector<std::string>& causes = d.models.at(0).causes;
  EXPECT_TRUE(std::any_of(causes.begin(), causes.end(),
                          [](const std::string& c) { return c.find("held-out frame v7 off by ") != std::string::npos; }));
}

/// Somebody waits: what the computed models tell comes before anything is measured, steps are counted, and each word adds to
/// those before.
TEST(Diagnosis, TheFirstWordComesAtOnceAndStepsAreCounted) {
  const Inspection inspection = inspected(withMovedContour(2), {"primal", "limit-angle"});
  DiagnoseOptions options = quick("primal");
  options.mostTried = 2;
  std::size_t words = 0, measured = 0;
  int last = 0;
  bool trialBeforeWord = false;
  options.soFar = [&](const Diagnosis& d) {
    EXPECT_TRUE(d.complete || d.verdict.rfind("Nothing that was tried", 0) != 0) << d.verdict;
    if (words++ == 0) {
      EXPECT_EQ(d.tried, 0);
      ASSERT_FALSE(d.remedies.empty());
      EXPECT_EQ(d.remedies.front().change.model, "limit-angle");
    }
    EXPECT_GE(d.measured.size(), measured);
    measured = d.measured.size();
  };
  const Diagnosis d = diagnose(inspection, options, [&](const StageEvent& e) {
    trialBeforeWord = trialBeforeWord || (words == 0 && e.stage.rfind("try ", 0) == 0);
    EXPECT_GE(e.done, last);
    EXPECT_LT(e.done, e.total);
    last = e.done;
    return true;
  });
  EXPECT_FALSE(trialBeforeWord);
  EXPECT_GT(words, 3U);
  EXPECT_GT(d.tried, 0);
}

TEST(Diagnosis, StopsWhenAskedAndHasToldWhatItKnew) {
  const Inspection inspection = inspected(withMovedContour(2), {"primal", "limit-angle"});
  std::optional<Diagnosis> told;
  DiagnoseOptions options = quick("primal");
  options.soFar = [&](const Diagnosis& d) { told = d; };
  EXPECT_THROW(diagnose(inspection, options, [&](const StageEvent&) { return !told; }), Stopped);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->remedies.at(0).change.model, "limit-angle");
  EXPECT_THROW(diagnose(inspection, {}, [](const StageEvent&) { return false; }), Stopped);
}

/// The longest steps are fits without a view: a stop does not wait for the end of one. The second time that it asks is within the
/// first fit.
TEST(Diagnosis, AStopEndsAFitInItsMiddle) {
  const Inspection inspection = inspected(withMovedContour(2), {"reflectance"});
  std::vector<Fold> folds = foldsOf(inspection, LeaveOut::Place);
  int asked = 0;
  EXPECT_THROW(leaveOut(folds.at(0), modelByName("reflectance"), inspection.request.settings, PoorFits::Take,
                        [&](const StageEvent&) { return ++asked < 2; }),
               Stopped);
  EXPECT_EQ(asked, 2);
}

/// Trials on the same frames share what does not depend on the model.
TEST(Diagnosis, ATrialSaysWhatARunOfItsOwnSays) {
  const Inspection inspection = inspected(withMovedContour(2), {"canonical", "limit-angle"});
  std::map<std::string, int> trials;  // of the same frames
  DiagnoseOptions options = quick();
  options.mostTried = 18;  // a third of them for the other model
  for (const Measured& m : diagnose(inspection, options).measured) {
    if (!m.change.train && !m.change.exclude) continue;
    SCOPED_TRACE(flagsOf(m.change));
    ++trials[m.change.train.value_or("") + "/" + m.change.exclude.value_or("")];
    const Inspection own = inspect(inspection.given, with(inspection.request, m.change, *inspection.scene));
    EXPECT_EQ(unseenError(own, *m.change.model, {}).views, m.error.views);
  }
  EXPECT_TRUE(std::any_of(trials.begin(), trials.end(), [](const auto& t) { return t.second > 1; }));
}

TEST(Diagnosis, ItsBoundIsKept) {
  DiagnoseOptions options = quick();
  options.mostTried = 1;
  const Diagnosis d = diagnose(inspected(withMovedContour(2)), options);
  EXPECT_LE(d.tried, 2 * static_cast<int>(modelIds().size()) - 1) << "the other models, and one change of each";
  EXPECT_GT(d.known, d.tried);
}

/// Where the training frames alone point to another model than the held-out frames do, a sentence says so.
TEST(Diagnosis, TheAutomaticChoiceIsNamedWhereItDiffers) {
  const Inspection inspection = inspected(withMovedContour(2), {"dual", "limit-angle"});
  DiagnoseOptions options;
  options.mostTried = 0;
  const Diagnosis d = diagnose(inspection, options);
  const Selection choice = selectModel(inspection, std::nullopt);
  const bool said = std::any_of(d.notes.begin(), d.notes.end(),
                                [](const std::string& n) { return n.find("--models auto") != std::string::npos; });
  EXPECT_EQ(said, choice.model != d.best) << choice.model << " " << d.best;
  if (said) EXPECT_NE(d.notes.back().find(choice.model.empty() ? "no model" : choice.model), std::string::npos);
}

/// By hand: 10 for one matched, 100 for one that is off by 250 %, 100 for a missed one, 3 x 0.1 for the spurious ones; of three
/// observed.
TEST(WrongPct, CountsWhatHasNoContourError) {
  ComparisonTally tally;
  tally.matched = 2;
  tally.missed = 1;
  tally.spurious = 3;
  tally.observed = true;
  tally.measured = {{.contourErrorPct = 10}, {.contourErrorPct = 250}};
  EXPECT_NEAR(tally.wrongPct(), 210.3, 1e-9);
  EXPECT_NEAR(summaryOf({tally}, {}, {}).wrongPct, 70.1, 1e-9);
  EXPECT_TRUE(std::isnan(summaryOf({}, {}, {}).wrongPct)) << "nothing was observed";
}

UnseenError errorsOf(const std::vector<double>& pct) {
  UnseenError error;
  for (std::size_t i = 0; i < pct.size(); ++i) {
    const bool missed = pct[i] >= 100;
    error.views.push_back({int(i), "lamp", !missed, missed, 0, missed ? 0 : pct[i], pct[i]});
  }
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

/// Contours decide first; of equal ones the number of spurious highlights.
TEST(IsBetter, FewerSpuriousHighlightsAndNoWorseContours) {
  const auto with = [](std::vector<double> pct, int spurious) {
    UnseenError e = errorsOf(pct);
    e.views[0].spurious = spurious;
    e.views[0].wrongPct += kSpuriousPct * spurious;
    return e;
  };
  EXPECT_TRUE(isBetter(with({9, 9, 9}, 2), with({9, 9, 9}, 19)));
  EXPECT_FALSE(isBetter(with({9, 9, 9}, 18), with({9, 9, 9}, 19))) << "less than a tenth";
  EXPECT_FALSE(isBetter(with({9, 9, 100}, 0), with({9, 9, 9}, 19))) << "what it takes out was observed";
  EXPECT_LT(with({0.01, 0.01, 0.01}, 30).pct(), with({2, 2, 2}, 0).pct());
}

/// Other training frames leave other frames to be scored: over those of both it must be better, and the number on screen must not
/// be larger.
TEST(IsBetter, OverOtherFramesNeitherByChanceNorByChoice) {
  UnseenError other = errorsOf({4, 4, 4, 4, 1, 1, 1});
  other.views.erase(other.views.begin(), other.views.begin() + 4);
  EXPECT_FALSE(isBetter(other, errorsOf({4, 4, 4, 4, 2, 2, 2}))) << "fewer than half of what is scored now";
  UnseenError worseElsewhere = errorsOf({1, 1, 1, 30});
  EXPECT_FALSE(isBetter(worseElsewhere, errorsOf({2, 2, 2})))
      << "better in common frames; the table would show 8.25 % instead of 2 %";
}

TEST(Changes, AreWhatTheFlagsTake) {
  const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
  InspectionRequest request;
  request.excluded = {1};
  Change change;
  change.set = "light.solver=triangulated";
  change.exclude = "1,3";
  EXPECT_EQ(flagsOf(change), "--set light.solver=triangulated --exclude 1,3");
  EXPECT_EQ(wordsOf(change), "set light.solver = triangulated and leave out 1,3");
  const InspectionRequest changed = with(request, change, *scene);
  EXPECT_EQ(changed.settings.text("light.solver"), "triangulated");
  EXPECT_EQ(changed.excluded, (std::vector<int>{1, 3}));
  change.exclude = "17";
  EXPECT_ANY_THROW(with(request, change, *scene));
}

}  // namespace glint::diagnosis_tests

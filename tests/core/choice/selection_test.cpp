// SPDX-License-Identifier: BSD-3-Clause
// The automatic choice on scenes where the right answer follows from what the models assume (method.md section 7).
#include "core/choice/selection.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/pipeline/summary.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;

/// Where every model is fitted many times: one lobe, and a point light.
void makeQuick(InspectionRequest& request) {
  request.settings.setFromText("fit.lobe", "phong");
  request.settings.setFromText("fit.light_size", "point");
}

Inspection evidenceOf(std::shared_ptr<const Scene> scene, const std::string& train, double noisePx = 0, bool quick = false,
                      double mostResidual = 0.1) {
  InspectionRequest request;
  request.settings.set("fit.most_residual", mostResidual);
  request.models.clear();
  if (quick) makeQuick(request);
  request.train = train;
  request.noisePx = noisePx;
  return inspect(std::move(scene), request);
}

Selection choiceOn(const AnalyticSpec& spec, std::optional<double> goodEnough = {}, double noisePx = 0) {
  return selectModel(evidenceOf(exactScene(spec, 8), "spread:6", noisePx), goodEnough);
}

const Candidate& candidate(const Selection& s, const std::string& model) {
  return *std::find_if(s.candidates.begin(), s.candidates.end(), [&](const Candidate& c) { return c.model == model; });
}

// method.md section 11: a noise-free plane gives `primal`.
TEST(SelectModel, APlaneNeedsOnlyTheCamera) {
  const Selection s = choiceOn(sheet(0));
  EXPECT_EQ(s.model, "primal") << selectionTable(s);
  EXPECT_EQ(s.candidates.size(), 1u) << "nothing can be better by more than contours resolve, so nothing richer is computed";
  EXPECT_THAT(s.why, HasSubstr("Richer models were not tried"));
}

TEST(SelectModel, APlaneWithAToleranceNeedsOnlyTheCamera) {
  const Selection s = choiceOn(sheet(0), 0.5);
  EXPECT_EQ(s.model, "primal") << s.why;
  EXPECT_EQ(s.candidates.size(), 1u) << "nothing richer is computed";
}

/// Held-out errors of all models; infinite where one leaves a highlight out.
std::map<std::string, double> heldOutErrors(std::shared_ptr<const Scene> scene, const std::string& train, double noisePx) {
  InspectionRequest request;
  makeQuick(request);
  request.train = train;
  request.noisePx = noisePx;
  const Inspection all = inspect(std::move(scene), request);
  std::map<std::string, double> errors;
  for (const auto& [name, model] : all.models) {
    const ModelSummary s = summarise(all, model);
    errors[name] = s.answered && s.predicted == s.frames && s.missed == 0 ? s.contourErrorPct.mean : HUGE_VAL;
  }
  return errors;
}

// The noise of the left-out contours hides which model is best: leaving one out says 1.37 % of `primal` and 1.32 % of
// `limit-angle` at 2 px. In held-out frames, against exact contours, they have 0.47 and 0.16 %: nine free numbers against four.
TEST(SelectModel, NoiseDoesNotHideWhichModelIsBest) {
  for (const double noise : {0.5, 2.0}) {
    const auto scene = exactScene(sheet(0), 8);
    const Selection s = selectModel(evidenceOf(scene, "spread:6", noise, true), {});
    ASSERT_NE(s.model, "") << selectionTable(s);
    const std::map<std::string, double> errors = heldOutErrors(scene, "spread:6", noise);
    double best = HUGE_VAL;
    for (const auto& [name, error] : errors) best = std::min(best, error);
    EXPECT_LE(errors.at(s.model), 2 * std::max(best, kNegligiblePct)) << selectionTable(s);
  }
}

// One ellipsoid in the real cameras does not explain highlights that a cylinder curves: `primal` leaves more than a hundredth of
// the radius of the views that it is fitted to, and no view needs to be left out to see that.
TEST(SelectModel, WhatDoesNotFitAllViewsIsNotTriedViewByView) {
  const Selection s = selectModel(evidenceOf(exactScene(cylinder(0.4), 8), "spread:6", 0, true, 0.01), {});
  EXPECT_EQ(s.model, "limit-angle") << selectionTable(s);
  EXPECT_EQ(candidate(s, "primal").tried, 0) << selectionTable(s);
  EXPECT_EQ(candidate(s, "primal").views, 6);
  EXPECT_THAT(candidate(s, "primal").remark, HasSubstr("no view was left out")) << "and the table says so";
  EXPECT_EQ(candidate(s, "limit-angle").tried, 6);
}

TEST(SelectModel, ASphereNeedsTheLevelSet) {
  const Selection s = choiceOn(sphere(0.5));
  EXPECT_EQ(s.model, "limit-angle") << selectionTable(s);
  EXPECT_GT(candidate(s, "dual").meanPct, kNegligiblePct);
}

TEST(SelectModel, ASphereWithATightToleranceNeedsTheLevelSet) {
  const Selection s = choiceOn(sphere(0.5), 0.05);
  EXPECT_EQ(s.model, "limit-angle") << s.why;
  EXPECT_EQ(s.candidates.size(), 4u);
  EXPECT_THAT(s.why, HasSubstr("tolerance of 0.05 %"));
}

// The tolerance decides, not the name: an ellipsoid is taken exactly where its error is under it.
TEST(SelectModel, ASphereGivesAnEllipsoidOnlyWithAToleranceAboveItsError) {
  const Selection all = choiceOn(sphere(0.5));
  double smallest = 1e300;
  std::string which;
  for (const char* model : {"primal", "dual", "canonical"})
    if (candidate(all, model).meanPct < smallest) smallest = candidate(all, model).meanPct, which = model;
  EXPECT_EQ(choiceOn(sphere(0.5), smallest * 1.01).model, which);
  EXPECT_EQ(choiceOn(sphere(0.5), smallest * 0.99).model, "limit-angle");
}

TEST(SelectModel, ACylinderNeedsTheLevelSet) {
  const Selection s = choiceOn(cylinder(0.4));
  EXPECT_EQ(s.model, "limit-angle") << selectionTable(s);
}

TEST(SelectModel, NoToleranceThatIsMetSaysSo) {
  const Selection s = choiceOn(sphere(0.5), {}, 1.0);
  const Selection strict = choiceOn(sphere(0.5), 1e-6, 1.0);
  EXPECT_EQ(strict.model, s.model);
  EXPECT_THAT(strict.why, HasSubstr("No model reached the stated tolerance of 1e-06 %."));
}

TEST(SelectModel, TwoLightsAreLeftOutTogether) {
  const auto scene = exactScene(sheet(0), {{"a", {0.1, 0.2, 1.4}}, {"b", {-0.25, 0.1, 1.5}}}, 6, [](int) {
    return std::vector<std::string>{"a", "b"};
  });
  const Selection s = selectModel(evidenceOf(scene, "spread:6"), {});
  EXPECT_EQ(s.leftOut, 12) << "one highlight of each light in each frame";
  EXPECT_EQ(s.model, "primal") << selectionTable(s);
}

// Trained on the flat sheet alone `primal` is perfect there and useless on the bent one, which leaving views out cannot see.
TEST(SelectModel, AnEllipsoidOfTheSeenSurfaceDoesNotCarryOver) {
  auto scene = exactScene(sheet(0), 6);
  const auto bent = exactScene(sheet(1.5), 6);
  scene->surfaces["bent"] = sheet(1.5);
  for (Frame f : bent->frames) {
    f.id += "bent";
    f.surface = "bent";
    scene->frames.push_back(f);
  }
  const Selection s = selectModel(evidenceOf(scene, "0-5"), {});
  // `canonical`, which was chosen while richer models were left untried, is off by 0.3 % on the bent sheet (docs/selection.md).
  EXPECT_EQ(s.model, "limit-angle") << selectionTable(s);
  EXPECT_LT(candidate(s, "canonical").meanPct, kNegligiblePct) << "so leaving one out does not tell";
  EXPECT_GT(candidate(s, "canonical").disagreementPct, 2 * kNegligiblePct) << "looking ahead does";
  EXPECT_THAT(candidate(s, "primal").remark, HasSubstr("surfaces that no training view shows"));
  EXPECT_LT(candidate(s, "primal").meanPct, kNegligiblePct) << "so leaving views out alone would have taken it";
  const Selection easy = selectModel(evidenceOf(scene, "0-5"), 50.0);
  EXPECT_EQ(easy.model, "canonical") << "no tolerance makes up for that";
  const Selection known = selectModel(evidenceOf(scene, "0-11"), 0.5);
  EXPECT_NE(known.model, "primal");
}

// The work grows with the views, not with their square.
TEST(SelectModel, LeavesAtMostSomeViewsOut) {
  const Selection s = selectModel(evidenceOf(exactScene(sheet(0), 30), "spread:30"), 0.5);
  EXPECT_EQ(s.trainingViews, 30);
  EXPECT_EQ(s.leftOut, kMostLeftOut);
  EXPECT_THAT(selectionTable(s), HasSubstr("24 of 30 training views were left out one at a time"));
}

TEST(SelectModel, NothingToLeaveOut) {
  const Selection one = selectModel(evidenceOf(exactScene(sheet(0), 4), "0"), {});
  EXPECT_EQ(one.model, "");
  EXPECT_THAT(one.candidates[0].remark, HasSubstr("too few views"));
  auto blind = exactScene(sheet(0), 4);
  for (Frame& f : blind->frames) f.highlights.clear();
  const Selection none = selectModel(evidenceOf(blind, "spread:4"), {});
  EXPECT_EQ(none.model, "");
  EXPECT_EQ(none.why, "No training view can be left out.");
  EXPECT_THAT(one.why, HasSubstr("from one place only"));
}

// Views from one place are left out together; then none is left.
TEST(SelectModel, AllViewsFromOnePlace) {
  auto scene = exactScene(sphere(0.5), 1);
  for (int i = 1; i < 4; ++i) {
    scene->frames.push_back(scene->frames.front());
    scene->frames.back().id += std::to_string(i);
    for (Highlight& h : scene->frames.back().highlights)
      std::rotate(h.contour.points.begin(), h.contour.points.begin() + i, h.contour.points.end());
  }
  const Selection s = selectModel(evidenceOf(scene, "0-3"), {});
  EXPECT_EQ(s.model, "");
  EXPECT_THAT(s.why, HasSubstr("from one place only"));
}

/// Six training views within 1.5 degrees, a lamp 2.7 m away, then eight views held out 14 degrees apart: nothing that leaving one
/// out can show tells how the models do there.
std::shared_ptr<Scene> narrowScene(const AnalyticSpec& spec, double stepDeg = 0.3) {
  auto scene = std::make_shared<Scene>();
  scene->name = "narrow";
  scene->surfaces["body"] = spec;
  const NamedLight lamp{"lamp", {0.4, 1.2, 2.4}};
  for (int i = 0; i < 14; ++i) {
    const double azimuth = i < 6 ? 10 + stepDeg * i : 10 + 14 * (i - 9.5), elevation = i < 6 ? 50 + 0.3 * std::sin(2.0 * i) : 50;
    const double a = azimuth * std::numbers::pi / 180, e = elevation * std::numbers::pi / 180;
    Frame f;
    f.id = "v" + std::to_string(i);
    f.camera = lookingAt(1.3 * Eigen::Vector3d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)), {0, 0, 0});
    f.surface = "body";
    f.lightsOn = {"lamp"};
    f.highlights = exactContours(spec, f.camera, lamp);
    for (Highlight& h : f.highlights)
      h.touchesBorder = false;  // a sheet's end beyond the margin of 300 px, which is known whole here
    scene->frames.push_back(f);
  }
  return scene;
}

AnalyticSpec about(AnalyticSpec spec) {
  spec.worldFromSurface.setIdentity();
  return spec;
}

double smallestIou(std::shared_ptr<const Scene> scene, double noisePx, unsigned seed, const std::string& model) {
  InspectionRequest request;
  request.models = {model};
  request.train = "0-5";
  request.noisePx = noisePx;
  request.seed = seed;
  const Inspection result = inspect(std::move(scene), request);
  double smallest = 1;
  for (const FrameComparison& f : result.models.at(model).frames)
    if (result.isHeldOut(f.frame)) smallest = std::min(smallest, f.iou);
  return smallest;
}

// On a sphere seen from almost one place every model explains the training views; `primal` misses what comes next.
TEST(SelectModel, NarrowViewsOfASphereAreNoPlane) {
  const auto scene = narrowScene(about(sphere(0.25)));
  for (const unsigned seed : {1u, 2u}) {
    InspectionRequest request;
    request.models.clear();
    makeQuick(request);
    request.train = "0-5";
    request.noisePx = 0.3;
    request.seed = seed;
    const Selection s = selectModel(inspect(scene, request), {});
    ASSERT_NE(s.model, "") << selectionTable(s);
    EXPECT_GT(smallestIou(scene, 0.3, seed, s.model), 0.5) << s.model << "\n" << selectionTable(s);
    EXPECT_LT(smallestIou(scene, 0.3, seed, "primal"), 0.5) << "or this scene would show nothing";
    EXPECT_THAT(candidate(s, "primal").remark, HasSubstr("needs a plane"));
    EXPECT_EQ(s.toPredict, 8);
    EXPECT_EQ(s.outside, 8);
    EXPECT_EQ(s.decidedBy, "extrapolation");
    EXPECT_THAT(s.why, HasSubstr("outside the training views"));
  }
}

// A flat sheet shows where the mirrored lamp is, which takes a baseline: seen with 3 px of noise from almost one place no model
// knows what is to be seen from far away: what is chosen is poor.
TEST(SelectModel, AboveTheCeilingAChoiceIsPoor) {
  const auto scene = narrowScene(sheet(0), 0.02);
  constexpr double kAnswersAll = 10;  // else no fit would be left for the ceiling to refuse
  const Selection s = selectModel(evidenceOf(scene, "0-5", 3.0, true, kAnswersAll), {});
  EXPECT_STREQ(s.status(), "poor") << selectionTable(s);
  EXPECT_THAT(s.why, HasSubstr("Poor: ")) << selectionTable(s);
  EXPECT_LE(candidate(s, s.model).expectedPct, kLargestPoorPct);
  EXPECT_EQ(s.best, s.model);
  const Selection tolerant = selectModel(evidenceOf(scene, "0-5", 3.0, true, kAnswersAll), 50.0);
  EXPECT_STRNE(tolerant.status(), "ok") << "no stated tolerance lifts the ceiling\n" << selectionTable(tolerant);
  for (const auto& [name, error] : heldOutErrors(scene, "0-5", 3.0))
    EXPECT_GT(error, kLargestExpectedPct) << name << " would have been right";
}

TEST(SelectModel, RicherModelsAreTriedThoughASimpleOneIsGood) {
  const Selection s = choiceOn(sphere(0.5));
  EXPECT_LT(candidate(s, "limit-angle").meanPct, kNegligiblePct);
  EXPECT_EQ(s.candidates.back().model, "reflectance");
  const Selection tolerant = choiceOn(sphere(0.5), 0.05);
  EXPECT_EQ(tolerant.candidates.back().model, "limit-angle") << "unless a tolerance is stated";
}

// A tolerance is a statement about the views to predict too: what leaving one out finds good enough may not be.
TEST(SelectModel, AToleranceCountsOutsideTheTrainingViews) {
  const auto scene = narrowScene(about(sphere(0.25)));
  const Selection s = selectModel(evidenceOf(scene, "0-5"), 1.0);
  ASSERT_NE(s.model, "") << selectionTable(s);
  EXPECT_GT(smallestIou(scene, 0, 1, s.model), 0.9) << selectionTable(s);
}

// Three views: `canonical` cannot be fitted to the two that stay, `limit-angle` can.
TEST(SelectModel, AModelMustAnswerWhatAnotherAnswers) {
  const Selection s = selectModel(evidenceOf(exactScene(sphere(0.5), 3), "spread:3"), {});
  EXPECT_EQ(s.model, "limit-angle") << selectionTable(s);
  EXPECT_EQ(candidate(s, "canonical").answered, 0);
  EXPECT_THAT(candidate(s, "canonical").remark, HasSubstr("too few views"));
}

TEST(SelectModel, StopsWhenAsked) {
  const Inspection inspection = evidenceOf(exactScene(sheet(0), 6), "spread:6");
  EXPECT_THROW(selectModel(inspection, {}, [](const StageEvent&) { return false; }), Stopped);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// The pipeline as a whole: reuse of stages, lights that go on and off, several lights.
#include <gtest/gtest.h>

#include "core/app/session.h"
#include "core/pipeline/summary.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using namespace testing_support;

const NamedLight kLeft{"left", {-0.25, 0.1, 1.4}}, kRight{"right", {0.3, 0.0, 1.3}};
const std::vector<std::string> kBoth{"left", "right"};

/// Another legal value of a setting.
SettingValue otherValue(const ParamSpec& p) {
  if (!p.choices.empty())
    return p.choices.front() == std::get<std::string>(p.defaultValue) ? p.choices.back() : p.choices.front();
  if (const int* i = std::get_if<int>(&p.defaultValue)) return *i + 4 <= p.max ? *i + 4 : static_cast<int>(p.max);
  if (const bool* b = std::get_if<bool>(&p.defaultValue)) return !*b;
  const double d = std::get<double>(p.defaultValue);
  return d == 0 ? p.min + 0.1 * (std::min(p.max, 10.0) - p.min) : std::max(p.min, 0.5 * d);
}

void expectFreshEqualsIncremental(const std::shared_ptr<const Scene>& scene, const InspectionRequest& before,
                                  const InspectionRequest& after, const std::string& what) {
  const Inspection first = inspect(scene, before);
  EXPECT_EQ(digestOf(inspect(scene, after, {}, &first)), digestOf(inspect(scene, after))) << what;
}

InspectionRequest request() {
  InspectionRequest q;
  q.train = "first:4";
  return q;
}

/// Three training frames and one held out: enough for every model, quick enough for two runs a setting.
InspectionRequest small() {
  InspectionRequest q;
  q.train = "first:3";
  return q;
}

TEST(Inspect, IncrementalEqualsFreshForEverySetting) {
  const auto scene = exactScene(sheet(0.4), 4);
  const Inspection first = inspect(scene, small());
  for (const ParamSpec& p : allParams()) {
    InspectionRequest q = small();
    q.settings.set(p.key, otherValue(p));
    ASSERT_EQ(q.settings.values().count(p.key), 1u) << p.key << ": the test must change it";
    EXPECT_EQ(digestOf(inspect(scene, q, {}, &first)), digestOf(inspect(scene, q))) << p.key;
  }
}

TEST(Inspect, IncrementalEqualsFreshForEveryRequestField) {
  const auto scene = exactScene(sheet(0.4), 4);
  std::vector<std::pair<std::string, InspectionRequest>> requests(9, {"", small()});
  requests[0].first = "models", requests[0].second.models = {"limit-angle", "primal"};
  requests[1].first = "train", requests[1].second.train = "1-3";
  requests[2].first = "per surface", requests[2].second.train = "per-surface";
  requests[3].first = "excluded training frame", requests[3].second.excluded = {1};
  requests[4].first = "excluded held-out frame", requests[4].second.excluded = {3};
  requests[5].first = "source", requests[5].second.source = FrameSource::Image;
  requests[6].first = "noise", requests[6].second.noisePx = 0.5;
  requests[7].first = "noise and seed", requests[7].second.noisePx = 0.5, requests[7].second.seed = 2;
  requests[8].first = "none", requests[8].second.models = {};
  const Inspection base = inspect(scene, small());
  const std::string baseDigest = digestOf(base);
  for (const auto& [name, other] : requests) {
    const Inspection fresh = inspect(scene, other);
    EXPECT_EQ(digestOf(inspect(scene, other, {}, &base)), digestOf(fresh)) << "to: " << name;
    EXPECT_EQ(digestOf(inspect(scene, small(), {}, &fresh)), baseDigest) << "back from: " << name;
  }
}

TEST(Inspect, AModelNamedTwiceIsFittedOnce) {
  const auto scene = exactScene(sheet(0), 5);
  InspectionRequest q = request();
  q.models = {"primal", "limit-angle", "primal"};
  const Inspection r = inspect(scene, q);
  EXPECT_EQ(r.models.at("primal").fits.size(), 1u);
  EXPECT_EQ(r.models.at("primal").frames.size(), 5u);
  EXPECT_EQ(r.request.models.size(), 2u);
}

// Exact contours, point light: limit-angle is the true model, so what remains is that the given chords lie up to 5e-3 px inside.
constexpr double kChordPx = 2e-2;
constexpr double kChordLightM = 3e-3;  // the same 1e-4 of a contour's radius moves the light along its weakest direction

TEST(Inspect, TwoLightsGivenByTheSceneKeepTheirNamesAndTheirFits) {
  const auto scene = exactScene(sheet(0), {kLeft, kRight}, 8, [](int) { return kBoth; });
  const Inspection r = inspect(scene, request());
  for (std::size_t i = 0; i < 8; ++i) {
    ASSERT_EQ(r.evidence[i].highlights.size(), 2u);
    for (std::size_t h = 0; h < 2; ++h) EXPECT_EQ(r.evidence[i].highlights[h].light, scene->frames[i].highlights[h].light);
  }
  for (const NamedLight& light : {kLeft, kRight})
    EXPECT_LT((r.lightFor(0, light.id)->light.position() - light.position).norm(), kChordLightM) << light.id;
  const ModelSummary s = summarise(r, r.models.at("limit-angle"));
  EXPECT_EQ(s.frames, 8);  // 4 held-out frames of 2 lights
  EXPECT_EQ(s.matched, 8);
  EXPECT_EQ(s.missed + s.spurious, 0);
  EXPECT_LT(s.contourErrorPx.max, kChordPx);
}

TEST(Inspect, TwoLightsNotNamedAreToldApart) {
  const auto scene =
      exactScene(sheet(0.3), {kLeft, kRight}, 8, [](int i) { return i == 0 ? std::vector<std::string>{"left"} : kBoth; });
  for (Frame& f : scene->frames)
    for (Highlight& h : f.highlights) h.light.clear();
  InspectionRequest q = request();
  const Inspection r = inspect(scene, q);
  for (const NamedLight& light : {kLeft, kRight}) {
    ASSERT_TRUE(r.lightFor(0, light.id)) << light.id;
    EXPECT_LT((r.lightFor(0, light.id)->light.position() - light.position).norm(), kChordLightM) << light.id;
  }
  EXPECT_EQ(summarise(r, r.models.at("limit-angle")).matched, 8);
}

TEST(Inspect, ALightSwitchedOffIsNotPredictedThere) {
  // "right" is off in frames 2 and 6; one of them trains, one is held out.
  const auto scene = exactScene(sheet(0.2), {kLeft, kRight}, 8,
                                [](int i) { return i == 2 || i == 6 ? std::vector<std::string>{"left"} : kBoth; });
  const Inspection r = inspect(scene, request());
  const ModelSummary s = summarise(r, r.models.at("limit-angle"));
  EXPECT_EQ(s.frames, 7);
  EXPECT_EQ(s.matched, 7);
  EXPECT_EQ(s.missed + s.spurious, 0);
}

/// Mirror points depend on the normals, so the assignment does.
TEST(Inspect, AssignmentOfLightsFollowsTheSurfaceSettings) {
  const auto scene = exactScene(sheet(0.3), {kLeft, kRight}, 6, [](int) { return kBoth; });
  for (Frame& f : scene->frames)
    for (Highlight& h : f.highlights) h.light.clear();
  InspectionRequest facet = request();
  facet.settings.set("surface.normals", std::string("facet"));
  const Inspection first = inspect(scene, facet);
  EXPECT_FALSE(first.inputs.same(Stage::Evidence, inspect(scene, request()).inputs));
  expectFreshEqualsIncremental(scene, facet, request(), "normals");
}

TEST(Inspect, StopsWhenAsked) {
  const auto scene = exactScene(sheet(0), 5);
  int reports = 0;
  inspect(scene, request(), [&](const StageEvent&) { return ++reports, true; });
  ASSERT_GT(reports, 20);
  for (int stop = 1; stop <= reports; stop += 7) {
    int n = 0;
    EXPECT_THROW(inspect(scene, request(), [&](const StageEvent&) { return ++n < stop; }), Stopped) << stop;
  }
}

TEST(Inspect, AnExceptionOfTheProgressFunctionReachesTheCaller) {
  const auto scene = exactScene(sheet(0), 12);
  for (int at = 1; at < 20; ++at) {
    int n = 0;
    EXPECT_THROW(inspect(scene, request(), [&](const StageEvent&) { return ++n == at ? throw std::runtime_error("x") : true; }),
                 std::runtime_error);
  }
}

TEST(Inspect, RefusesModelsAndFramesThatDoNotExist) {
  const auto scene = exactScene(sheet(0), 4);
  InspectionRequest q = request();
  q.models = {"primal", "tertiary"};
  EXPECT_THROW(inspect(scene, q), InputError);
  q = request();
  q.train = "first:5";
  EXPECT_THROW(inspect(scene, q), InputError);
}

TEST(Summary, SaysWhyThereIsNothingToAverage) {
  const auto scene = exactScene(sheet(0.4), 5);
  InspectionRequest q;
  q.models = {"limit-angle"};
  q.train = "0-4";
  const Inspection all = inspect(scene, q);
  const ModelSummary none = summarise(all, all.models.at("limit-angle"));
  EXPECT_FALSE(none.answered);
  EXPECT_NE(none.reason.find("held out"), std::string::npos) << none.reason;
  q.train = "0-3";
  q.excluded = {4};
  const Inspection excluded = inspect(scene, q);
  EXPECT_EQ(summarise(excluded, excluded.models.at("limit-angle")).reason, none.reason);
  // Nothing predicted, nothing observed: it makes a difference whether anybody could look.
  q.excluded.clear();
  q.train = "0-2";
  Inspection dark = inspect(scene, q);
  const ModelResult nothing{"limit-angle", {}, {}};
  for (const int i : {3, 4}) {
    dark.evidence[std::size_t(i)].highlights.clear();
    dark.evidence[std::size_t(i)].failure = Failure{Reason::FrameUnreadable, "gone.png: cannot be read"};
  }
  EXPECT_EQ(summarise(dark, nothing).reason, "no held-out frame can be read");
  dark.evidence[4].failure = Failure{Reason::NoHighlight, ""};
  EXPECT_EQ(summarise(dark, nothing).reason, "no held-out frame has a highlight");
}

TEST(Inspect, AllTrainingFramesExcludedIsANamedFailure) {
  const auto scene = exactScene(sheet(0), 5);
  InspectionRequest q = request();
  q.excluded = {0, 1, 2, 3};
  const Inspection r = inspect(scene, q);
  for (const auto& [name, model] : r.models) {
    ASSERT_EQ(model.fits.size(), 1u) << name;
    ASSERT_TRUE(model.fits[0].failure()) << name;
    EXPECT_EQ(model.fits[0].failure()->reason, Reason::TooFewViews) << name;
    EXPECT_EQ(summarise(r, model).frames, 1) << name;
    EXPECT_FALSE(summarise(r, model).reason.empty());
  }
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/trial_search.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

namespace glint {
namespace {
using testing::HasSubstr;

/// A made-up program: costs are products of factors of the knobs, so that the best settings are known by hand.
/// "a" 10 % 100 us. Directions: 12 halves the time and adds half to the error, 72 doubles the time and halves the error. The
/// solver "linear" fails, "anchored" changes nothing. Level-set step 8: slower and worse. Walk tolerance 1e-4: 0.6 of the time at
/// the same error and contours.
struct Program {
  int calls = 0;
  std::set<std::string> seen;
  Outcome<TrialResult> operator()(const Trial& t) {
    ++calls;
    const int n = t.settings.integer("predict.directions");
    const std::string solver = t.settings.text("fit.solver");
    const double step = t.settings.number("predict.level_set_step"), tolerance = t.settings.number("predict.walk_tolerance");
    EXPECT_TRUE(
        seen.insert(t.model + std::to_string(n) + solver + std::to_string(step) + std::to_string(tolerance * 1e12)).second)
        << "tried twice";
    if (solver == "linear") return Failure{Reason::NotAnEllipsoid, "a hyperboloid"};
    TrialResult r{10, 100, ""};
    if (t.model == "b") r = {1, 1000, ""};
    if (t.model == "hopeless") r = {90, 500, ""};
    if (n == 12) r.us /= 2, r.errorPct *= 1.5;
    if (n == 72) r.us *= 2, r.errorPct /= 2;
    if (step == 8) r.us *= 2, r.errorPct *= 2;
    r.predictions = std::to_string(r.errorPct);
    if (tolerance > 1e-5) r.us *= 0.6;
    return r;
  }
};

std::vector<Knob> someKnobs() {
  return {{"fit.solver", {std::string("linear"), std::string("anchored"), std::string("refined")}},
          {"predict.directions", {12, 36, 72}},
          {"predict.level_set_step", {4.0, 8.0}},
          {"predict.walk_tolerance", {1e-10, 1e-4}}};
}

SearchResult search(Program& program, const std::vector<std::string>& models, const SearchOptions& options = {}) {
  return searchTrials(
      models, Settings(), someKnobs(), [&](const Trial& t) { return program(t); }, options);
}

bool has(const std::vector<Trial>& trials, const std::string& model, int directions, double tolerance) {
  return std::any_of(trials.begin(), trials.end(), [&](const Trial& t) {
    return t.model == model && t.settings.integer("predict.directions") == directions &&
           t.settings.number("predict.walk_tolerance") == tolerance && t.settings.text("fit.solver") == "refined" &&
           t.settings.number("predict.level_set_step") == 4.0;
  });
}

// By hand the front of model a is: tolerance 1e-4 with 12, 36 and 72 directions (30 us 15 %, 60 us 10 %, 120 us 5 %).
TEST(SearchTrials, FindsTheFrontOfOneModel) {
  Program program;
  const SearchResult r = search(program, {"a"});
  for (const int n : {12, 36, 72}) EXPECT_TRUE(has(r.finalists, "a", n, 1e-4)) << n;
  EXPECT_TRUE(has(r.finalists, "a", 36, 1e-10)) << "the base, for comparison";
  EXPECT_EQ(r.trials, program.calls);
}

TEST(SearchTrials, IsNoFullGrid) {
  Program program;
  search(program, {"a"});
  EXPECT_LT(program.calls, 3 * 3 * 2 * 2 / 2);
}

TEST(SearchTrials, CombinesTwoKnobsOfTheSlowModelToo) {
  Program program;
  const SearchResult r = search(program, {"a", "b"});
  EXPECT_TRUE(has(r.finalists, "b", 12, 1e-4));
  EXPECT_TRUE(has(r.finalists, "b", 72, 1e-4));
}

TEST(SearchTrials, SaysWhyEachWasGivenUp) {
  Program program;
  const SearchResult r = search(program, {"a", "hopeless"});
  const auto reasonOf = [&](const std::string& kind, const std::string& model) {
    for (const PrunedPoint& p : r.pruned)
      if (p.kind == kind && p.model == model) return p.reason;
    return std::string("none");
  };
  EXPECT_THAT(reasonOf("failed", "a"), HasSubstr("a hyperboloid"));
  EXPECT_THAT(reasonOf("no effect", "a"), HasSubstr("solver anchored"));
  EXPECT_THAT(reasonOf("not better", "a"), HasSubstr("level_set_step 8: 20 % at 200 us against 10 % at 100 us"));
  EXPECT_THAT(reasonOf("model dominated", "hopeless"), HasSubstr("90 % at 500 us against 10 % at 100 us with a"));
  EXPECT_EQ(
      std::count_if(program.seen.begin(), program.seen.end(), [](const std::string& s) { return s.rfind("hopeless", 0) == 0; }),
      1)
      << "no knob of a model that is beaten anyway";
  EXPECT_TRUE(has(r.finalists, "hopeless", 36, 1e-10)) << "its base is measured for comparison";
}

TEST(SearchTrials, ABaseThatFailsIsReplacedByASettingThatAnswers) {
  Program program;
  Settings base;
  base.setFromText("fit.solver", "linear");
  const SearchResult r = searchTrials({"a"}, base, someKnobs(), [&](const Trial& t) { return program(t); });
  ASSERT_FALSE(r.finalists.empty());
  for (const Trial& t : r.finalists) EXPECT_NE(t.settings.text("fit.solver"), "linear");
}

TEST(SearchTrials, NothingAnswers) {
  int calls = 0;
  const SearchResult r = searchTrials({"a", "b"}, Settings(), someKnobs(), [&](const Trial&) -> Outcome<TrialResult> {
    ++calls;
    return Failure{Reason::TooFewViews, ""};
  });
  EXPECT_TRUE(r.finalists.empty());
  EXPECT_EQ(r.pruned.size(), static_cast<std::size_t>(calls));
  for (const PrunedPoint& p : r.pruned) EXPECT_EQ(p.kind, "failed");
}

// Time that a knob of the fit seems to save is noise of the clock: it is tried alone and never combined.
TEST(SearchTrials, AFitIsCombinedForItsErrorAlone) {
  std::set<std::string> combined;
  const auto noisy = [&](const Trial& t) -> Outcome<TrialResult> {
    const int n = t.settings.integer("predict.directions");
    const bool anchored = t.settings.text("fit.solver") == "anchored";
    if (anchored && n != 36) combined.insert(std::to_string(n));
    return TrialResult{(n == 12 ? 20.0 : 10.0) * (anchored ? 0.995 : 1), (n == 12 ? 50.0 : 100.0) * (anchored ? 0.7 : 1),
                       std::to_string(n) + (anchored ? "a" : "")};
  };
  searchTrials({"a"}, Settings(),
               {{"fit.solver", {std::string("anchored"), std::string("refined")}}, {"predict.directions", {12, 36}}}, noisy);
  EXPECT_TRUE(combined.empty());
}

TEST(SearchTrials, KeepsItsLimits) {
  Program program;
  const SearchResult r = search(program, {"a", "b"}, {.maxTrials = 5, .maxFinalists = 2});
  EXPECT_EQ(program.calls, 5);
  EXPECT_TRUE(std::any_of(r.pruned.begin(), r.pruned.end(), [](const PrunedPoint& p) { return p.kind == "limit"; }));
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// The sentences of a report. Errors are put into the rows by hand, so that what must be said is known.
#include "core/report/evaluation_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/advise/diagnosis.h"
#include "core/report/report.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint::evaluation_words_tests {

using namespace testing_support;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

/// Frames 0 to 3 train; 4 to 8 are held out. Every model has found everything, with these errors in %.
Inspection runWith(const std::map<std::string, std::vector<double>>& errors) {
  InspectionRequest q;
  q.models = {"primal", "dual"};
  q.train = "first:4";
  Inspection run = inspect(exactScene(sheet(0), 9), q);
  for (auto& [name, model] : run.models)
    for (FrameComparison& c : model.frames) {
      EXPECT_EQ(c.rows.size(), 1u);
      if (run.isTraining(c.frame)) continue;
      c.rows.at(0).metrics->contourErrorPct = errors.at(name).at(std::size_t(c.frame - 4));
      c.rows[0].metrics->contourErrorPx = 0.1 * c.rows[0].metrics->contourErrorPct;
    }
  return run;
}

FrameComparison& heldOut(Inspection& run, const std::string& model, int frame) {
  for (FrameComparison& c : run.models.at(model).frames)
    if (c.frame == frame) return c;
  throw std::out_of_range("no such frame");
}

std::string joined(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& s : sentences) text += s + "\n";
  return text;
}

TEST(EvaluationWords, SayHowGoodTheBestIsAndWhichIsNext) {
  const EvaluationWords words = evaluationWords(runWith({{"primal", {2, 3, 4, 3, 3}}, {"dual", {0.5, 1.5, 1, 1, 1}}}), {});
  EXPECT_EQ(words.best, "dual");
  ASSERT_GE(words.inShort.size(), 2u);
  EXPECT_EQ(words.inShort[0],
            "dual predicts best: its contours are off by 1 % of a highlight's diameter on average (0.1 px), and by 1.5 % for the "
            "worst highlight. Of "
            "5 highlights in 5 held-out frames it found all, and it predicted none that is not there.");
  EXPECT_EQ(words.inShort[1], "The next is primal with 3 % on average.");
  EXPECT_THAT(words.inShort, Not(Contains(HasSubstr("No model is good")))) << "and nothing is wrong";
  EXPECT_THAT(words.inShort, Not(Contains(HasSubstr("glint diagnose"))));
  EXPECT_THAT(words.doubts, Contains(HasSubstr("flatters it")));
}

/// Differences 0.3, -0.1, 0.2, -0.2, 0.3: mean 0.1, standard deviation sqrt(0.22 / 4), standard error that over sqrt(5) =
/// 0.104881.
TEST(EvaluationWords, DoNotCallAnOrderByChanceABetterModel) {
  const Inspection run = runWith({{"primal", {1.3, 0.9, 1.2, 0.8, 1.3}}, {"dual", {1, 1, 1, 1, 1}}});
  const ErrorDifference d = errorDifference(run, "dual", "primal");
  EXPECT_EQ(d.highlights, 5);
  EXPECT_NEAR(d.meanPct, 0.1, 1e-12);
  EXPECT_NEAR(d.standardErrorPct, 0.10488088481701516, 1e-12);
  EXPECT_FALSE(d.isClear());
  EXPECT_THAT(joined(evaluationWords(run, {}).inShort), HasSubstr("does not tell which of the two is better"));
  // The same scatter a unit further up is clear.
  EXPECT_TRUE(
      errorDifference(runWith({{"primal", {2.3, 1.9, 2.2, 1.8, 2.3}}, {"dual", {1, 1, 1, 1, 1}}}), "dual", "primal").isClear());
}

TEST(EvaluationWords, DoNotPraiseADifferenceThatTheNumbersDoNotShow) {
  const EvaluationWords same =
      evaluationWords(runWith({{"primal", {1, 1, 1, 1, 1}}, {"dual", {1.0001, 1.0001, 1.0001, 1.0001, 1.0001}}}), {});
  EXPECT_EQ(same.best, "primal");
  EXPECT_THAT(joined(same.inShort), HasSubstr("The next is dual with 1 % on average, which is the same to three digits"));
  const EvaluationWords other =
      evaluationWords(runWith({{"primal", {1, 1, 1, 1, 1}}, {"dual", {1.01, 1.01, 1.01, 1.01, 1.01}}}), {});
  EXPECT_THAT(joined(other.inShort), Not(HasSubstr("the same to three digits")));
}

TEST(EvaluationWords, NameWhatTheBestMissedAndInvented) {
  Inspection run = runWith({{"primal", {22, 23, 24, 23, 23}}, {"dual", {1, 1, 1, 1, 1}}});
  FrameComparison::Row& missed = heldOut(run, "dual", 6).rows.at(0);
  missed.metrics.reset();
  missed.predicted = -1;
  heldOut(run, "dual", 8).rows.push_back({-1, 0, {}, {}, {}});
  const EvaluationWords words = evaluationWords(run, {});
  ASSERT_EQ(words.best, "dual");
  EXPECT_THAT(words.inShort[0], HasSubstr("it missed 1 (frame v6), and it predicted 1 that is not there (frame v8)."));
  EXPECT_THAT(words.inShort, Contains("No model is good here: even the best misses highlights."));
  EXPECT_THAT(words.inShort, Contains(HasSubstr("glint diagnose INPUT")));
  EXPECT_THAT(words.doubts, Contains(HasSubstr("over the 4 highlights that it found; the 1 that it missed are not in it")));
}

TEST(EvaluationWords, SayWhoGivesNoAnswerAndWhy) {
  Inspection run = runWith({{"primal", {2, 3, 4, 3, 3}}, {"dual", {1, 1, 1, 1, 1}}});
  for (const char* name : {"primal", "dual"}) {
    ModelResult& model = run.models.at(name);
    model.fits.at(0).fit = Failure{Reason::TooFewViews, "need 3, have 2"};
    for (FrameComparison& c : model.frames) {
      c.prediction = Prediction(Failure{Reason::TooFewViews, "need 3, have 2"});
      c.rows.at(0).metrics.reset();
      c.rows[0].predicted = -1;
    }
    const EvaluationWords words = evaluationWords(run, {});
    EXPECT_THAT(words.inShort,
                Contains(testing::AllOf(HasSubstr(std::string(name) + " gives no answer: "), HasSubstr("need 3, have 2"))));
    EXPECT_EQ(words.best, name == std::string("primal") ? "dual" : "");
  }
  const EvaluationWords none = evaluationWords(run, {});
  EXPECT_EQ(none.inShort.at(0), "No model predicted a highlight that was observed.");
  for (const std::string& s : none.inShort) EXPECT_THAT(s, Not(HasSubstr("nan")));
}

TEST(EvaluationWords, DoubtWhatStandsOnLittle) {
  Inspection run = runWith({{"primal", {2, 3, 4, 3, 3}}, {"dual", {1, 1, 1, 1, 7}}});
  EXPECT_THAT(evaluationWords(run, {}).doubts, Contains(HasSubstr("its error is 7 times the median of dual")));
  EXPECT_THAT(joined(evaluationWords(run, {}).doubts), Not(HasSubstr("Only ")));
  run.request.excluded = {4, 5};
  EXPECT_THAT(evaluationWords(run, {}).doubts, Contains("Only 3 highlights scored dual."));
  for (int f = 0; f < 9; ++f) run.request.excluded.push_back(f);
  EXPECT_THAT(evaluationWords(run, {}).doubts, Contains(HasSubstr("No frame is held out")));
}

TEST(EvaluationWords, AChoiceByTrainingFramesIsNotFlattered) {
  Inspection run = runWith({{"primal", {2, 3, 4, 3, 3}}, {"dual", {1, 1, 1, 1, 1}}});
  ReportContext context;
  context.chosenModel = "primal";
  context.whyChosen = "It is simple";
  context.selection = Selection{};
  const EvaluationWords words = evaluationWords(run, context);
  EXPECT_EQ(words.best, "primal");
  EXPECT_THAT(words.inShort, Contains("It was chosen from the training frames alone. It is simple."));
  EXPECT_THAT(joined(words.doubts), Not(HasSubstr("flatters it")));
}

/// The remarks of other models stand with them.
TEST(EvaluationWords, RemarksOfTheBestAreDoubts) {
  Inspection run = runWith({{"primal", {2, 3, 4, 3, 3}}, {"dual", {1, 1, 1, 1, 1}}});
  for (const char* name : {"primal", "dual"}) run.models.at(name).fits.at(0).fit->remarks = {std::string("remark of ") + name};
  const std::string doubts = joined(evaluationWords(run, {}).doubts);
  EXPECT_THAT(doubts, HasSubstr("remark of dual"));
  EXPECT_THAT(doubts, Not(HasSubstr("remark of primal")));
}

UnseenError errorOf(const std::vector<UnseenError::View>& views) {
  UnseenError e;
  e.views = views;
  return e;
}

/// Numbers have an arrow between them; words read as a sentence.
TEST(DiagnosisWords, EffectOfARemedy) {
  Remedy remedy;
  remedy.before = errorOf({{0, "light", 1, 0, 0, 20, 20}, {1, "light", 1, 1, 3, 10, 140}});
  remedy.after = errorOf({{0, "light", 1, 0, 0, 2, 2}, {1, "light", 2, 0, 0, 2.5, 2.5}});
  EXPECT_EQ(effectText(remedy), "15 %, 1 of 3 highlights missed, 3 spurious -> 1.5 %");
  remedy.before = errorOf({{0, "light", 0, 1, 0, 0, 100}});
  EXPECT_EQ(effectText(remedy), "no prediction before, 1.5 % after");
}

}  // namespace glint::evaluation_words_tests

// SPDX-License-Identifier: BSD-3-Clause
// One pipeline that is asked: what it remembers, from several threads, and what a stop leaves.
#include "core/pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "core/app/session.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {

using namespace testing_support;
using Part = Question::Part;

constexpr int kFrames = 12, kTraining = 4;

InspectionRequest pipelineRequest() {
  InspectionRequest q;
  q.models = {"limit-angle", "canonical"};
  q.train = "first:4";
  q.settings.set("fit.most_residual", 10.0);  // what is computed counts, not how good it is
  return q;
}

InspectionRequest with(const char* key, const char* value, InspectionRequest q = pipelineRequest()) {
  q.settings.setFromText(key, value);
  return q;
}

/// Detected, lights, fits, predictions.
std::vector<int> counts(const Pipeline& p) {
  const WorkCounts w = p.work();
  return {w.framesDetected, w.lights, w.fits, w.predictions};
}

TEST(Pipeline, AnAnswerIsRememberedAndNotComputedTwice) {
  Pipeline p(exactScene(sheet(0.3), kFrames));
  const Pipeline::Answer first = p.everything(pipelineRequest());
  EXPECT_EQ(counts(p), (std::vector<int>{kFrames, 1, 2, 2 * kFrames}));
  EXPECT_EQ(p.everything(pipelineRequest()), first);
  EXPECT_EQ(p.ask({pipelineRequest(), Part::Frame, 9}), first) << "it says all that one frame does";
  EXPECT_EQ(counts(p), (std::vector<int>{kFrames, 1, 2, 2 * kFrames}));
}

TEST(Pipeline, EachStageIsRememberedByItsOwnInputs) {
  Pipeline p(exactScene(sheet(0.3), kFrames));
  (void)p.everything(pipelineRequest());
  (void)p.everything(with("detect.min_area", "20"));
  EXPECT_EQ(counts(p), (std::vector<int>{2 * kFrames, 2, 4, 4 * kFrames}));
  // The newest answer has other evidence: that of the one before serves.
  const Pipeline::Answer light = p.everything(with("light.solver", "triangulated"));
  EXPECT_EQ(counts(p), (std::vector<int>{2 * kFrames, 3, 6, 6 * kFrames}));
  EXPECT_EQ(digestOf(*light), digestOf(inspect(p.scene(), with("light.solver", "triangulated"))));
  (void)p.everything(with("predict.level_set_step", "3", with("light.solver", "triangulated")));
  EXPECT_EQ(counts(p), (std::vector<int>{2 * kFrames, 3, 6, 8 * kFrames}));
}

TEST(Pipeline, WhatIsShownFirstLeavesOnlyTheRest) {
  Pipeline p(exactScene(sheet(0.3), kFrames));
  const Pipeline::Answer one = p.ask({pipelineRequest(), Part::Frame, 9});
  EXPECT_EQ(counts(p), (std::vector<int>{kTraining + 1, 1, 2, 2}));
  EXPECT_EQ(p.ask({pipelineRequest(), Part::Frame, 9}), one);
  const Pipeline::Answer all = p.everything(pipelineRequest());
  EXPECT_EQ(counts(p), (std::vector<int>{kFrames, 1, 2, 2 + 2 * kFrames}));
  EXPECT_EQ(digestOf(*all), digestOf(inspect(p.scene(), pipelineRequest())));
  EXPECT_EQ(p.known(pipelineRequest()), all);
  EXPECT_THROW((void)p.ask({pipelineRequest(), Part::Frame, kFrames}), std::invalid_argument);
}

TEST(Pipeline, ThreadsThatAskTheSameComputeItOnce) {
  Pipeline p(exactScene(sheet(0.3), kFrames));
  std::vector<Pipeline::Answer> answers(4);
  std::vector<std::thread> threads;
  for (Pipeline::Answer& a : answers) threads.emplace_back([&] { a = p.everything(pipelineRequest()); });
  for (std::thread& t : threads) t.join();
  for (const Pipeline::Answer& a : answers) EXPECT_EQ(a, answers[0]);
  EXPECT_EQ(counts(p), (std::vector<int>{kFrames, 1, 2, 2 * kFrames}));
}

TEST(Pipeline, ThreadsThatAskDifferentThingsGetTheirOwnAnswers) {
  const auto scene = exactScene(sheet(0.3), kFrames);
  Pipeline p(scene);
  std::vector<Pipeline::Answer> answers(4);
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] {
      answers[std::size_t(i)] =
          i < 2 ? p.ask({pipelineRequest(), Part::Frame, 8 + i}) : p.everything(with("light.robust_px", i == 2 ? "2" : "3"));
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(answers[0]->evidence[8].frame, 8);
  EXPECT_EQ(answers[1]->evidence[9].frame, 9);
  EXPECT_EQ(digestOf(*answers[2]), digestOf(inspect(scene, with("light.robust_px", "2"))));
  EXPECT_EQ(digestOf(*answers[3]), digestOf(inspect(scene, with("light.robust_px", "3"))));
}

TEST(Pipeline, AStopLeavesTheEvidence) {
  Pipeline p(exactScene(sheet(0.3), kFrames));
  EXPECT_THROW((void)p.everything(pipelineRequest(), [](const StageEvent& e) { return e.stage != "light"; }), Stopped);
  EXPECT_FALSE(p.known(pipelineRequest()));
  std::atomic<bool> detects{false};
  const Pipeline::Answer all = p.everything(pipelineRequest(), [&](const StageEvent& e) {
    detects = detects || e.stage == "detect";
    return true;
  });
  EXPECT_FALSE(detects);
  EXPECT_EQ(counts(p), (std::vector<int>{kFrames, 1, 2, 2 * kFrames}));
  EXPECT_EQ(digestOf(*all), digestOf(inspect(p.scene(), pipelineRequest())));
}

/// One that waits for another's answer may stop, and computes it itself where the other is stopped.
TEST(Pipeline, WhoWaitsStopsByItself) {
  Pipeline p(exactScene(sheet(0.3), kFrames));
  std::atomic<bool> holds{true}, isInside{false}, stopped{false};
  std::thread first([&] {
    try {
      (void)p.everything(pipelineRequest(), [&](const StageEvent& e) {
        if (e.stage != "light") return true;
        isInside = true;
        while (holds) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return false;
      });
    } catch (const Stopped&) {
      stopped = true;
    }
  });
  while (!isInside) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_THROW((void)p.everything(pipelineRequest(), [](const StageEvent&) { return false; }), Stopped);
  EXPECT_FALSE(stopped);
  Pipeline::Answer all;
  std::thread second([&] { all = p.everything(pipelineRequest()); });
  holds = false;
  first.join();
  second.join();
  EXPECT_TRUE(stopped);
  ASSERT_TRUE(all);
  EXPECT_EQ(counts(p), (std::vector<int>{kFrames, 1, 2, 2 * kFrames}));
}

TEST(Pipeline, ForgetsWhatNobodyWantsFirst) {
  Pipeline p(exactScene(sheet(0.3), kFrames));
  InspectionRequest q = pipelineRequest();
  const auto any = std::make_shared<const Inspection>(inspect(p.scene(), q));
  for (q.seed = 1; q.seed <= Pipeline::kMost + 2; ++q.seed) p.remember({q}, any);
  p.makeRoom([](const InspectionRequest& r) { return r.seed != 2; });
  for (q.seed = 1; q.seed <= Pipeline::kMost + 2; ++q.seed) EXPECT_EQ(p.known(q) != nullptr, q.seed > 2) << q.seed;
  p.remember({pipelineRequest()},
             std::make_shared<const Inspection>(inspect(exactScene(sheet(0.3), kFrames), pipelineRequest())));
  q.seed = pipelineRequest().seed;
  EXPECT_FALSE(p.known(q)) << "of another scene";
}

}  // namespace
}  // namespace glint

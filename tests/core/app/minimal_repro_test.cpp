// SPDX-License-Identifier: BSD-3-Clause
// The smallest set of frames that shows a fault: where its cause is known, and on a session that ships.
#include "core/app/minimal_repro.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "core/app/session.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::Contains;

fs::path emptyFolder(const std::string& name) {
  std::string pattern = (fs::path(testing::TempDir()) / "glint-XXXXXX").string();  // tests run beside each other
  const fs::path folder = fs::path(mkdtemp(pattern.data())) / name;
  return folder;
}

Fault errorOf(double pct) { return {0, "canonical", "lamp", pct, {}}; }
Fault failureOf(Reason reason) { return {0, "canonical", "lamp", {}, reason}; }

TEST(FaultText, LargeErrorsAreWholePercentsInGroups) {
  const auto text = [](double pct) {
    Fault fault;
    fault.errorPct = pct;
    return fault.text();
  };
  EXPECT_EQ(text(0.123456), "contour error 0.123 %");
  EXPECT_EQ(text(12.345), "contour error 12.3 %");
  EXPECT_EQ(text(99.96), "contour error 100 %");
  EXPECT_EQ(text(1127.3), "contour error 1,127 %");
  EXPECT_EQ(text(51321316), "contour error 51,321,316 %");
}

TEST(SameFault, ErrorsByTheirToleranceFailuresByTheirName) {
  const FaultTolerance within{FaultKept::Within, 0.2}, least{FaultKept::AtLeast, 0.2};
  EXPECT_TRUE(sameFault(errorOf(10), errorOf(8.1), within));
  EXPECT_FALSE(sameFault(errorOf(10), errorOf(7.9), within));
  EXPECT_TRUE(sameFault(errorOf(10), errorOf(11.9), within));
  EXPECT_FALSE(sameFault(errorOf(10), errorOf(12.1), within));
  EXPECT_TRUE(sameFault(errorOf(10), errorOf(500), least));
  EXPECT_FALSE(sameFault(errorOf(10), errorOf(7.9), least));
  EXPECT_TRUE(sameFault(failureOf(Reason::TooFewViews), failureOf(Reason::TooFewViews), within));
  EXPECT_FALSE(sameFault(failureOf(Reason::TooFewViews), failureOf(Reason::NotReached), within));
  EXPECT_FALSE(sameFault(errorOf(10), failureOf(Reason::NotReached), least));
  EXPECT_FALSE(sameFault(failureOf(Reason::NotReached), errorOf(10), least));
}

/// Exact contours, but for one frame that is moved: without it the error vanishes.
Inspection oneBadFrame(int bad) {
  const auto scene = testing_support::exactScene(testing_support::sphere(1.0), 10);
  for (Highlight& h : scene->frames[static_cast<std::size_t>(bad)].highlights) {
    for (Pixel& p : h.contour.points) p += Pixel(14, -9);
    h.peak += Pixel(14, -9);
  }
  InspectionRequest request;
  request.models = {"canonical"};
  request.train = "first:8";
  request.settings.set("fit.most_residual", 10.0);  // a fit that the bad frame spoils is the fault to keep
  return inspect(scene, request);
}

TEST(MinimalRepro, KeepsTheFrameThatCausesIt) {
  const Inspection run = oneBadFrame(3);
  const Outcome<Fault> fault = faultOf(run, 9, "canonical", "");
  ASSERT_TRUE(fault);
  ASSERT_TRUE(fault->errorPct);
  ASSERT_GT(*fault->errorPct, 0.5);  // exact frames alone give less than a hundredth of that
  const FaultTolerance least{FaultKept::AtLeast, 0.2};
  const Outcome<MinimalRepro> repro = minimalRepro(run, *fault, least);
  ASSERT_TRUE(repro) << repro.failure().message();
  EXPECT_THAT(repro->kept, Contains(3));
  EXPECT_LE(repro->kept.size(), 4u);  // the ellipsoid needs three views
  EXPECT_EQ(repro->of, 8);
  EXPECT_TRUE(sameFault(*fault, repro->after, least));

  const fs::path folder = emptyFolder("bad-frame");
  const WrittenRepro written = writeRepro(run, *repro, least, folder);
  EXPECT_TRUE(written.shows) << written.fault.text();
  ASSERT_TRUE(written.fault.errorPct);
  EXPECT_NEAR(*written.fault.errorPct, *repro->after.errorPct, 1e-6 * *repro->after.errorPct);
  const OpenedSession back = openSession(written.session);
  EXPECT_EQ(back.scene->frames.size(), repro->kept.size() + 1);
  EXPECT_EQ(back.session.view.frame, "v9");
  EXPECT_THAT(back.session.notes, testing::HasSubstr("frame v9"));
  EXPECT_TRUE(replay(back.session).differences.empty());
}

TEST(MinimalRepro, AFrameThatTrainsItselfStays) {
  const Inspection run = oneBadFrame(3);
  const Outcome<Fault> fault = faultOf(run, 3, "canonical", "lamp");
  ASSERT_TRUE(fault);
  const Outcome<MinimalRepro> repro = minimalRepro(run, *fault, {FaultKept::Within, 0.5});
  ASSERT_TRUE(repro) << repro.failure().message();
  EXPECT_THAT(repro->kept, Contains(3));
  EXPECT_LT(repro->kept.size(), 8u);
  const WrittenRepro written = writeRepro(run, *repro, {FaultKept::Within, 0.5}, emptyFolder("trains"));
  EXPECT_TRUE(written.shows) << written.fault.text();
}

TEST(MinimalRepro, ANamedFailureStaysThatFailure) {
  const auto scene = testing_support::exactScene(testing_support::sphere(1.0), 6);
  InspectionRequest request;
  request.models = {"canonical"};
  request.train = "first:2";  // a free centre needs three
  const Inspection run = inspect(scene, request);
  const Outcome<Fault> fault = faultOf(run, 4, "canonical", "lamp");
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->reason, Reason::TooFewViews);
  const Outcome<MinimalRepro> repro = minimalRepro(run, *fault, {});
  ASSERT_TRUE(repro);
  EXPECT_EQ(repro->after.reason, Reason::TooFewViews);
  EXPECT_LE(repro->kept.size(), 1u);
}

TEST(MinimalRepro, OfWhatIsNotThere) {
  const Inspection run = oneBadFrame(3);
  EXPECT_EQ(faultOf(run, 9, "dual", "").failure().reason, Reason::NotSupported);
  EXPECT_EQ(faultOf(run, 9, "canonical", "sun").failure().reason, Reason::NotSupported);
  Fault other = *faultOf(run, 9, "canonical", "");
  other.errorPct = 1e4;
  EXPECT_EQ(minimalRepro(run, other, {}).failure().reason, Reason::NotReached);
  const fs::path folder = emptyFolder("stopped-repro");
  const Outcome<Fault> fault = faultOf(run, 9, "canonical", "");
  EXPECT_THROW((void)minimalRepro(run, *fault, {}, [](const StageEvent&) { return false; }), Stopped);
  const Outcome<MinimalRepro> repro = minimalRepro(run, *fault, {FaultKept::AtLeast, 0.2});
  EXPECT_THROW(writeRepro(run, *repro, {}, folder, [](const StageEvent&) { return false; }), Stopped);
  EXPECT_FALSE(fs::exists(folder));
}

/// Noise is part of the contours that are kept, not something that a second reader adds once more.
TEST(MinimalRepro, NoiseOfTheRunIsInTheContoursOnce) {
  InspectionRequest request;
  request.models = {"canonical"};
  request.train = "first:6";
  request.noisePx = 0.8;
  request.seed = 3;
  const Inspection run = inspect(testing_support::exactScene(testing_support::sphere(1.0), 8), request);
  const Outcome<Fault> fault = faultOf(run, 7, "canonical", "");
  ASSERT_TRUE(fault && fault->errorPct);
  const Outcome<MinimalRepro> repro = minimalRepro(run, *fault, {FaultKept::Within, 0.3});
  ASSERT_TRUE(repro) << repro.failure().message();
  const fs::path folder = emptyFolder("noisy");
  const WrittenRepro written = writeRepro(run, *repro, {FaultKept::Within, 0.3}, folder);
  ASSERT_TRUE(written.fault.errorPct);
  EXPECT_NEAR(*written.fault.errorPct, *repro->after.errorPct, 1e-6 * *repro->after.errorPct);
  const OpenedSession back = openSession(written.session);
  EXPECT_EQ(back.session.request.noisePx, 0);
  for (std::size_t i = 0; i < repro->kept.size(); ++i)
    for (const TrainingView& v : run.views) {
      if (v.frame != repro->kept[i]) continue;
      ASSERT_EQ(back.scene->frames[i].highlights.size(), 1u);
      const std::vector<Pixel>& kept = back.scene->frames[i].highlights[0].contour.points;
      ASSERT_EQ(kept.size(), v.highlight.contour.points.size());
      for (std::size_t p = 0; p < kept.size(); ++p) EXPECT_LT((kept[p] - v.highlight.contour.points[p]).norm(), 1e-9);
    }
}

TEST(MinimalRepro, OfAShippedSessionReplays) {
  OpenedSession opened = openSession(fs::path(GLINT_SOURCE_DIR) / "sessions/vase/vase.glint");
  opened.session.request.models = {"limit-angle"};
  const Inspection run = inspect(opened.scene, opened.session.request);
  std::optional<Fault> worst;
  for (int f = 0; f < static_cast<int>(run.scene->frames.size()); ++f) {
    if (!run.isHeldOut(f)) continue;
    const Outcome<Fault> fault = faultOf(run, f, "limit-angle", "");
    if (fault && fault->errorPct && (!worst || *fault->errorPct > *worst->errorPct)) worst = *fault;
  }
  ASSERT_TRUE(worst);
  const Outcome<MinimalRepro> repro = minimalRepro(run, *worst, {});
  ASSERT_TRUE(repro) << repro.failure().message();
  EXPECT_LT(repro->kept.size(), static_cast<std::size_t>(repro->of));
  const fs::path folder = emptyFolder("vase-repro");
  const WrittenRepro written = writeRepro(run, *repro, {}, folder);
  EXPECT_TRUE(written.shows) << worst->text() << " became " << written.fault.text();
  EXPECT_TRUE(fs::exists(folder / "surface"));
  // It needs nothing else: the folder can move.
  const fs::path moved = emptyFolder("vase-moved");
  fs::rename(folder, moved);
  EXPECT_TRUE(replay(readSession(moved / "repro.glint")).differences.empty());
}

}  // namespace
}  // namespace glint

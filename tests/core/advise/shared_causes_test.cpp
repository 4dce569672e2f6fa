// SPDX-License-Identifier: BSD-3-Clause
// Rows by hand; chances from the closed form of the hypergeometric distribution.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "core/advise/highlight_evidence.h"

namespace glint {
namespace shared_causes_tests {

using testing::HasSubstr;
using testing::IsEmpty;

Inspection sequence(int frames) {
  auto scene = std::make_shared<Scene>();
  Inspection in;
  for (int i = 0; i < frames; ++i) {
    Frame f;
    f.id = "f" + std::to_string(i);
    f.surface = "ball";
    scene->frames.push_back(f);
    FrameEvidence e;
    e.frame = i;
    e.highlights.resize(1);
    in.evidence.push_back(e);
  }
  in.scene = in.given = scene;
  return in;
}

HighlightRow row(int frame, bool wrong, double incident) {
  HighlightRow r;
  r.frame = frame;
  r.observed = 0;
  r.model = "dual";
  r.light = "lamp";
  r.status = wrong ? RowStatus::Missed : RowStatus::Ok;
  r.values.fill(std::nan(""));
  r.values[std::size_t(RowValue::IncidentDeg)] = incident;
  return r;
}

/// 5 wrong and 20 right; of the wrong ones `high` are seen under more than 60 degrees, of the others `others`. Frames are mixed.
std::vector<HighlightRow> split(int high, int others) {
  std::vector<HighlightRow> rows;
  int right = 0;
  for (int i = 0; i < 25; ++i) {
    const bool wrong = i % 5 == 2;
    const bool isHigh = wrong ? i / 5 < high : right++ < others;
    rows.push_back(row(i, wrong, isHigh ? 65 + 0.1 * i : wrong ? 5 : 20 + i));
  }
  return rows;
}

TEST(SharedCauses, FourOfFiveAndNoneOfTwenty) {
  const Inspection in = sequence(25);
  const std::vector<SharedCause> causes = sharedCauses(in, split(4, 0), "dual");
  ASSERT_EQ(causes.size(), 1u);
  EXPECT_THAT(causes[0].text, HasSubstr("4 of 5 have an incident angle above "));
  EXPECT_THAT(causes[0].text, HasSubstr("; 0 of 20 others"));
  EXPECT_EQ(
      causes[0].text,
      "4 of 5 have an incident angle above 50\u00b0; 0 of 20 others");  // the number with the fewest digits between 44 and 65.2
  EXPECT_EQ(causes[0].highlights.size(), 4u);
  EXPECT_NEAR(causes[0].chance, 5.0 / 12650, 1e-12);  // C(5,4) C(20,0) / C(25,4)
}

TEST(SharedCauses, LowNumbersAreSharedToo) {
  std::vector<HighlightRow> rows = split(4, 0);
  for (HighlightRow& r : rows) r.values[std::size_t(RowValue::IncidentDeg)] = 90 - r.value(RowValue::IncidentDeg);
  const std::vector<SharedCause> causes = sharedCauses(sequence(25), rows, "dual");
  ASSERT_EQ(causes.size(), 1u);
  EXPECT_THAT(causes[0].text, testing::StartsWith("4 of 5 have an incident angle up to "));
  EXPECT_THAT(causes[0].text, HasSubstr("; 0 of 20 others"));
  EXPECT_EQ(causes[0].highlights.size(), 4u);
}

TEST(SharedCauses, WeakSplitsAreNotSaid) {
  const Inspection in = sequence(25);
  EXPECT_THAT(sharedCauses(in, split(3, 0), "dual"), IsEmpty()) << "three of five are not most";
  EXPECT_THAT(sharedCauses(in, split(4, 3), "dual"), IsEmpty()) << "three of twenty others are some";
  EXPECT_THAT(sharedCauses(in, split(5, 0), "another"), IsEmpty());
  // Three of three against sixteen: 1 / C(19, 3) = 1 / 969, above 0.001; against seventeen 1 / 1140.
  for (const int others : {16, 17}) {
    std::vector<HighlightRow> rows;
    for (int i = 0; i < others + 3; ++i) rows.push_back(row((7 * i) % (others + 3), i < 3, i < 3 ? 70 + i : 10 + i));
    EXPECT_EQ(sharedCauses(sequence(others + 3), rows, "dual").size(), others == 17 ? 1u : 0u) << others;
  }
  std::vector<HighlightRow> two{row(0, true, 80), row(1, true, 80)};
  for (int i = 2; i < 100; ++i) two.push_back(row(i, false, 20));
  EXPECT_THAT(sharedCauses(sequence(100), two, "dual"), IsEmpty()) << "two are too few, whatever the chance";
}

TEST(SharedCauses, WhatIsNotKnownIsCountedAndExcludedFramesAreNot) {
  const Inspection in = sequence(40);
  std::vector<HighlightRow> rows = split(5, 0);
  rows.push_back(row(25, true, std::nan("")));
  rows.push_back(row(26, false, 80));
  rows.back().role = RowRole::Excluded;
  const std::vector<SharedCause> causes = sharedCauses(in, rows, "dual");
  ASSERT_FALSE(causes.empty());
  EXPECT_THAT(causes[0].text, HasSubstr("5 of 5 have an incident angle above 50\u00b0; 0 of 20 others (unknown for 1 more)"));
}

TEST(SharedCauses, ThingsThatAreThereOrNot) {
  Inspection in = sequence(25);
  std::vector<HighlightRow> rows = split(0, 0);
  for (HighlightRow& r : rows) {
    r.values.fill(std::nan(""));
    in.evidence[std::size_t(r.frame)].highlights[0].touchesBorder = r.status != RowStatus::Ok;
  }
  const std::vector<SharedCause> causes = sharedCauses(in, rows, "dual");
  ASSERT_EQ(causes.size(), 1u);
  EXPECT_EQ(causes[0].text, "5 of 5 are cut by the image's border; 0 of 20 others");
  EXPECT_NEAR(causes[0].chance, 1.0 / 53130, 1e-12);  // 1 / C(25, 5)
}

/// Ten wrong ones that all are cut by the border, and sixty right ones: the chance is below 1e-6 with six of them and with seven.
TEST(SharedCauses, WhatMoreThanATenthOfTheOthersHaveTooIsNotSaid) {
  for (const int others : {6, 7}) {
    Inspection in = sequence(70);
    std::vector<HighlightRow> rows;
    for (int i = 0; i < 70; ++i) {
      rows.push_back(row(i, i < 10, std::nan("")));
      in.evidence[std::size_t(i)].highlights[0].touchesBorder = i < 10 + others;
    }
    EXPECT_EQ(sharedCauses(in, rows, "dual").size(), others == 6 ? 1u : 0u) << others;
  }
}

/// Numbers that have nothing to do with what is wrong seldom look as if they had.
TEST(SharedCauses, ChanceSeldomLooksLikeACause) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0, 1);
  int said = 0;
  constexpr int kRuns = 2000;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<HighlightRow> rows;
    for (int i = 0; i < 40; ++i) {
      rows.push_back(row(i, any(random) < 0.2, 80 * any(random)));
      for (const RowValue v : {RowValue::ObservedPx, RowValue::PeakRadiance, RowValue::ObservedLimitDeg, RowValue::Frame})
        rows.back().values[std::size_t(v)] = v == RowValue::Frame ? i : any(random);
    }
    said += !sharedCauses(sequence(40), rows, "dual").empty();
  }
  RecordProperty("said", said);
  EXPECT_LT(said, kRuns / 50) << "in 2 % of the runs or fewer";
}

}  // namespace shared_causes_tests
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// Shards as text and as ranges. Expected ranges follow from their definition: equal parts, in order, of everything once.
#include "core/base/shard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "core/base/outcome.h"

namespace glint::shard_tests {

using testing::HasSubstr;

std::string refusalOf(const std::string& text) {
  try {
    parseShard(text, "--shard");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ParseShard, TheSecondOfEight) {
  EXPECT_EQ(parseShard("2/8", "--shard"), (Shard{2, 8}));
  EXPECT_EQ(parseShard("1/1", "--shard"), (Shard{1, 1}));
  EXPECT_EQ(parseShard("10000/10000", "--shard"), (Shard{10000, 10000}));
  EXPECT_EQ(parseShard("2/8", "--shard").text(), "2/8");
}

TEST(ParseShard, AnythingElseIsRefusedWithFlagAndText) {
  for (const std::string& text : {std::string(""),
                                  std::string("2"),
                                  std::string("/"),
                                  std::string("2/"),
                                  std::string("/8"),
                                  std::string("2/8/9"),
                                  std::string(" 2/8"),
                                  std::string("2/8 "),
                                  std::string("2 /8"),
                                  std::string("+2/8"),
                                  std::string("2/+8"),
                                  std::string("-2/8"),
                                  std::string("2/-8"),
                                  std::string("2.0/8"),
                                  std::string("2e0/8"),
                                  std::string("0x2/8"),
                                  std::string("two/8"),
                                  std::string("2,8"),
                                  std::string("2\\8"),
                                  std::string("99999999999999999999/8"),
                                  std::string("1/99999999999999999999"),
                                  std::string("2147483648/8"),
                                  std::string("\u0662/8"),
                                  std::string(100000, '7')})
    EXPECT_THAT(refusalOf(text), testing::AllOf(HasSubstr("--shard"), HasSubstr("expected i/n"))) << text.substr(0, 40);
  const std::string nul(1, '\0');
  for (const std::string& text : {"2" + nul + "/8", "2/8" + nul}) EXPECT_NE(refusalOf(text), "");
}

TEST(ParseShard, NumbersOutOfRangeAreRefusedWithTheRange) {
  for (const char* text : {"1/0", "0/0", "1/10001", "1/2147483647"})
    EXPECT_THAT(refusalOf(text), HasSubstr("between 1 and 10000")) << text;
  for (const char* text : {"0/8", "9/8", "2147483647/8"}) EXPECT_THAT(refusalOf(text), HasSubstr("numbered from 1 to 8")) << text;
}

TEST(RangeOf, TenInThreePartsByHand) {
  EXPECT_EQ(rangeOf({1, 3}, 10), std::pair(0, 3));
  EXPECT_EQ(rangeOf({2, 3}, 10), std::pair(3, 6));
  EXPECT_EQ(rangeOf({3, 3}, 10), std::pair(6, 10));
}

TEST(RangeOf, EverythingOnceInOrderInEqualParts) {
  for (int of : {1, 2, 3, 7, 8, 100, 9999, kMostShards})
    for (int count : {0, 1, 2, 7, 8, 9, 24, 1000, 12345}) {
      int next = 0;
      for (int index = 1; index <= of; ++index) {
        const auto [first, end] = rangeOf({index, of}, count);
        ASSERT_EQ(first, next) << index << "/" << of << " of " << count;
        ASSERT_GE(end - first, count / of);
        ASSERT_LE(end - first, (count + of - 1) / of);
        next = end;
      }
      EXPECT_EQ(next, count);
    }
}

TEST(RangeOf, FewerThingsThanShardsLeaveShardsEmpty) {
  int empty = 0;
  for (int index = 1; index <= 8; ++index) {
    const auto [first, end] = rangeOf({index, 8}, 3);
    empty += first == end;
  }
  EXPECT_EQ(empty, 5);
}

// A product of 32 bits would overflow here from the second shard on.
TEST(RangeOf, TheLargestCounts) {
  constexpr int kMost = std::numeric_limits<int>::max();
  EXPECT_EQ(rangeOf({kMostShards, kMostShards}, kMost).second, kMost);
  EXPECT_EQ(rangeOf({5000, 10000}, kMost), std::pair(1073527075, 1073741823));  // floor(n 4999 / 10000), floor(n / 2)
}

TEST(RangeOf, WhatIsNoShardIsTheCallersBug) {
  for (const Shard& shard : {Shard{0, 8}, Shard{9, 8}, Shard{1, 0}, Shard{-1, -1}})
    EXPECT_THROW(rangeOf(shard, 10), std::invalid_argument) << shard.text();
  EXPECT_THROW(rangeOf({1, 1}, -1), std::invalid_argument);
}

}  // namespace glint::shard_tests

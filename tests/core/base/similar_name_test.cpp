// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/base/words.h"

namespace glint::similar_name_tests {
namespace {

const std::vector<std::string> kModels{"primal", "dual", "canonical", "limit-angle", "reflectance"};

TEST(EditDistance, IsThatOfTheTextbooks) {
  EXPECT_EQ(editDistance("kitten", "sitting"), 3);  // Levenshtein's example: two replaced, one inserted
  EXPECT_EQ(editDistance("saturday", "sunday"), 3);
  EXPECT_EQ(editDistance("form", "from"), 1);  // neighbours swapped: 2 for Levenshtein
  EXPECT_EQ(editDistance("ca", "abc"), 3);     // no part is edited twice: 2 where that were allowed
  EXPECT_EQ(editDistance("", "abc"), 3);
  EXPECT_EQ(editDistance("abc", ""), 3);
  EXPECT_EQ(editDistance("same", "same"), 0);
}

TEST(EditDistance, IsTheSameInBothDirections) {
  for (const std::string& a : kModels)
    for (const std::string& b : kModels) EXPECT_EQ(editDistance(a, b), editDistance(b, a)) << a << " " << b;
}

TEST(SimilarName, FindsWhatWasMeant) {
  EXPECT_EQ(similarName("canonicl", kModels), "canonical");
  EXPECT_EQ(similarName("priaml", kModels), "primal");
  EXPECT_EQ(similarName("limitangle", kModels), "limit-angle");
  EXPECT_EQ(didYouMean("dualk", kModels), "; did you mean 'dual'?");
}

TEST(SimilarName, GuessesNothingFarOff) {
  for (const char* given : {"bogus", "", "x", "ellipsoid", "limit"}) EXPECT_EQ(similarName(given, kModels), "") << given;
  EXPECT_EQ(didYouMean("bogus", kModels), "");
  EXPECT_EQ(similarName("dual", {}), "");
  EXPECT_EQ(similarName(std::string(101, 'a'), {std::string(100, 'a')}), "");  // nobody types that
}

TEST(SimilarName, OfEquallyNearOnesTheFirst) { EXPECT_EQ(similarName("bat", {"cat", "hat"}), "cat"); }

}  // namespace
}  // namespace glint::similar_name_tests

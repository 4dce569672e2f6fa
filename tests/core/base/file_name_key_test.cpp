// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/base/found_file.h"

namespace glint::file_name_key_tests {
namespace {

// Pairs as Python's unicodedata.normalize("NFC" and "NFD", ...) writes them.
TEST(FileNameKey, BothFormsOfUnicodeAreOneName) {
  EXPECT_EQ(fileNameKey("\xC3\xA9.png"), fileNameKey("e\xCC\x81.png"));                         // e with an acute accent
  EXPECT_EQ(fileNameKey("\xE1\xBB\x87"), fileNameKey("e\xCC\xA3\xCC\x82"));                     // Vietnamese: two marks
  EXPECT_EQ(fileNameKey("\xED\x95\x9C"), fileNameKey("\xE1\x84\x92\xE1\x85\xA1\xE1\x86\xAB"));  // Hangul
  EXPECT_EQ(fileNameKey("\xE3\x81\x8C"), fileNameKey("\xE3\x81\x8B\xE3\x82\x99"));              // Kana with a voiced mark
  EXPECT_NE(fileNameKey("\xC3\xA9.png"), fileNameKey("e.png"));
}

TEST(FileNameKey, CapitalsAreSmall) {
  EXPECT_EQ(fileNameKey("IMG_1.PNG"), fileNameKey("img_1.png"));
  EXPECT_EQ(fileNameKey("\xC3\x84"), fileNameKey("\xC3\xA4"));  // A with a diaeresis
  EXPECT_EQ(fileNameKey("\xD0\x9F"), fileNameKey("\xD0\xBF"));  // Cyrillic
  EXPECT_NE(fileNameKey("a_1"), fileNameKey("a-1"));
}

TEST(FileNameKey, BytesThatAreNoUtf8StandForThemselves) {
  EXPECT_NE(fileNameKey("\xE9"), fileNameKey("\xE8"));
  EXPECT_NE(fileNameKey("\xE9"), fileNameKey("\xC3\xA9"));
  EXPECT_EQ(fileNameKey("\xED\x95").size(), 2u);  // cut off
}

}  // namespace
}  // namespace glint::file_name_key_tests

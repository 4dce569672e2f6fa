// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/csv_text.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

TEST(CsvText, WhatASpreadsheetWouldComputeIsText) {
  for (const char* formula : {"=cmd|' /C calc'!A0", "+1+1", "-2+3+cmd|' /C calc'!A0", "@SUM(A1)", "\tx", "\rx", "=1", " =1",
                              "  @SUM(A1)", "\xE2\x80\x8B=1", "--1",
                              "\xEF\xBC\x9D"
                              "1+1"}) {
    EXPECT_EQ(withoutFormula(formula), std::string("'") + formula);
    EXPECT_EQ(csvText(formula, CsvQuotes::Always).substr(0, 2), "\"'");
  }
}

TEST(CsvText, NumbersAndOtherTextStay) {
  for (const char* text : {"", "-", "0", "-1.5", "+2", "-1e-3", "0003", "a=b", "x-y", "frame 4", " -1.5", " a", "  ", "'quoted'"})
    EXPECT_EQ(withoutFormula(text), text);
}

TEST(CsvText, SeparatorsAreQuoted) {
  EXPECT_EQ(csvText("a,b"), "\"a,b\"");
  EXPECT_EQ(csvText("a \"b\""), "\"a \"\"b\"\"\"");
  EXPECT_EQ(csvText("a\nb"), "\"a\nb\"");
  EXPECT_EQ(csvText("a\rb"), "\"a\rb\"");
  EXPECT_EQ(csvText("=1,2"), "\"'=1,2\"");
  EXPECT_EQ(csvText("plain"), "plain");
}

}  // namespace
}  // namespace glint

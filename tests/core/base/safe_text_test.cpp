// SPDX-License-Identifier: BSD-3-Clause
// Hostile text on a screen and in file names. Expected values follow from RFC 3629 and the list of control characters in ECMA-48.
#include "core/base/safe_text.h"

#include <gtest/gtest.h>

#include <set>

namespace glint {
namespace {

TEST(WithoutControls, PlainTextStays) {
  EXPECT_EQ(withoutControls("a frame, 0.5 px\n\tLämpchen 灯 é"), "a frame, 0.5 px\n\tLämpchen 灯 é");
}

TEST(WithoutControls, TerminalEscapesAreShown) {
  EXPECT_EQ(withoutControls("\x1b[31mred"), "\\x1B[31mred");
  EXPECT_EQ(withoutControls("bell\a, back\b, return\r"), "bell\\x07, back\\x08, return\\x0D");
  EXPECT_EQ(withoutControls(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(withoutControls("\xC2\x9B" "31m"), "\\x9B31m");                  // the same escape as one character (C1)
  EXPECT_EQ(withoutControls("exe.\xE2\x80\xAEgnp"), "exe.\\u202Egnp");       // right to left
}

TEST(WithoutControls, BytesThatAreNoTextAreShown) {
  EXPECT_EQ(withoutControls("a\xFF" "b"), "a\\xFFb");
  EXPECT_EQ(withoutControls("\xC0\xAF"), "\\xC0\\xAF");                      // '/' in a longer form than needed
  EXPECT_EQ(withoutControls("\xED\xA0\x80"), "\\xED\\xA0\\x80");             // a surrogate
  EXPECT_EQ(withoutControls("\xF4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80");    // beyond U+10FFFF
  EXPECT_EQ(withoutControls("cut \xE7\x81"), "cut \\xE7\\x81");
}

TEST(MessageLine, IsOneLine) { EXPECT_EQ(messageLine("first\nsecond\tthird \n"), "first second third"); }

TEST(MessageLine, ALongPathKeepsItsEndsAndTheReasonStays) {
  const std::string line = messageLine("/data/" + std::string(4000, 'x') + "/scene.json: frames[3]: is missing");
  EXPECT_LE(line.size(), 400u);
  EXPECT_EQ(line.rfind("/data/xxx", 0), 0u);
  EXPECT_NE(line.find("x/scene.json: frames[3]: is missing"), std::string::npos) << line;
}

TEST(MessageLine, ALongSentenceKeepsItsEnds) {
  std::string words;
  for (int i = 0; i < 500; ++i) words += "灯灯 ";
  const std::string line = messageLine("begin " + words + "end");
  EXPECT_LE(line.size() + std::string("glint: warning: ").size(), 400u) << "with what stands before it on the terminal";
  EXPECT_GT(line.size(), 360u);
  EXPECT_EQ(line.rfind("begin ", 0), 0u);
  EXPECT_EQ(line.substr(line.size() - 4), " end");
  EXPECT_EQ(withoutControls(line), line) << "a character was cut";
}

TEST(FileName, PlainIdsStay) {
  for (const char* id : {"0003", "IMG_2041", "left-0.5", "Lämpchen 灯", "-x"}) EXPECT_EQ(fileNameOf(id), id);
}

TEST(FileName, NothingLeavesTheFolder) {
  EXPECT_EQ(fileNameOf("../../x"), "%2E%2E%2F%2E%2E%2Fx");
  EXPECT_EQ(fileNameOf("/etc/passwd"), "%2Fetc%2Fpasswd");
  EXPECT_EQ(fileNameOf("a\\b"), "a%5Cb");
  EXPECT_EQ(fileNameOf(".."), "%2E%2E");
  EXPECT_EQ(fileNameOf("."), "%2E");
  EXPECT_EQ(fileNameOf(".hidden"), "%2Ehidden");
  EXPECT_EQ(fileNameOf("a\nb"), "a%0Ab");
  EXPECT_EQ(fileNameOf(""), "%");
}

TEST(FileName, DifferentIdsHaveDifferentNames) {
  const std::string longId(500, 'x');
  const std::set<std::string> names{fileNameOf("a/b"), fileNameOf("a%2Fb"), fileNameOf("a%b"), fileNameOf("ab"),
                                    fileNameOf(longId + "1"), fileNameOf(longId + "2")};
  EXPECT_EQ(names.size(), 6u);
  for (const std::string& name : names) EXPECT_LE(name.size(), 200u);
}

}  // namespace
}  // namespace glint

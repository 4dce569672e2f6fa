// SPDX-License-Identifier: BSD-3-Clause
// Hostile text on a screen and in file names. Expected values follow from RFC 3629 and the list of control characters in ECMA-48.
#include "core/base/safe_text.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <string>

#include "core/base/words.h"

namespace glint {
namespace {

TEST(WithoutControls, PlainTextStays) {
  EXPECT_EQ(withoutControls("a frame, 0.5 px\n\tLämpchen 灯 é"), "a frame, 0.5 px\n\tLämpchen 灯 é");
}

TEST(WithoutControls, TerminalEscapesAreShown) {
  EXPECT_EQ(withoutControls("\x1b[31mred"), "\\x1B[31mred");
  EXPECT_EQ(withoutControls("bell\a, back\b, return\r"), "bell\\x07, back\\x08, return\\x0D");
  EXPECT_EQ(withoutControls(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(withoutControls("\xC2\x9B"
                            "31m"),
            "\\x9B31m");                                                // the same escape as one character (C1)
  EXPECT_EQ(withoutControls("exe.\xE2\x80\xAEgnp"), "exe.\\u202Egnp");  // right to left
}

TEST(WithoutControls, BytesThatAreNoTextAreShown) {
  EXPECT_EQ(withoutControls("a\xFF"
                            "b"),
            "a\\xFFb");
  EXPECT_EQ(withoutControls("\xC0\xAF"), "\\xC0\\xAF");                    // '/' in a longer form than needed
  EXPECT_EQ(withoutControls("\xED\xA0\x80"), "\\xED\\xA0\\x80");           // a surrogate
  EXPECT_EQ(withoutControls("\xF4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80");  // beyond U+10FFFF
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

TEST(FileName, ControlsAreEscapedInUtf8) {
  // The first and the last of each row of controls, in UTF-8; beside them, what stays.
  EXPECT_EQ(fileNameOf("x\xC2\x80y\xC2\x9F"), "x%C2%80y%C2%9F");                // C1: U+0080, U+009F
  EXPECT_EQ(fileNameOf("x\xE2\x80\x8Ey\xE2\x80\x8F"), "x%E2%80%8Ey%E2%80%8F");  // U+200E, U+200F
  EXPECT_EQ(fileNameOf("x\xE2\x80\xAAy\xE2\x80\xAE"), "x%E2%80%AAy%E2%80%AE");  // U+202A, U+202E
  EXPECT_EQ(fileNameOf("x\xE2\x81\xA6y\xE2\x81\xA9"), "x%E2%81%A6y%E2%81%A9");  // U+2066, U+2069
  EXPECT_EQ(fileNameOf("x\xD8\x9C"), "x%D8%9C");                                // U+061C
  EXPECT_EQ(fileNameOf("x\ty\x7F"), "x%09y%7F");
  EXPECT_EQ(fileNameOf("\xC2\xA0\xE2\x80\x8D\xE2\x81\xAA"), "\xC2\xA0\xE2\x80\x8D\xE2\x81\xAA");  // U+00A0, U+200D, U+206A
  EXPECT_EQ(fileNameOf("x\xFFy\xE2\x80"), "x%FFy%E2%80");                                         // not UTF-8
}

TEST(FileName, WhatIsShownEscapedIsEscapedInNamesToo) {
  for (std::uint32_t c = 0x80; c < 0x3000; ++c) {
    const std::string text = c < 0x800 ? std::string{char(0xC0 | c >> 6), char(0x80 | (c & 0x3F))}
                                       : std::string{char(0xE0 | c >> 12), char(0x80 | (c >> 6 & 0x3F)), char(0x80 | (c & 0x3F))};
    EXPECT_EQ(fileNameOf(text) == text, withoutControls(text) == text) << std::hex << c;
  }
}

TEST(CopyName, TheExtensionIsSafeToo) {
  EXPECT_EQ(copyNameOf("/data/b.ply"), "b.ply");
  EXPECT_EQ(copyNameOf("b.ply", 2), "b-2.ply");
  EXPECT_EQ(copyNameOf("b", 3), "b-3");
  EXPECT_EQ(copyNameOf("b.tar.gz", 2), "b.tar-2.gz");
  EXPECT_EQ(copyNameOf("b.p\n\x1b[31mly"), "b.p%0A%1B[31mly");
  EXPECT_EQ(copyNameOf("b.p\n\x1b[31mly", 2), "b.p%0A%1B[31mly-2");
  EXPECT_EQ(copyNameOf(".ply"), "%2Eply");
  EXPECT_EQ(copyNameOf("b."), "b.");
  EXPECT_LE(copyNameOf("b." + std::string(250, '\n'), 2).size(), 255u);
  EXPECT_LE(copyNameOf("b." + std::string(250, 'x'), 2).size(), 255u);
}

TEST(FileName, DifferentIdsHaveDifferentNames) {
  const std::string longId(500, 'x');
  const std::set<std::string> names{fileNameOf("a/b"), fileNameOf("a%2Fb"),      fileNameOf("a%b"),
                                    fileNameOf("ab"),  fileNameOf(longId + "1"), fileNameOf(longId + "2")};
  EXPECT_EQ(names.size(), 6u);
  for (const std::string& name : names) EXPECT_LE(name.size(), 200u);
}

/// As one would say it: nobody says "light light", but "light lighthouse" names another thing than a lighthouse.
TEST(LightName, SaysTheWordOnce) {
  for (const char* id : {"light", "Light", "LIGHT", "light2", "light_left", "Light 3", "light@bowl"})
    EXPECT_EQ(lightName(id), id);
  EXPECT_EQ(lightName("3"), "light 3");
  EXPECT_EQ(lightName("lamp"), "light lamp");
  EXPECT_EQ(lightName("lights"), "light lights");
  EXPECT_EQ(lightName("lighthouse"), "light lighthouse");
  EXPECT_EQ(lightName("key light"), "light key light");
  EXPECT_EQ(lightName("ligh"), "light ligh");
}

}  // namespace
}  // namespace glint

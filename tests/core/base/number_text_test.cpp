// SPDX-License-Identifier: BSD-3-Clause
// Numbers as text never depend on the locale. The locale with a decimal comma is the project's own build of it (tests/locale).
#include "core/base/number_text.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cstdio>
#include <string>
#include <thread>

namespace glint {
namespace {

/// The process under a decimal comma, while it lives.
class CommaLocale {
 public:
  CommaLocale() : before_(std::setlocale(LC_ALL, nullptr)), set_(std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr) {}
  ~CommaLocale() { std::setlocale(LC_ALL, before_.c_str()); }
  bool set() const { return set_; }

 private:
  std::string before_;
  bool set_;
};

TEST(NumberText, HasAPointUnderADecimalComma) {
  const CommaLocale comma;
  ASSERT_TRUE(comma.set()) << "the build makes this locale (tests/locale); LOCPATH names its folder";
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", 1234.5);
  ASSERT_STREQ(text, "1234,50") << "the locale is not at work, so that this test would show nothing";
  EXPECT_EQ(formatted("%.2f|%g|%s|%d", 1234.5, -2.5e-7, "a,b", 7), "1234.50|-2.5e-07|a,b|7");
  std::snprintf(text, sizeof text, "%.1f", 0.5);
  EXPECT_STREQ(text, "0,5") << "the thread's locale must be what it was";
}

TEST(NumberText, HasAPointInEveryThread) {
  const CommaLocale comma;
  ASSERT_TRUE(comma.set());
  std::string seen[4];
  std::thread threads[4];
  for (int t = 0; t < 4; ++t)
    threads[t] = std::thread([&seen, t] {
      for (int i = 0; i < 1000; ++i) seen[t] = formatted("%.3f", t + 0.125);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(seen[0], "0.125");
  EXPECT_EQ(seen[3], "3.125");
}

TEST(NumberText, ReadsThePointAndNothingElse) {
  const CommaLocale comma;
  ASSERT_TRUE(comma.set());
  EXPECT_EQ(numberFrom("0.5"), 0.5);
  EXPECT_EQ(numberFrom("+2"), 2.0);
  EXPECT_EQ(numberFrom("-1e-3"), -0.001);
  for (const char* text : {"", "0,5", " 1", "1 ", "1x", "nan", "inf", "-inf", "1e999", "+-1", "++1", "0x10", "1.2.3", "+"})
    EXPECT_FALSE(numberFrom(text)) << '"' << text << '"';
}

TEST(NumberText, WritesTextOfAnyLength) {
  for (const std::size_t length : {0u, 1u, 254u, 255u, 256u, 257u, 5000u}) {
    const std::string name(length, 'x');
    EXPECT_EQ(formatted("%s|%d", name.c_str(), 7), name + "|7") << length;
  }
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// The typeset equations on record are those of their source text: docs/make_equations.py was run after the last change.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "tests/core/scene/scene_fixture.h"

namespace glint::equations_tests {
namespace {

using testing_support::contentOf;

const std::filesystem::path kExplain = GLINT_SOURCE_DIR "/resources/explain";

const nlohmann::json& source() {
  static const nlohmann::json read = nlohmann::json::parse(contentOf(kExplain / "equations.json"));
  return read;
}

std::string svgOf(const nlohmann::json& equation) {
  return contentOf(kExplain / "equations" / (equation["id"].get<std::string>() + ".svg"));
}

std::string escaped(std::string text) {
  for (const auto& [from, to] : {std::pair("&", "&amp;"), std::pair("<", "&lt;"), std::pair(">", "&gt;")})
    text = std::regex_replace(text, std::regex(from), to);
  return text;
}

std::string within(const std::string& svg, const std::string& tag) {
  const std::size_t from = svg.find('<' + tag + '>'), to = svg.find("</" + tag + '>');
  return from == std::string::npos || to == std::string::npos ? std::string()
                                                              : svg.substr(from + tag.size() + 2, to - from - tag.size() - 2);
}

/// How often each pattern's first group occurs.
std::map<std::string, int> countsOf(const std::string& text, const char* pattern) {
  std::map<std::string, int> counts;
  const std::regex searched(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), searched), end; it != end; ++it) ++counts[(*it)[1]];
  return counts;
}

TEST(Equations, EveryEquationOfTheStepsIsTypeset) {
  std::set<std::string> plain;
  for (const auto& equation : source()["equations"]) EXPECT_TRUE(plain.insert(equation["plain"]).second) << equation["plain"];
  const nlohmann::json steps = nlohmann::json::parse(contentOf(kExplain / "steps.json"));
  const std::string lessons = nlohmann::json::parse(contentOf(kExplain / "lessons.json")).dump(-1, ' ', false);
  std::set<std::string> used;
  for (const auto& step : steps["steps"]) {
    used.insert(step["equation"].get<std::string>());
    if (!step.contains("models")) continue;
    for (const auto& words : step["models"])
      if (words.contains("equation")) used.insert(words["equation"].get<std::string>());
  }
  for (const std::string& equation : used) EXPECT_EQ(plain.count(equation), 1U) << equation;
  for (const std::string& equation : plain)
    EXPECT_TRUE(used.count(equation) > 0 || lessons.find(equation) != std::string::npos) << "nothing shows " << equation;
}

TEST(Equations, ThePicturesAreThoseOfTheSourceText) {
  std::set<std::string> expected, found;
  for (const auto& equation : source()["equations"]) {
    const std::string svg = svgOf(equation);
    expected.insert(equation["id"].get<std::string>() + ".svg");
    std::string tex;
    for (const auto& line : equation["tex"]) tex += (tex.empty() ? "" : "\n") + line.get<std::string>();
    EXPECT_EQ(within(svg, "title"), escaped(equation["plain"])) << equation["id"];
    EXPECT_EQ(within(svg, "desc"), escaped(tex)) << equation["id"];
  }
  for (const auto& file : std::filesystem::directory_iterator(kExplain / "equations"))
    found.insert(file.path().filename().string());
  EXPECT_EQ(found, expected);
  const std::string resources = contentOf(kExplain / "explain.qrc");
  for (const std::string& file : expected)
    EXPECT_NE(resources.find("<file>equations/" + file + "</file>"), std::string::npos) << file;
}

TEST(Equations, EverySymbolOfTheSourceTextIsAGroupAndHasItsNotation) {
  std::map<std::string, std::string> notation;
  for (const auto& symbol : source()["symbols"]) {
    EXPECT_TRUE(notation.emplace(symbol["id"], symbol["notation"]).second) << symbol["id"];
    EXPECT_FALSE(symbol["name"].get<std::string>().empty());
  }
  const std::string page = contentOf(GLINT_SOURCE_DIR "/docs/NOTATION.md");
  std::set<std::string> used;
  for (const auto& equation : source()["equations"]) {
    std::string tex;
    for (const auto& line : equation["tex"]) tex += line.get<std::string>();
    // "id" and "id.2" are two places of one symbol.
    const std::map<std::string, int> wanted = countsOf(tex, "⟦([a-z0-9-]+):");
    EXPECT_EQ(countsOf(svgOf(equation), "<g id=\"([a-z0-9-]+)(?:\\.[0-9]+)?\">"), wanted) << equation["id"];
    for (const auto& [symbol, count] : wanted) {
      EXPECT_EQ(notation.count(symbol), 1U) << symbol;
      used.insert(symbol);
    }
  }
  EXPECT_EQ(used.size(), notation.size());
  for (const auto& [symbol, row] : notation) EXPECT_NE(page.find("\n| " + row + " | "), std::string::npos) << symbol;
}

TEST(Equations, ThePicturesHaveOneInkAndNoFont) {
  for (const auto& equation : source()["equations"]) {
    const std::string svg = svgOf(equation);
    EXPECT_EQ(countsOf(svg, "fill=\"([^\"]*)\""), (std::map<std::string, int>{{"currentColor", 1}})) << equation["id"];
    EXPECT_TRUE(countsOf(svg, "(stroke=|style=|<text|font-family|href)").empty()) << equation["id"];
    EXPECT_FALSE(countsOf(svg, "(<path )").empty());
  }
}

}  // namespace
}  // namespace glint::equations_tests

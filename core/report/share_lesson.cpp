// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/html_text.h"
#include "core/base/json_dom.h"
#include "core/report/share_parts.h"

namespace glint::share {
namespace {

using json_dom::Json;

/// The member of an object that may lack it; "" if it does.
std::string textAt(const Json& object, const char* member, const std::string& key) {
  return object.contains(member) ? object.at(member).value(key, "") : "";
}

/// A step as the inspector shows it: a plain lesson has its own words in place of the step's, and no equation.
Json stepJson(const Json& lesson, const Json& text) {
  const std::string key = text.at("id").get<std::string>();
  const std::string title = textAt(lesson, "titles", key), remark = textAt(lesson, "remarks", key);
  const bool plain = lesson.value("plain", false);
  return {{"title", title.empty() ? text.at("title") : Json(title)},
          {"text", plain ? Json(remark) : text.at("text")},
          {"equation", plain ? "" : text.value("equation", "")},
          {"layers", text.value("layers", Json::array())},
          {"remark", plain ? "" : remark}};
}

/// The typeset form of an equation, an SVG document whose title is the plain form; "" without one.
std::string_view pictureOf(const std::string& plain) {
  const std::size_t title = kEquationPictures.find("<title>" + html::escaped(plain) + "</title>");
  if (title == std::string_view::npos) return {};
  const std::string_view end = "</svg>";
  const std::size_t from = kEquationPictures.rfind("<svg ", title), to = kEquationPictures.find(end, title);
  return kEquationPictures.substr(from, to + end.size() - from);
}

/// Whether a lesson shows an equation: as a step's, or within a text, which is mark-up.
bool shows(const Json& lesson, const std::string& plain) {
  const std::string marked = html::escaped(plain);
  const auto in = [&](const Json& text) { return text.get_ref<const std::string&>().find(marked) != std::string::npos; };
  const Json &steps = lesson.at("steps"), &questions = lesson.at("questions");
  return in(lesson.at("see")) ||
         std::any_of(steps.begin(), steps.end(),
                     [&](const Json& s) { return s.at("equation") == plain || in(s.at("text")) || in(s.at("remark")); }) ||
         std::any_of(questions.begin(), questions.end(), [&](const Json& q) { return in(q.at("ask")) || in(q.at("answer")); });
}

/// The equations that a lesson shows, and the names of their symbols.
void addEquations(Json& lesson) {
  const Json known = Json::parse(kEquations);
  lesson["equations"] = Json::array();
  lesson["symbols"] = Json::object();
  std::string pictures;
  for (const Json& equation : known.at("equations")) {
    const std::string plain = equation.at("plain").get<std::string>();
    const std::string svg(shows(lesson, plain) ? pictureOf(plain) : std::string_view());
    if (svg.empty()) continue;
    lesson["equations"].push_back({{"plain", plain}, {"svg", svg}});
    pictures += svg;
  }
  for (const Json& symbol : known.at("symbols")) {
    const std::string id = symbol.at("id").get<std::string>();
    if (pictures.find("<g id=\"" + id + "\">") != std::string::npos) lesson["symbols"][id] = symbol.at("name");
  }
}

}  // namespace

std::string lessonJson(const std::string& id) {
  const Json lessons = Json::parse(kLessons), texts = Json::parse(kSteps);
  for (const Json& lesson : lessons.at("lessons")) {
    if (id.empty() || lesson.at("id") != id) continue;
    Json out = {{"title", lesson.at("title")}, {"see", lesson.at("see")}, {"steps", Json::array()}};
    for (const Json& step : lesson.at("steps"))
      for (const Json& text : texts.at("steps"))
        if (text.at("id") == step) out["steps"].push_back(stepJson(lesson, text));
    out["questions"] = lesson.value("questions", Json::array());
    addEquations(out);
    return out.dump();
  }
  return "null";
}

}  // namespace glint::share

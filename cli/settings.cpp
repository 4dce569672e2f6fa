// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/settings.h"

#include <charconv>

#include "cli/commands.h"

namespace glint::cli {
namespace {

std::string number(double v) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, v).ptr};
}

std::string valueText(const SettingValue& value) {
  if (const bool* b = std::get_if<bool>(&value)) return *b ? "true" : "false";
  if (const int* i = std::get_if<int>(&value)) return std::to_string(*i);
  if (const double* d = std::get_if<double>(&value)) return number(*d);
  return std::get<std::string>(value);
}

std::string rangeText(const ParamSpec& spec) {
  if (std::holds_alternative<bool>(spec.defaultValue)) return "true | false";
  if (!std::holds_alternative<std::string>(spec.defaultValue)) return number(spec.min) + " .. " + number(spec.max);
  std::string all;
  for (const std::string& choice : spec.choices) all += (all.empty() ? "" : " | ") + choice;
  return all;
}

/// Words of `text` in lines of at most `width` characters, each after `indent`.
std::string wrapped(const std::string& text, const std::string& indent, std::size_t width) {
  std::string out, line;
  std::size_t at = 0;
  while (at < text.size()) {
    std::size_t end = text.find(' ', at);
    if (end == std::string::npos) end = text.size();
    const std::string word = text.substr(at, end - at);
    at = end + 1;
    if (!line.empty() && line.size() + 1 + word.size() > width) {
      out += indent + line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return out + (line.empty() ? "" : indent + line + "\n");
}

}  // namespace

Command settingsCommand() {
  Command c;
  c.name = "settings";
  c.summary = "List every setting that --set KEY=VALUE takes";
  c.description = "Prints each setting with its default, unit, range or choices, and meaning, in pipeline order.";
  c.examples = "  glint settings\n  glint evaluate scene.json --set predict.directions=72\n";
  c.declare = [](Options&) {};
  c.run = [](const Context& context) -> int {
    std::string out;
    for (const ParamSpec& spec : allParams()) {
      out += spec.key + " = " + valueText(spec.defaultValue) + (spec.unit.empty() ? "" : " " + spec.unit) + "    (" +
             rangeText(spec) + ")\n";
      out += wrapped(spec.title + ". " + spec.help, "    ", 100) + "\n";
    }
    context.print(out);
    return kDone;
  };
  return c;
}

}  // namespace glint::cli

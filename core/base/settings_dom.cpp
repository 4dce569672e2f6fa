// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/settings_dom.h"

#include <algorithm>

#include "core/base/outcome.h"

namespace glint {
namespace {

SettingValue valueOfType(const SettingValue& like, const JsonNode& node) {
  if (std::holds_alternative<bool>(like)) return node.boolean();
  if (std::holds_alternative<int>(like)) return node.integer();
  if (std::holds_alternative<double>(like)) return node.number();
  return node.text();
}

}  // namespace

json_dom::Json toJson(const SettingValue& value) {
  return std::visit([](const auto& v) { return json_dom::Json(v); }, value);
}

json_dom::Json toJson(const Settings& settings) {
  json_dom::Json j = json_dom::Json::object();
  for (const ParamSpec& spec : allParams()) j[spec.key] = toJson(settings.value(spec.key));
  return j;
}

Settings readSettings(const JsonNode& node) {
  Settings settings;
  const auto& all = allParams();
  for (const std::string& key : node.keys()) {
    const JsonNode value = node.at(key);
    const auto spec = std::find_if(all.begin(), all.end(), [&](const ParamSpec& s) { return s.key == key; });
    if (spec == all.end()) value.fail("unknown setting");
    try {
      settings.set(key, valueOfType(spec->defaultValue, value));
    } catch (const InputError& e) {
      if (!e.file().empty()) throw;
      // Settings name the flag; here the place in the file says more.
      const std::string message = e.what();
      value.fail(message.substr(std::min(message.size(), e.place().size() + 2)));
    }
  }
  return settings;
}

}  // namespace glint

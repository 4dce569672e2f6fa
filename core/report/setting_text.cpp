// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/setting_text.h"

#include <variant>

#include "core/base/number_text.h"

namespace glint {

std::string settingText(const SettingValue& value) {
  if (const auto* s = std::get_if<std::string>(&value)) return *s;
  if (const auto* b = std::get_if<bool>(&value)) return *b ? "on" : "off";
  if (const auto* i = std::get_if<int>(&value)) return std::to_string(*i);
  return formatted("%.6g", std::get<double>(value));
}

}  // namespace glint

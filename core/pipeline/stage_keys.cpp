// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stage_keys.h"

#include <variant>

#include "core/base/number_text.h"

namespace glint {

std::string exactText(double v) { return formatted("%.17g", v); }

std::string keyOfStages(const Settings& settings, const std::set<std::string>& stages, const std::string& more) {
  std::string key = more;
  for (const auto& [name, value] : settings.values()) {
    if (!stages.count(paramSpec(name).stage)) continue;
    key += "|" + name + "=";
    if (const auto* text = std::get_if<std::string>(&value))
      key += *text;
    else if (const auto* number = std::get_if<double>(&value))
      key += exactText(*number);
    else if (const auto* whole = std::get_if<int>(&value))
      key += std::to_string(*whole);
    else
      key += std::get<bool>(value) ? "true" : "false";
  }
  return key;
}

std::string detectKey(const InspectionRequest& request, bool together) {
  // The assignment of several lights reflects rays on the surface: its normals matter then.
  const std::set<std::string> stages = together ? std::set<std::string>{"detect", "surface"} : std::set<std::string>{"detect"};
  return keyOfStages(request.settings, stages,
                     (request.source == FrameSource::Image ? "image|" : "radiance|") + request.truthFolder + "|" +
                         synthesisKey(request.whatIf) + (together ? posesKey(request.whatIf) : ""));
}

}  // namespace glint

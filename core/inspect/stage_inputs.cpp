// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/stage_inputs.h"

#include <variant>

#include "core/base/number_text.h"
#include "core/inspect/inspection.h"

namespace glint {

StageInputs StageInputs::upTo(Stage last) const {
  StageInputs some = *this;
  for (std::size_t i = index(last) + 1; i < kStages; ++i) some.inputs_[i].reset();
  return some;
}

std::string exactText(double v) { return formatted("%.17g", v); }

std::string inputsText(const Settings& settings, const std::set<std::string>& stages, const std::string& more) {
  std::string text = more;
  for (const auto& [name, value] : settings.values()) {
    if (!stages.count(paramSpec(name).stage)) continue;
    text += "|" + name + "=";
    if (const auto* word = std::get_if<std::string>(&value))
      text += *word;
    else if (const auto* number = std::get_if<double>(&value))
      text += exactText(*number);
    else if (const auto* whole = std::get_if<int>(&value))
      text += std::to_string(*whole);
    else
      text += std::get<bool>(value) ? "true" : "false";
  }
  return text;
}

std::string evidenceInputs(const InspectionRequest& request, bool together) {
  // The assignment of several lights reflects rays on the surface: its normals matter then.
  const std::set<std::string> stages = together ? std::set<std::string>{"detect", "surface"} : std::set<std::string>{"detect"};
  return inputsText(request.settings, stages,
                    (request.source == FrameSource::Image ? "image|" : "radiance|") + request.truthFolder + "|" +
                        synthesisKey(request.whatIf) + (together ? posesKey(request.whatIf) : ""));
}

}  // namespace glint

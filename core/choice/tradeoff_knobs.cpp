// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "core/choice/tradeoff.h"
#include "core/model/model.h"

namespace glint {
namespace {

/// Steps that change time or error enough to be told from noise.
const std::map<std::string, std::vector<double>>& ladders() {
  static const std::map<std::string, std::vector<double>> all = {
      {"light.bundle_points", {24, 72, 180}},
      {"predict.directions", {12, 18, 24, 36, 72}},
      {"predict.seed_step", {16, 32, 64}},
      {"predict.level_set_step", {2, 4, 8, 16}},
      {"predict.walk_tolerance", {1e-10, 1e-6, 1e-4}},
  };
  return all;
}

/// They add to a prediction without changing its contour or its measured time, or they decide what counts as an answer.
const std::set<std::string> kNoKnobs{"fit.most_residual", "predict.band", "input.scale_tolerance", "input.focal_tolerance"};

/// What only this model looks at.
const std::set<std::string> kOfReflectance{"fit.evidence", "fit.levels", "fit.lobe", "fit.light_size"};

/// The value of any setting, also of one that the program does not have.
SettingValue valueIn(const Settings& settings, const ParamSpec& spec) {
  const auto set = settings.values().find(spec.key);
  return set == settings.values().end() ? spec.defaultValue : set->second;
}

}  // namespace

std::string textOf(const SettingValue& value) {
  if (const bool* b = std::get_if<bool>(&value)) return *b ? "true" : "false";
  if (const int* i = std::get_if<int>(&value)) return std::to_string(*i);
  if (const std::string* s = std::get_if<std::string>(&value)) return *s;
  char buffer[40];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, std::get<double>(value)).ptr};
}

std::string knobName(const std::string& key) {
  if (key == "light.solver") return "light_solver";
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? key : key.substr(dot + 1);
}

std::vector<Knob> knobsOf(const Settings& base, const std::vector<ParamSpec>& params) {
  static const std::set<std::string> stages{"surface", "light", "fit", "predict"};
  std::vector<Knob> knobs;
  for (const ParamSpec& spec : params) {
    if (!stages.count(spec.stage) || kNoKnobs.count(spec.key)) continue;
    Knob knob{spec.key, {}};
    if (kOfReflectance.count(spec.key)) knob.onlyModel = radianceModel().id();
    const SettingValue now = valueIn(base, spec);
    if (std::holds_alternative<bool>(spec.defaultValue)) {
      knob.values = {false, true};
    } else if (std::holds_alternative<std::string>(spec.defaultValue)) {
      for (const std::string& choice : spec.choices) knob.values.emplace_back(choice);
    } else {
      const bool whole = std::holds_alternative<int>(spec.defaultValue);
      const double current = whole ? std::get<int>(now) : std::get<double>(now);
      std::set<double> numbers{current};
      if (const auto ladder = ladders().find(spec.key); ladder != ladders().end())
        numbers.insert(ladder->second.begin(), ladder->second.end());
      else if (spec.key.rfind("predict.", 0) == 0)
        for (const double factor : {0.5, 2.0}) numbers.insert(current * factor);
      for (const double v : numbers) {
        if (v < spec.min || v > spec.max) continue;
        if (whole)
          knob.values.emplace_back(static_cast<int>(v));
        else
          knob.values.emplace_back(v);
      }
    }
    if (knob.values.size() > 1) knobs.push_back(std::move(knob));
  }
  return knobs;
}

}  // namespace glint

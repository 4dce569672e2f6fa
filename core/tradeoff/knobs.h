// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/settings.h"

namespace glint {

/// A setting that trades speed against accuracy, with the values worth trying.
struct Knob {
  std::string key;                   ///< dotted name
  std::vector<SettingValue> values;  ///< the base value among them
  std::string onlyModel = {};        ///< the one model that looks at it; "" = any
};

/// The knobs of `params` (method.md section 12), so that a setting which is added later is tried without further work: of the
/// stages surface, light, fit and predict every choice and switch, the numbers that have a ladder in knobs.cpp, and every other
/// number of `predict.` at half and twice its value. What changes the problem (detection), how a noisy fit is weighted, or
/// only the description of a contour (the uncertainty band) is no knob.
std::vector<Knob> knobsOf(const Settings& base, const std::vector<ParamSpec>& params = allParams());

/// "24", "1e-06", "refined", "true".
std::string textOf(const SettingValue& value);

}  // namespace glint

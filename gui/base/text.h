// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>
#include <optional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/settings.h"

namespace glint::gui {

inline QString toQString(const std::string& s) { return QString::fromUtf8(s.data(), int(s.size())); }
QString joined(const std::vector<std::string>& words);

/// A number with `digits` significant digits, without trailing zeros; a dash when it is not finite.
QString numberText(double value, int digits = 4);
/// A value as its panel shows it, with the unit.
QString valueText(const SettingValue& value, const ParamSpec& spec);
/// A sentence of the program with "12 us" as "12 µs": what terminals and files get is plain ASCII.
QString withMicro(QString sentence);
/// Decimals that a spin box needs to show steps of `step`.
int decimalsFor(double step);

}  // namespace glint::gui

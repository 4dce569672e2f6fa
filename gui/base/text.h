// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>
#include <optional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/settings.h"

namespace glint::gui {

/// Text for people: control characters, marks that turn the direction of writing, and bytes that are not UTF-8 are shown escaped,
/// whatever its origin. Line ends and tabs stay.
QString toQString(const std::string& s);
/// The same for a name: line ends and tabs are shown escaped, too, so that it stays one line.
QString nameText(const std::string& name);
/// A light within a sentence, "light 3", or at its beginning, "Light 3"; the id alone where that begins with the word.
QString lightText(const std::string& id);
QString lightTitle(const std::string& id);
/// A path or another text that comes as QString, for people: as nameText.
QString shownText(const QString& text);
/// Use it for what is read back: paths, keys, the clipboard. Not for labels.
inline QString exactQString(const std::string& s) { return QString::fromUtf8(s.data(), int(s.size())); }
/// The text of a menu's entry, a tab or a button, where a single & would underline the letter after it.
QString menuText(QString text);
QString joined(const std::vector<std::string>& words);

/// A number with `digits` significant digits, without trailing zeros; a dash when it is not finite.
QString numberText(double value, int digits = 4);
/// A value as its panel shows it, with the unit.
QString valueText(const SettingValue& value, const ParamSpec& spec);
/// A sentence of the program with "12 us" as "12 µs": what terminals and files get is plain ASCII.
QString withMicro(QString sentence);
/// What was typed, in any locale: "0.5", "1e-3", and "0,5", where the comma can only be a decimal one.
/// @param why  says what is wrong where there is no number; "1,234" may be two numbers.
std::optional<double> numberFromText(const QString& typed, QString* why = nullptr);
/// Decimals that a spin box needs to show steps of `step`.
int decimalsFor(double step);

}  // namespace glint::gui

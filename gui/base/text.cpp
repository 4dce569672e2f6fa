// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/text.h"

#include <QLocale>
#include <QRegularExpression>
#include <QStringList>
#include <cmath>

#include "gui/base/unit_text.h"

namespace glint::gui {

QString joined(const std::vector<std::string>& words) {
  QStringList list;
  for (const std::string& w : words) list << toQString(w);
  return list.join(QStringLiteral(", "));
}

QString numberText(double value, int digits) {
  if (!std::isfinite(value)) return QStringLiteral("–");
  if (std::abs(value) >= 1000 && std::abs(value) < 1e7) return QString::number(value, 'f', std::max(0, digits - 6));
  return QString::number(value, 'g', digits);
}

QString valueText(const SettingValue& value, const ParamSpec& spec) {
  const QString unit = unitAfter(spec.unit);
  if (const bool* b = std::get_if<bool>(&value)) return *b ? QStringLiteral("on") : QStringLiteral("off");
  if (const int* i = std::get_if<int>(&value)) return QString::number(*i) + unit;
  if (const double* d = std::get_if<double>(&value)) return numberText(*d, 6) + unit;
  return toQString(std::get<std::string>(value));
}

QString withMicro(QString sentence) {
  static const QRegularExpression number(QStringLiteral("(?<=[0-9]) us\\b"));
  return sentence.replace(number, QStringLiteral(" µs"));
}

int decimalsFor(double step) {
  if (!(step > 0)) return 3;
  return std::max(0, std::min(12, int(std::ceil(-std::log10(step) - 1e-9))));
}

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/text.h"

#include <QObject>
#include <QRegularExpression>
#include <QStringList>
#include <cmath>

#include "core/base/safe_text.h"
#include "core/base/words.h"
#include "gui/base/unit_text.h"

namespace glint::gui {

QString toQString(const std::string& s) {
  const std::string safe = withoutControls(s);
  return QString::fromUtf8(safe.data(), int(safe.size()));
}

QString nameText(const std::string& name) {
  return toQString(name).replace(QLatin1Char('\n'), QStringLiteral("\\n")).replace(QLatin1Char('\t'), QStringLiteral("\\t"));
}

QString lightText(const std::string& id) { return saysLight(id) ? nameText(id) : QObject::tr("light %1").arg(nameText(id)); }

QString lightTitle(const std::string& id) { return saysLight(id) ? nameText(id) : QObject::tr("Light %1").arg(nameText(id)); }

QString shownText(const QString& text) { return nameText(text.toStdString()); }

QString menuText(QString text) { return text.replace(QLatin1Char('&'), QStringLiteral("&&")); }

QString joined(const std::vector<std::string>& words) {
  QStringList list;
  for (const std::string& w : words) list << nameText(w);
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

std::optional<double> numberFromText(const QString& typed, QString* why) {
  const auto fail = [&](const QString& words) {
    if (why) *why = words;
    return std::nullopt;
  };
  QString text = typed.trimmed();
  text.replace(QChar(0x2212), QLatin1Char('-'));  // the minus of books
  static const QRegularExpression twoMeanings(QStringLiteral("^[+-]?[1-9][0-9]{0,2},[0-9]{3}$"));
  if (twoMeanings.match(text).hasMatch())
    return fail(
        QObject::tr("%1 is ambiguous (%2 or %3): use a decimal point or no comma")
            .arg(text, QString(text).replace(QLatin1Char(','), QLatin1Char('.')), QString(text).remove(QLatin1Char(','))));
  if (text.count(QLatin1Char(',')) == 1 && !text.contains(QLatin1Char('.'))) text.replace(QLatin1Char(','), QLatin1Char('.'));
  bool isNumber = false;
  const double value = text.toDouble(&isNumber);  // whatever the locale
  if (!isNumber || !std::isfinite(value)) return fail(QObject::tr("\"%1\" is not a number").arg(shownText(typed.trimmed())));
  return value;
}

int decimalsFor(double step) {
  if (!(step > 0)) return 3;
  return std::max(0, std::min(12, int(std::ceil(-std::log10(step) - 1e-9))));
}

}  // namespace glint::gui

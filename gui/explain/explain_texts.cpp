// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/explain_texts.h"

#include <QFile>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <algorithm>
#include <cmath>

#include "core/model/model.h"
#include "gui/base/text.h"
#include "gui/base/unit_text.h"

static void initExplainResource() { Q_INIT_RESOURCE(explain); }

namespace glint::gui {

namespace {
QStringList names(const QJsonValue& list, const QString& prefix = {}) {
  QStringList all;
  for (const QJsonValue& v : list.toArray()) all << prefix + v.toString();
  return all;
}

ExplainTexts read() {
  initExplainResource();
  QFile file(QStringLiteral(":/explain/steps.json"));
  ExplainTexts texts;
  if (!file.open(QIODevice::ReadOnly)) return texts;
  const QJsonObject root = QJsonDocument::fromJson(file.readAll()).object();
  for (const QJsonValue& v : root["steps"].toArray()) {
    const QJsonObject s = v.toObject();
    QMap<QString, ExplainText::Words> ofModels;
    QMap<QString, ExplainText::Shown> shownOfModels;
    const QJsonObject models = s["models"].toObject();
    for (auto it = models.begin(); it != models.end(); ++it) {
      const QJsonObject o = it.value().toObject();
      ofModels.insert(it.key(), {o["text"].toString(), o["equation"].toString()});
      if (o.contains("layers"))
        shownOfModels.insert(it.key(), {names(o["layers"]), names(o["frame_layers"], QStringLiteral("frame/"))});
    }
    texts.steps.append({s["id"].toString(), s["title"].toString(), s["text"].toString(), s["equation"].toString(),
                        s["section"].toString(), names(s["layers"]), names(s["frame_layers"], QStringLiteral("frame/")),
                        s["look"].toString(), s["solo"].toBool(), s["epipolar"].toBool(), ofModels, shownOfModels});
  }
  const QJsonObject broken = root["broken"].toObject();
  for (auto it = broken.begin(); it != broken.end(); ++it) texts.broken.insert(it.key(), it.value().toString());
  return texts;
}
}  // namespace

ExplainText::Words ExplainText::words(const QString& model) const {
  const auto& steps = explainTexts().steps;
  const bool named =
      model.isEmpty() || model == toQString(canonicalModel().id()) ||
      std::any_of(steps.begin(), steps.end(), [&](const ExplainText& step) { return step.ofModels.contains(model); });
  if (!named && !ofModels.isEmpty()) {  // the words are those of another model
    const HighlightModel* known = findModel(model.toStdString());
    return {known ? toQString(known->assumption()) : QString(), {}};
  }
  const Words own = ofModels.value(model);
  return {own.text.isEmpty() ? text : own.text, own.equation.isEmpty() ? equation : own.equation};
}

const ExplainTexts& explainTexts() {
  static const ExplainTexts texts = read();
  return texts;
}

QString valuesHtml(const ExplainNumber& n) {
  const int digits = n.values.size() > 1 ? 4 : 5;  // several are in one row of a narrow panel
  constexpr double kShort = 1e-2;                  // m: below, a single length is in mm
  const double least = std::max(n.least, 0.0);
  const bool single = n.values.size() == 1;
  const bool rounding = std::all_of(n.values.begin(), n.values.end(), [&](double v) { return std::abs(v) < least; });
  const bool zero = std::all_of(n.values.begin(), n.values.end(), [](double v) { return v == 0; });
  if (rounding && !zero) return QObject::tr("0 within rounding");
  const bool millimetres = single && n.unit == "m" && !zero && std::abs(n.values.front()) < kShort;
  // Whole steps of a power of ten that is not larger than the least.
  const double step = least > 0 ? std::pow(10, std::floor(std::log10(least))) : 0;
  QStringList parts;
  for (const double v : n.values) {
    double rounded = step > 0 && std::isfinite(v) ? std::round(v / step) * step : v;
    if (std::abs(v) < least) rounded = 0;
    parts << numberText(millimetres ? 1000 * rounded : rounded, digits);
  }
  const QString unit = unitAfter(millimetres ? "mm" : n.unit);
  return parts.join(QStringLiteral("&nbsp;&nbsp; ")) + unit.toHtmlEscaped().replace(QLatin1Char(' '), QStringLiteral("&nbsp;"));
}

}  // namespace glint::gui

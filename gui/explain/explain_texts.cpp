// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/explain_texts.h"

#include <QFile>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>

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
    const QJsonObject models = s["models"].toObject();
    for (auto it = models.begin(); it != models.end(); ++it) {
      const QJsonObject o = it.value().toObject();
      ofModels.insert(it.key(), {o["text"].toString(), o["equation"].toString()});
    }
    texts.steps.append({s["id"].toString(), s["title"].toString(), s["text"].toString(), s["equation"].toString(),
                        s["section"].toString(), names(s["layers"]), names(s["frame_layers"], QStringLiteral("frame/")),
                        s["look"].toString(), s["solo"].toBool(), ofModels});
  }
  const QJsonObject broken = root["broken"].toObject();
  for (auto it = broken.begin(); it != broken.end(); ++it) texts.broken.insert(it.key(), it.value().toString());
  return texts;
}
}  // namespace

ExplainText::Words ExplainText::words(const QString& model) const {
  const Words own = ofModels.value(model);
  return {own.text.isEmpty() ? text : own.text, own.equation.isEmpty() ? equation : own.equation};
}

const ExplainTexts& explainTexts() {
  static const ExplainTexts texts = read();
  return texts;
}

}  // namespace glint::gui

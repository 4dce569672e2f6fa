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
    texts.steps.append({s["id"].toString(), s["title"].toString(), s["text"].toString(), s["equation"].toString(),
                        s["section"].toString(), names(s["layers"]), names(s["frame_layers"], QStringLiteral("frame/")),
                        s["look"].toString()});
  }
  const QJsonObject broken = root["broken"].toObject();
  for (auto it = broken.begin(); it != broken.end(); ++it) texts.broken.insert(it.key(), it.value().toString());
  return texts;
}
}  // namespace

const ExplainTexts& explainTexts() {
  static const ExplainTexts texts = read();
  return texts;
}

}  // namespace glint::gui

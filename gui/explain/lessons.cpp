// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/lessons.h"

#include <QCoreApplication>
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>

static void initLessonResource() { Q_INIT_RESOURCE(explain); }

namespace glint::gui {

namespace {
QStringList strings(const QJsonValue& list) {
  QStringList all;
  for (const QJsonValue& v : list.toArray()) all << v.toString();
  return all;
}

QList<Lesson> read() {
  initLessonResource();
  QFile file(QStringLiteral(":/explain/lessons.json"));
  QList<Lesson> all;
  if (!file.open(QIODevice::ReadOnly)) return all;
  for (const QJsonValue& v : QJsonDocument::fromJson(file.readAll()).object()["lessons"].toArray()) {
    const QJsonObject o = v.toObject();
    Lesson lesson{o["id"].toString(),     o["title"].toString(), o["see"].toString(), strings(o["steps"]), {},
                  strings(o["questions"])};
    const QJsonObject remarks = o["remarks"].toObject();
    for (auto it = remarks.begin(); it != remarks.end(); ++it) lesson.remarks.insert(it.key(), it.value().toString());
    all.append(lesson);
  }
  return all;
}
}  // namespace

const QList<Lesson>& lessons() {
  static const QList<Lesson> all = read();
  return all;
}

const Lesson* lessonById(const QString& id) {
  for (const Lesson& lesson : lessons())
    if (lesson.id == id) return &lesson;
  return nullptr;
}

QString lessonFile(const QString& id) {
  QStringList folders{qEnvironmentVariable("GLINT_LESSONS")};
  QDir folder(QCoreApplication::applicationDirPath());
  folders << folder.filePath(QStringLiteral("../share/glint/sessions/lessons"));
  for (int up = 0; up < 4; ++up, folder.cdUp()) folders << folder.filePath(QStringLiteral("sessions/lessons"));
  for (const QString& path : folders) {
    if (path.isEmpty()) continue;
    const QFileInfo session(QDir(path).filePath(id + '/' + id + QStringLiteral(".glint")));
    if (session.isFile()) return session.canonicalFilePath();
  }
  return {};
}

}  // namespace glint::gui

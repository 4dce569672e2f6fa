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

/// FOLDER/ID/ID.glint; "" for an unknown lesson.
QString sessionIn(const QString& folder, const QString& id) {
  const QFileInfo session(QDir(folder).filePath(id + '/' + id + QStringLiteral(".glint")));
  return session.isFile() ? session.canonicalFilePath() : QString();
}

QMap<QString, QString> texts(const QJsonValue& object) {
  QMap<QString, QString> all;
  const QJsonObject o = object.toObject();
  for (auto it = o.begin(); it != o.end(); ++it) all.insert(it.key(), it.value().toString());
  return all;
}

QList<Lesson> read() {
  initLessonResource();
  QFile file(QStringLiteral(":/explain/lessons.json"));
  QList<Lesson> all;
  if (!file.open(QIODevice::ReadOnly)) return all;
  for (const QJsonValue& v : QJsonDocument::fromJson(file.readAll()).object()["lessons"].toArray()) {
    const QJsonObject o = v.toObject();
    Lesson lesson;
    lesson.id = o["id"].toString();
    lesson.title = o["title"].toString();
    lesson.see = o["see"].toString();
    lesson.steps = strings(o["steps"]);
    lesson.remarks = texts(o["remarks"]);
    lesson.titles = texts(o["titles"]);
    lesson.plain = o["plain"].toBool();
    for (const QJsonValue& q : o["questions"].toArray())
      lesson.questions.append({q.toObject()["ask"].toString(), q.toObject()["answer"].toString()});
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

QString numberedTitle(const Lesson& lesson) {
  return QCoreApplication::translate("Lessons", "Lesson %1: %2").arg(lessons().indexOf(lesson)).arg(lesson.title);
}

const Lesson* lessonAfter(const Lesson& lesson) {
  const int next = lessons().indexOf(lesson) + 1;
  return next > 0 && next < lessons().size() ? &lessons()[next] : nullptr;
}

QString lessonFile(const QString& id) {
  QStringList folders{qEnvironmentVariable("GLINT_LESSONS")};
  QDir folder(QCoreApplication::applicationDirPath());
  folders << folder.filePath(QStringLiteral("../share/glint/sessions/lessons"));
  for (int up = 0; up < 4; ++up, folder.cdUp()) folders << folder.filePath(QStringLiteral("sessions/lessons"));
  for (const QString& path : folders)
    if (const QString file = path.isEmpty() ? QString() : sessionIn(path, id); !file.isEmpty()) return file;
  return {};
}

QString sessionFile(const QString& id) {
  const QString lesson = lessons().isEmpty() ? QString() : lessonFile(lessons().front().id);
  return lesson.isEmpty() ? QString() : sessionIn(QFileInfo(lesson).dir().filePath(QStringLiteral("../..")), id);
}

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QMap>
#include <QString>
#include <QStringList>

namespace glint::gui {

/// What resources/explain/lessons.json says of a lesson: a session under sessions/lessons/ID/ID.glint, and what to see in it.
struct Lesson {
  struct Question {
    QString ask;     ///< "turn this and see that"
    QString answer;  ///< what is seen then, and why
  };
  QString id, title;
  QString see;                     ///< what there is to see, one paragraph
  QStringList steps;               ///< ids of the steps that it is about, in the order to go through
  QMap<QString, QString> remarks;  ///< by step id: what to look at there
  QMap<QString, QString> titles;   ///< by step id: its title here; those that are missing are as everywhere
  QList<Question> questions;
  bool plain = false;  ///< remarks stand for the steps' own words, equations and numbers
  friend bool operator==(const Lesson& a, const Lesson& b) { return a.id == b.id; }
  /// What a step is called here. @param usual  its title everywhere else.
  QString titleOf(const QString& step, const QString& usual) const { return titles.value(step, usual); }
};
/// In their order. Read once from the program's resources.
const QList<Lesson>& lessons();
/// Null for an unknown id.
const Lesson* lessonById(const QString& id);
/// "Lesson 3: Sphere"; the first one, without an equation, has the number 0.
QString numberedTitle(const Lesson& lesson);
/// The one after it; null after the last.
const Lesson* lessonAfter(const Lesson& lesson);
/// The lesson's session: in $GLINT_LESSONS, beside the program (share/glint/sessions/lessons), or in the source tree that the
/// program was built in; "" if it is in none of them.
QString lessonFile(const QString& id);
/// The same for another session that came with the program, beside the lessons.
QString sessionFile(const QString& id);

}  // namespace glint::gui

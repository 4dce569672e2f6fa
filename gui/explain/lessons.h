// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QMap>
#include <QString>
#include <QStringList>

namespace glint::gui {

/// What resources/explain/lessons.json says of a lesson: a session under sessions/lessons/ID/ID.glint, and what to see in it.
struct Lesson {
  QString id, title;
  QString see;                     ///< what there is to see, one paragraph
  QStringList steps;               ///< ids of the steps that it is about, in the order to go through
  QMap<QString, QString> remarks;  ///< by step id: what to look at there
  QStringList questions;           ///< "turn this and see that"
  friend bool operator==(const Lesson& a, const Lesson& b) { return a.id == b.id; }
};
/// In their order. Read once from the program's resources.
const QList<Lesson>& lessons();
/// Null for an unknown id.
const Lesson* lessonById(const QString& id);
/// The lesson's session: in $GLINT_LESSONS, beside the program (share/glint/sessions/lessons), or in the source tree that the program was
/// built in; "" when it is in none of them.
QString lessonFile(const QString& id);

}  // namespace glint::gui

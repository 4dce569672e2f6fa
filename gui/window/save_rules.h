// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>
#include <string>

#include "gui/document/document.h"
#include "gui/window/session_lock.h"

class QWidget;

namespace glint::gui {

/// Which session files may be replaced: the one that was opened, as long as no other program has changed it; any other session
/// after a question; nothing else, and nothing that came with the program.
class SaveRules {
 public:
  enum class Answer { Write, SaveAs, Cancel };

  SaveRules(const Document& document, QWidget* window) : document_(document), window_(window) {}
  /// A session was opened from, or saved to, this file with this stamp; "" = unknown.
  void follow(const QString& session, const std::string& stamp);
  /// Another window or program that has the open session open, in words; "" = none.
  QString otherHolder() { return lock_.otherHolder(document_.sessionFile()); }

  /// May ask. @param refusal  why the answer is no without a question; "" = the person said so.
  Answer toOwnFile(QString& refusal);
  /// The same for a file that a person chose.
  Answer toChosenFile(const QString& file, QString& refusal);

 private:
  Answer ask(const QString& what, bool otherName);

  const Document& document_;
  QWidget* window_;
  SessionLock lock_;
  std::string stamp_;
};

}  // namespace glint::gui

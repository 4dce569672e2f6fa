// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QPalette>
#include <QSet>
#include <QString>

#include "core/advise/explain.h"
#include "gui/document/document.h"
#include "gui/explain/lessons.h"

namespace glint::gui {

struct ExplainText;

/// What the text beside the pictures is made from.
struct ExplainPage {
  const Document& document;
  const Lesson* lesson = nullptr;            ///< the session is one; null = none
  int step = -1;                             ///< index in explainTexts().steps; -1 = the overview
  const Explanation* explanation = nullptr;  ///< null = not computed yet
  bool asOpened = true;                      ///< nothing was changed since: remarks are about what is on screen
  QString walkProblem;                       ///< why there is no walk; "" = there is one, or it was not asked for
  QString walkEnds;                          ///< where the walk on screen ends; "" = no walk
  QSet<int> unfolded;                        ///< questions whose answers are shown
  QPalette palette;

  /// Links: "action:ID" runs an action, "unfold:N" shows or hides an answer, "glossary:WORD" and "method:SECTION" are read
  /// elsewhere, "symbol:ID" is a symbol of the equation.
  QString html() const;

 private:
  QString overview() const;
  QString questions() const;
  QString ending() const;
  QString wordsOf(const ExplainText& text) const;
  QString subject() const;
  QString whereFrom(const QString& id, bool trains) const;
  QString stepPage() const;
  QString numbersTable(const std::vector<ExplainNumber>& numbers) const;
  QString typeset(const QString& html) const;
  bool plain() const { return lesson && lesson->plain; }
};

}  // namespace glint::gui

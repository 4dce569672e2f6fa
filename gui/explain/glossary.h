// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QColor>
#include <QList>
#include <QString>
#include <QStringList>

namespace glint::gui {

/// One entry of resources/explain/glossary.json: a term of docs/NOTATION.md or of the lessons, in plain words.
struct GlossaryWord {
  QString word;
  QStringList forms;  ///< other forms that a text may use
  QString text;
};
/// In the file's order, which tells the terms from the highlight to the models. Read once from the program's resources.
const QList<GlossaryWord>& glossary();

/// HTML with a link "glossary:WORD" at the first place of each term; not within links, headings, equations and numbers.
/// @param ink  colour of these links: that of the text, so that they do not shout.
QString withGlossary(const QString& html, const QColor& ink);

}  // namespace glint::gui

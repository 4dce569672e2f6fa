// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/glossary.h"

#include <QFile>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QMap>
#include <QRegularExpression>
#include <QSet>
#include <algorithm>

static void initGlossaryResource() { Q_INIT_RESOURCE(explain); }

namespace glint::gui {

namespace {
QList<GlossaryWord> readGlossary() {
  initGlossaryResource();
  QFile file(QStringLiteral(":/explain/glossary.json"));
  QList<GlossaryWord> all;
  if (!file.open(QIODevice::ReadOnly)) return all;
  for (const QJsonValue& v : QJsonDocument::fromJson(file.readAll()).object()["words"].toArray()) {
    const QJsonObject o = v.toObject();
    GlossaryWord word{o["word"].toString(), {}, o["text"].toString()};
    for (const QJsonValue& form : o["forms"].toArray()) word.forms << form.toString();
    all.append(word);
  }
  return all;
}

/// Every form, lower case, with its word.
const QMap<QString, QString>& forms() {
  static const QMap<QString, QString> all = [] {
    QMap<QString, QString> found;
    for (const GlossaryWord& w : glossary()) {
      found.insert(w.word.toLower(), w.word);
      for (const QString& form : w.forms) found.insert(form.toLower(), w.word);
    }
    return found;
  }();
  return all;
}

/// A tag, or a term as a whole word; longer ones first, so that "limit angle" is not "limit".
const QRegularExpression& tagOrTerm() {
  static const QRegularExpression pattern = [] {
    QStringList terms = forms().keys();
    std::sort(terms.begin(), terms.end(), [](const QString& a, const QString& b) { return a.size() > b.size(); });
    for (QString& term : terms) term = QRegularExpression::escape(term);
    return QRegularExpression(QStringLiteral("<[^>]*>|(?<![\\w-])(?:%1)(?![\\w-])").arg(terms.join('|')),
                              QRegularExpression::CaseInsensitiveOption | QRegularExpression::UseUnicodePropertiesOption);
  }();
  return pattern;
}
}  // namespace

const QList<GlossaryWord>& glossary() {
  static const QList<GlossaryWord> all = readGlossary();
  return all;
}

QString withGlossary(const QString& html, const QColor& ink) {
  static const QSet<QString> kept{QStringLiteral("a"), QStringLiteral("h3"), QStringLiteral("h4"), QStringLiteral("tt"),
                                  QStringLiteral("i")};  // an italic word is a model's or a button's name
  static const QString numbers = QStringLiteral("<table class='numbers'"), subject = QStringLiteral("<div class='subject'");
  QSet<QString> done;
  QString result, within;  // the tag that everything stays as it is in; "" = none
  int from = 0;
  for (auto it = tagOrTerm().globalMatch(html); it.hasNext();) {
    const QRegularExpressionMatch match = it.next();
    const QString part = match.captured();
    result += html.mid(from, match.capturedStart() - from);
    from = match.capturedEnd();
    if (part.startsWith('<')) {
      const QString name = part.mid(1).section(QRegularExpression(QStringLiteral("[ >]")), 0, 0);
      if (within.isEmpty() && (kept.contains(name) || part.startsWith(numbers) || part.startsWith(subject)))
        within = name;
      else if (name == '/' + within)
        within.clear();
      result += part;
      continue;
    }
    const QString word = forms().value(part.toLower());
    if (!within.isEmpty() || done.contains(word)) {
      result += part;
      continue;
    }
    done.insert(word);
    result += QStringLiteral("<a href='glossary:%1' style='color:%2'>%3</a>").arg(word, ink.name(), part);
  }
  return result + html.mid(from);
}

}  // namespace glint::gui

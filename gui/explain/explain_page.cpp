// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/explain_page.h"

#include <QCoreApplication>
#include <QRegularExpression>
#include <algorithm>

#include "core/model/model.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/explain/equations.h"
#include "gui/explain/explain_texts.h"
#include "gui/explain/glossary.h"

namespace glint::gui {

namespace {
QString said(const char* text) { return QCoreApplication::translate("ExplainPage", text); }

QString escaped(const std::string& s) { return toQString(s).toHtmlEscaped(); }

QString box(const QColor& colour, const QString& content) {
  return QStringLiteral(
             "<table width='100%' cellspacing=0 cellpadding=0 style='margin-top:8px'><tr><td width=4 bgcolor='%1'></td>"
             "<td style='padding-left:8px'>%2</td></tr></table>")
      .arg(colour.name(), content);
}

/// "method.md sections 1 and 6" with a link at each number.
QString sectionLinks(const QString& section) {
  QString html;
  int from = 0;
  static const QRegularExpression number(QStringLiteral("\\b\\d+[a-z]?\\b"));
  for (auto it = number.globalMatch(section); it.hasNext();) {
    const QRegularExpressionMatch m = it.next();
    html += section.mid(from, m.capturedStart() - from).toHtmlEscaped() +
            QStringLiteral("<a href='method:%1'>%1</a>").arg(m.captured());
    from = m.capturedEnd();
  }
  return html + section.mid(from).toHtmlEscaped();
}

QString lessonLink(const Lesson& lesson) {
  return QStringLiteral("<a href='action:lesson.%1'>%2</a>").arg(lesson.id, numberedTitle(lesson).toHtmlEscaped());
}
}  // namespace

QString ExplainPage::html() const { return withGlossary(step < 0 ? overview() : stepPage(), palette.color(QPalette::Text)); }

/// The text with the equations of a lesson typeset.
QString ExplainPage::typeset(const QString& html) const { return withEquations(html, palette.color(QPalette::Base)); }

/// The symbol of a row leads to its place in the step's equation: the one there, if several have such a number.
QString ExplainPage::numbersTable(const std::vector<ExplainNumber>& numbers) const {
  if (numbers.empty()) return {};
  const ExplainText& text = explainTexts().steps[step];
  const QString plainForm = text.words(explanation ? toQString(explanation->model) : QString()).equation;
  const auto& all = equations();
  const auto equation = std::find_if(all.begin(), all.end(), [&](const Equation& e) { return e.plain == plainForm; });
  QString html = QStringLiteral("<table class='numbers' cellspacing=0 cellpadding=2>");
  for (const ExplainNumber& n : numbers) {
    QString symbol = escaped(n.symbol);
    for (const EquationSymbol& s : equationSymbols())
      if (equation != all.end() && equation->has(s.id) && s.numbers.contains(toQString(n.symbol)))
        symbol = QStringLiteral("<a href='symbol:%1' style='color:%2; text-decoration:none'>%3</a>")
                     .arg(s.id, palette.color(QPalette::Text).name(), escaped(n.symbol));
    html += QStringLiteral("<tr><td><i>%1</i>&nbsp;&nbsp;</td><td>%2&nbsp;&nbsp;</td><td><b>%3</b></td></tr>")
                .arg(symbol, escaped(n.name), valuesHtml(n));
  }
  return html + QStringLiteral("</table>");
}

QString ExplainPage::questions() const {
  QString html = QStringLiteral("<h4>%1</h4><ul>").arg(said("Try"));
  for (int i = 0; i < lesson->questions.size(); ++i) {
    const Lesson::Question& q = lesson->questions[i];
    const bool open = unfolded.contains(i);
    html += QStringLiteral("<li>%1 <a href='unfold:%2'>%3</a>%4</li>")
                .arg(typeset(q.ask))
                .arg(i)
                .arg(open ? said("Hide the answer") : said("Show the answer"),
                     open ? QStringLiteral("<br>%1<br>").arg(typeset(q.answer)) : QString());
  }
  return html + QStringLiteral("</ul>");
}

/// What follows the last step of a lesson.
QString ExplainPage::ending() const {
  const Lesson* const next = lessonAfter(*lesson);
  return questions() + QStringLiteral("<p><b>%1</b></p>")
                           .arg(next ? said("Next: %1").arg(lessonLink(*next)) : said("This was the last lesson."));
}

QString ExplainPage::overview() const {
  if (!lesson) {
    QString html =
        QStringLiteral("<p>%1</p><h4>%2</h4>")
            .arg(said("Eleven steps from the photograph to the predicted highlight of the open scene, each with its picture, "
                      "equation and numbers, and the assumptions that break here."),
                 said("Lessons"));
    for (const Lesson& l : lessons()) html += QStringLiteral("<p>%1</p>").arg(lessonLink(l));
    return html;
  }
  // Its steps are the rows of the list above.
  return QStringLiteral("<h3>%1</h3><p>%2</p>").arg(numberedTitle(*lesson).toHtmlEscaped(), typeset(lesson->see)) + ending();
}

/// The step's own words, or those of a plain lesson in their place.
QString ExplainPage::wordsOf(const ExplainText& text) const {
  const QString title = (lesson ? lesson->titleOf(text.id, text.title) : text.title).toHtmlEscaped();
  const QString remark = lesson ? lesson->remarks.value(text.id) : QString();
  if (plain()) return QStringLiteral("<h3>%1</h3><p>%2</p>").arg(title, remark);
  const ExplainText::Words words = text.words(explanation ? toQString(explanation->model) : QString());
  QString html = QStringLiteral("<h3>%1</h3><p>%2</p><p style='margin-left:8px'>%3<br><span style='color:%4'>%5</span></p>")
                     .arg(title, words.text.toHtmlEscaped(), equationHtml(words.equation, palette.color(QPalette::Base)),
                          palette.color(QPalette::PlaceholderText).name(), sectionLinks(text.section));
  if (!remark.isEmpty())
    html += box(accentColour(),
                (asOpened ? said("<b>In this lesson.</b> %1") : said("<b>In this lesson as opened</b> (changed since then). %1"))
                    .arg(typeset(remark)));
  return html;
}

/// Which frame, highlight, light and model the numbers are of.
QString ExplainPage::subject() const {
  const Scene& scene = *document.scene();
  const auto inspection = document.inspection();
  const std::size_t frame = std::size_t(explanation->frame);
  const std::size_t highlights =
      inspection && frame < inspection->evidence.size() ? inspection->evidence[frame].highlights.size() : 0;
  const QString ofSeveral = highlights > 1 && explanation->highlight >= 0
                                ? said(", highlight %1 of %2").arg(explanation->highlight + 1).arg(highlights)
                                : QString();
  QString words = said("Frame %1%2").arg(escaped(scene.frames[frame].id), ofSeveral);
  if (!plain() && !explanation->light.empty()) words += QStringLiteral(", ") + lightText(explanation->light).toHtmlEscaped();
  if (!plain() && !explanation->model.empty()) words += said(", model %1").arg(escaped(explanation->model));
  if (!plain() && inspection && inspection->lightFrame.frame == LightFrame::Camera) words += said(", coordinates of the camera");
  return QStringLiteral("<div class='subject' style='color:%1; margin-top:8px; margin-bottom:8px'>%2</div>")
      .arg(palette.color(QPalette::PlaceholderText).name(), words);
}

/// What of a frame is observed in it, and what comes from the others.
QString ExplainPage::whereFrom(const QString& id, bool trains) const {
  if (id == QLatin1String("projection"))  // whether "any camera" is a new one here
    return QStringLiteral("<p>%1</p>")
        .arg(trains ? said("This camera is not new to the model: it was trained on this frame.")
                    : said("This camera is new to the model: it was not trained on this frame."));
  const bool ofObserved = id == QLatin1String("limit-angles") || id == QLatin1String("canonical-ellipse");
  if (!ofObserved || trains) return {};
  return box(
      palette.color(QPalette::Highlight),
      said("<b>Observed here:</b> the contour on which this walk is based. <b>From other frames:</b> the light; "
           "no model was trained on this frame. <b>Predicted:</b> %1.")
          .arg(document.inspection()->models.count(canonicalModel().id()) ? said("only the dotted ellipse in the frame view")
                                                                          : said("nothing")));
}

QString ExplainPage::stepPage() const {
  const ExplainText& text = explainTexts().steps[step];
  const bool last = lesson && !lesson->steps.isEmpty() && lesson->steps.back() == text.id;
  const QString end = last ? ending() : QString();
  QString html = wordsOf(text);
  if (!explanation || step >= int(explanation->steps.size())) return html + end;
  const ExplainStep& s = explanation->steps[std::size_t(step)];
  html += subject();
  if (const auto inspection = document.inspection(); !s.failure && !plain() && inspection)
    html += whereFrom(text.id, inspection->isTraining(explanation->frame));
  // What is wrong comes first: a low window shows no more than that.
  if (s.failure) html += box(errorColour(), said("This scene does not reach this step: %1").arg(escaped(s.failure->message())));
  if (plain()) return html + end;
  for (const BrokenAssumption& b : s.broken)
    html += box(warningColour(), explainTexts().broken.value(toQString(b.id)).toHtmlEscaped() + numbersTable(b.numbers));
  if (!s.failure && s.broken.empty() && !walkProblem.isEmpty() && text.layers.contains(QStringLiteral("walk")))
    html += box(warningColour(), said("No walk to show: %1").arg(walkProblem.toHtmlEscaped()));
  if (!walkEnds.isEmpty() && text.layers.contains(QStringLiteral("walk")))
    html += QStringLiteral("<p><b>%1</b> %2</p>").arg(said("This walk ends on"), walkEnds.toHtmlEscaped());
  if (text.id == QLatin1String("ellipsoid") && !s.failure)
    html += QStringLiteral("<p><a href='action:explain.duality'>%1</a></p>")
                .arg(said("Why is this linear? Primal and dual side by side"));
  return html + (s.broken.empty() && !s.failure ? QString() : QStringLiteral("<br>")) + numbersTable(s.numbers) + end;
}

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/equation_browser.h"

#include <QAbstractTextDocumentLayout>
#include <QEvent>
#include <QFontInfo>
#include <QHelpEvent>
#include <QMimeData>
#include <QMouseEvent>
#include <QScrollBar>
#include <QTextBlock>
#include <QTextDocumentFragment>
#include <QTextLayout>
#include <QToolTip>
#include <QUrl>
#include <algorithm>
#include <cmath>
#include <utility>

#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/explain/equations.h"
#include "gui/explain/lit_colour.h"

namespace glint::gui {

namespace {
constexpr double kLarger = 1.3;  // a serif of the same size as the text beside it looks smaller
constexpr int kIndent = 24;      // most px by which paragraphs with equations are indented, both margins together

const QString& scheme() {
  static const QString name = QStringLiteral("equation:");
  return name;
}
}  // namespace

EquationBrowser::EquationBrowser(QWidget* parent) : QTextBrowser(parent) {
  setMouseTracking(true);
  viewport()->setMouseTracking(true);
  connect(this, qOverload<const QUrl&>(&QTextBrowser::highlighted), this,
          [this](const QUrl& link) { followLink(link.toString()); });
}

QList<EquationBrowser::Shown> EquationBrowser::shown() const {
  QList<Shown> all;
  for (QTextBlock block = document()->begin(); block.isValid(); block = block.next()) {
    for (auto it = block.begin(); !it.atEnd(); ++it) {
      const QTextFragment part = it.fragment();
      const QTextImageFormat format = part.charFormat().toImageFormat();
      if (!format.isValid() || !format.name().startsWith(scheme())) continue;
      const Equation* const equation = equationById(format.name().mid(scheme().size()));
      const QTextLine line = block.layout()->lineForTextPosition(part.position() - block.position());
      if (!equation) continue;
      QRectF rect;
      if (line.isValid()) {
        const double x = line.cursorToX(part.position() - block.position());
        // Alone in its line but for what nobody sees: the picture is as high as the line, or in its middle.
        const double y = line.y() + std::max(0.0, (line.height() - format.height()) / 2);
        rect = {document()->documentLayout()->blockBoundingRect(block).topLeft() + QPointF(x, y),
                QSizeF(format.width(), format.height())};
      }
      all.append({equation, rect, part.position()});
    }
  }
  return all;
}

double EquationBrowser::shareOf(const Equation& equation) const {
  const double em = kLarger * QFontInfo(font()).pixelSize();
  const double room = std::max(1.0, viewport()->width() - 2 * document()->documentMargin() - kIndent);
  return std::min(em / kEquationEm, room / equation.size.width());
}

/// The size of each picture, for the font and the width of the page.
void EquationBrowser::fit() {
  const int at = verticalScrollBar()->value();
  for (const Shown& s : shown()) {
    QTextCursor cursor(document());
    cursor.setPosition(s.at);
    cursor.setPosition(s.at + 1, QTextCursor::KeepAnchor);
    QTextImageFormat format = cursor.charFormat().toImageFormat();
    const double share = shareOf(*s.equation);
    const double width = std::round(share * s.equation->size.width()), height = std::round(share * s.equation->size.height());
    if (format.width() == width && format.height() == height) continue;
    format.setWidth(width);
    format.setHeight(height);
    cursor.setCharFormat(format);
  }
  verticalScrollBar()->setValue(at);
  paintEquations();
}

/// In the colours of now, as many pixels as the screen has for them.
void EquationBrowser::paintEquations() {
  const QColor ink = palette().color(QPalette::Text);
  for (const Shown& s : shown()) {
    const double share = shareOf(*s.equation) * devicePixelRatioF();
    const QSize pixels(std::max(1, int(std::lround(share * s.equation->size.width()))),
                       std::max(1, int(std::lround(share * s.equation->size.height()))));
    document()->addResource(QTextDocument::ImageResource, QUrl(scheme() + s.equation->id),
                            s.equation->image(pixels, ink, lit_, litColour()));
  }
  viewport()->update();
}

void EquationBrowser::showPage(const QString& html) {
  lit_.clear();
  pointed_.clear();
  linked_.clear();
  setHtml(html);
  hasEquations_ = !shown().isEmpty();
  fit();
  emit pageShown();
}

void EquationBrowser::setLit(const QSet<QString>& symbols) {
  if (symbols == lit_) return;
  lit_ = symbols;
  paintEquations();
}

QSet<QString> EquationBrowser::shownBy(const QString& layer, const QString& part) const {
  QSet<QString> found;
  for (const Shown& s : shown())
    for (const Equation::Place& place : s.equation->places)
      if (const EquationSymbol* const symbol = symbolById(place.symbol);
          symbol && (symbol->shows.contains(layer) || symbol->shows.contains(layer + '/' + part)))
        found.insert(symbol->id);
  return found;
}

QRectF EquationBrowser::placeOf(const QString& symbol) const {
  const QPointF scrolled(horizontalScrollBar()->value(), verticalScrollBar()->value());
  for (const Shown& s : shown())
    for (const Equation::Place& place : s.equation->places)
      if (place.symbol == symbol) {
        const double share = s.rect.width() / s.equation->size.width();
        return {s.rect.topLeft() - scrolled + share * place.box.topLeft(), share * place.box.size()};
      }
  return {};
}

QString EquationBrowser::symbolUnder(const QPoint& viewportPoint) const {
  const QPointF p = QPointF(viewportPoint) + QPointF(horizontalScrollBar()->value(), verticalScrollBar()->value());
  for (const Shown& s : shown())
    if (s.rect.contains(p)) return s.equation->symbolAt((p - s.rect.topLeft()) * (s.equation->size.width() / s.rect.width()));
  return {};
}

void EquationBrowser::point(const QString& symbol) {
  if (symbol == std::exchange(pointed_, symbol)) return;
  setLit(symbol.isEmpty() ? QSet<QString>() : QSet<QString>{symbol});
  emit symbolPointed(symbol);
}

/// The symbol of a number, or the one that a term names.
void EquationBrowser::followLink(const QString& link) {
  linked_.clear();
  if (link.startsWith(QLatin1String("symbol:"))) linked_ = link.mid(7);
  if (link.startsWith(QLatin1String("glossary:"))) {
    const QString word = link.mid(9);
    for (const Shown& s : shown())
      for (const Equation::Place& place : s.equation->places)
        if (const EquationSymbol* const symbol = symbolById(place.symbol); symbol && symbol->words.contains(word))
          linked_ = symbol->id;
  }
  point(linked_);
}

bool EquationBrowser::viewportEvent(QEvent* e) {
  if (e->type() == QEvent::Leave) point({});
  if (e->type() == QEvent::ToolTip) {
    const auto* help = static_cast<QHelpEvent*>(e);
    if (const EquationSymbol* const symbol = symbolById(symbolUnder(help->pos()))) {
      QToolTip::showText(help->globalPos(), symbol->name, this);
      return true;
    }
  }
  return QTextBrowser::viewportEvent(e);
}

void EquationBrowser::mouseMoveEvent(QMouseEvent* e) {
  QTextBrowser::mouseMoveEvent(e);  // first: it tells of links
  if (e->buttons() != Qt::NoButton) return;
  const QString symbol = symbolUnder(e->pos());
  point(symbol.isEmpty() && !anchorAt(e->pos()).isEmpty() ? linked_ : symbol);
}

void EquationBrowser::resizeEvent(QResizeEvent* e) {
  QTextBrowser::resizeEvent(e);
  fit();
}

void EquationBrowser::changeEvent(QEvent* e) {
  QTextBrowser::changeEvent(e);
  if (e->type() == QEvent::FontChange || e->type() == QEvent::StyleChange) fit();
  if (e->type() == QEvent::PaletteChange) paintEquations();
}

/// Equations in their plain form, which is behind each picture.
QMimeData* EquationBrowser::createMimeDataFromSelection() const {
  auto* data = new QMimeData;
  data->setText(textCursor().selection().toPlainText().remove(QChar::ObjectReplacementCharacter));
  return data;
}

}  // namespace glint::gui

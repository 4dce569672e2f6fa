// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QSet>
#include <QTextBrowser>

namespace glint::gui {

struct Equation;

/// A page of text with typeset equations, see equationHtml(): as large as its text, never wider than the page, in its ink. The
/// symbol under the pointer, that of a number or of a term (links "symbol:ID", "glossary:WORD") lights up wherever it is.
class EquationBrowser : public QTextBrowser {
  Q_OBJECT
 public:
  explicit EquationBrowser(QWidget* parent = nullptr);
  void showPage(const QString& html);
  const QSet<QString>& lit() const { return lit_; }
  bool hasEquations() const { return hasEquations_; }
  void setLit(const QSet<QString>& symbols);
  /// Symbols of the page's equations that the 3D view shows by a layer, or a part of it.
  QSet<QString> shownBy(const QString& layer, const QString& part) const;
  /// The first place of a symbol of the page's equations, in the viewport; empty = nowhere.
  QRectF placeOf(const QString& symbol) const;

 signals:
  void pageShown();
  void symbolPointed(const QString& symbol);  ///< "" = no longer any

 protected:
  bool viewportEvent(QEvent* e) override;
  void mouseMoveEvent(QMouseEvent* e) override;
  void resizeEvent(QResizeEvent* e) override;
  void changeEvent(QEvent* e) override;
  QMimeData* createMimeDataFromSelection() const override;

 private:
  struct Shown {
    const Equation* equation;
    QRectF rect;  ///< of the document
    int at;       ///< position of its character
  };
  QList<Shown> shown() const;
  double shareOf(const Equation& equation) const;  ///< px for each unit of its picture
  void fit();
  void paintEquations();
  QString symbolUnder(const QPoint& viewportPoint) const;
  void point(const QString& symbol);
  void followLink(const QString& link);

  QSet<QString> lit_;
  QString pointed_, linked_;
  bool hasEquations_ = false;
};

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QByteArray>
#include <QColor>
#include <QImage>
#include <QList>
#include <QPointF>
#include <QRectF>
#include <QSet>
#include <QSizeF>
#include <QString>
#include <QStringList>

namespace glint::gui {

/// A symbol of the equations, as resources/explain/equations.json has it.
struct EquationSymbol {
  QString id, notation, name;  ///< notation: its row in docs/NOTATION.md
  QStringList numbers;         ///< ExplainNumber::symbol that are its values
  QStringList words;           ///< of the glossary, that name it
  QStringList shows;           ///< in the 3D view: "layer", or "layer/part" as viz::Picked has it
};

/// An equation, typeset: docs/make_equations.py wrote its picture.
struct Equation {
  struct Place {
    QString symbol;  ///< EquationSymbol::id
    QRectF box;      ///< in units of the picture
  };
  QString id, plain;
  QByteArray svg;
  QSizeF size;  ///< units of the picture; kEquationEm of them are one em
  QList<Place> places;

  bool has(const QString& symbol) const;
  /// The symbol nearest to a point, not farther than a third of an em; "" = none.
  QString symbolAt(const QPointF& unit) const;
  /// In one ink, but for the symbols that are lit.
  QImage image(const QSize& pixels, const QColor& ink, const QSet<QString>& lit, const QColor& litInk) const;
};
constexpr double kEquationEm = 20;  ///< EM of docs/make_equations.py

/// Read once from the program's resources.
const QList<EquationSymbol>& equationSymbols();
const QList<Equation>& equations();
/// Null for one that is missing.
const Equation* equationById(const QString& id);
const EquationSymbol* symbolById(const QString& id);

/// An equation's picture in HTML for an EquationBrowser, and its plain form, too small to be seen, for searching, copying and
/// screen readers. What has no picture is in plain form. `base` is the colour of the page.
QString equationHtml(const QString& plain, const QColor& base);
/// HTML in which the plain forms of equations have become that.
QString withEquations(QString html, const QColor& base);

}  // namespace glint::gui

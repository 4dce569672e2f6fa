// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QByteArray>
#include <QColor>
#include <QImage>
#include <QString>

#include "core/draw/painter.h"
#include "gui/document/document.h"
#include "gui/export/figure_dialog.h"

class QPainter;

namespace glint::gui {

/// The background of a figure; not valid if it is transparent.
QColor backgroundOf(const FigureLook& look);
/// Height of a caption's letters, px: those of a caption on paper at the figure's resolution, and legible on a screen.
double captionPx(const FigureLook& look);
/// A caption to start from: what the figure shows, of which scene, with which models. @param what  "3D view"
QString proposedCaption(const Document& document, const QString& what);
/// An SVG picture of Qt's with its title and its caption as description. Qt's own ones are not escaped.
QByteArray withTitle(const QByteArray& svg, const QString& title, const QString& caption);

/// The caption of a figure, in the lower part of the size that was asked for.
class FigureCaption {
 public:
  explicit FigureCaption(const FigureLook& look);
  /// The look of the figure above: without caption, and lower by its height.
  FigureLook above() const;
  /// Paints the caption below the figure.
  void paint(QPainter& painter) const;
  /// The whole picture. @param figure  of the size of above()
  QImage under(const QImage& figure) const;

 private:
  FigureLook look_;
  draw::Caption caption_;
};

}  // namespace glint::gui

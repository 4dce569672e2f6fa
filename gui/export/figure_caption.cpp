// SPDX-License-Identifier: BSD-3-Clause
#include "gui/export/figure_caption.h"

#include <QPainter>
#include <algorithm>
#include <cmath>

#include "core/base/html_text.h"
#include "gui/base/qt_painter.h"
#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr double kCaptionPt = 9, kPtPerInch = 72;  // as journals set captions
constexpr double kLeastOfWidth = 1.0 / 90;         // on a slide letters of a paper's size would be too small
constexpr double kMostOfHeight = 0.5;              // a caption that is longer than its figure is high ends early
}  // namespace

QColor backgroundOf(const FigureLook& look) {
  if (look.transparent) return {};
  return look.dark ? QColor(0x1b, 0x1d, 0x20) : QColor(Qt::white);
}

double captionPx(const FigureLook& look) {
  return std::max(kCaptionPt / kPtPerInch * look.dpi, kLeastOfWidth * look.size.width());
}

QString proposedCaption(const Document& document, const QString& what) {
  const std::string& selected = document.selection().model;
  const QString models = selected.empty() ? joined(document.request().models) : toQString(selected);
  const QString scene = document.scene() ? nameText(document.scene()->name) : QString();
  if (models.isEmpty()) return QObject::tr("%1 of the scene %2.").arg(what, scene);
  const bool one = !selected.empty() || document.request().models.size() == 1;
  return (one ? QObject::tr("%1 of the scene %2; model: %3.") : QObject::tr("%1 of the scene %2; models: %3."))
      .arg(what, scene, models);
}

QByteArray withTitle(const QByteArray& svg, const QString& title, const QString& caption) {
  const auto element = [](const char* name, const QString& text) {
    const std::string escaped = html::escaped(text.toStdString());
    return text.isEmpty() ? std::string() : "<" + std::string(name) + ">" + escaped + "</" + name + ">\n";
  };
  const auto root = svg.indexOf('>', std::max(svg.indexOf("<svg"), decltype(svg.indexOf("<svg"))(0)));
  QByteArray all = svg;
  return all.insert(root + 1, QByteArray::fromStdString("\n" + element("title", title) + element("desc", caption)));
}

FigureCaption::FigureCaption(const FigureLook& look) : look_(look) {
  if (look_.caption.trimmed().isEmpty()) return;
  QImage any(1, 1, QImage::Format_RGB32);
  QPainter painter(&any);
  const QtPainter measure(painter);
  caption_ = draw::captionOf(measure, look_.caption.toStdString(), captionPx(look_), look_.size.width(),
                             kMostOfHeight * look_.size.height());
}

FigureLook FigureCaption::above() const {
  FigureLook figure = look_;
  figure.caption.clear();
  figure.size.rheight() -= int(std::ceil(caption_.height));
  return figure;
}

void FigureCaption::paint(QPainter& painter) const {
  if (caption_.lines.empty()) return;
  const int top = above().size.height();
  if (const QColor background = backgroundOf(look_); background.isValid())
    painter.fillRect(QRect(0, top, look_.size.width(), look_.size.height() - top), background);
  QtPainter into(painter);
  draw::paintCaption(into, caption_, top, look_.dark ? draw::kTextOnDark : draw::kTextOnLight);
}

QImage FigureCaption::under(const QImage& figure) const {
  if (caption_.lines.empty()) return figure;
  QImage all(look_.size, look_.transparent ? QImage::Format_ARGB32 : QImage::Format_RGB32);
  all.fill(Qt::transparent);
  QPainter painter(&all);
  painter.drawImage(0, 0, figure);
  paint(painter);
  return all;
}

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/equations.h"

#include <QFile>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QPainter>
#include <QRegularExpression>
#include <QSvgRenderer>
#include <algorithm>
#include <cmath>

static void initEquationsResource() { Q_INIT_RESOURCE(explain); }

namespace glint::gui {

namespace {
constexpr double kReach = kEquationEm / 3;  // a thin letter is hit beside its strokes

QJsonObject equationsJson() {
  initEquationsResource();
  QFile file(QStringLiteral(":/explain/equations.json"));
  return file.open(QIODevice::ReadOnly) ? QJsonDocument::fromJson(file.readAll()).object() : QJsonObject();
}

QStringList listOf(const QJsonValue& value) {
  QStringList all;
  for (const QJsonValue& v : value.toArray()) all << v.toString();
  return all;
}

/// "normal.2" is the second place of "normal".
QString symbolOf(const QString& element) { return element.section('.', 0, 0); }

Equation readEquation(const QJsonObject& o) {
  Equation e{o["id"].toString(), o["plain"].toString(), {}, {}, {}};
  QFile file(QStringLiteral(":/explain/equations/%1.svg").arg(e.id));
  if (!file.open(QIODevice::ReadOnly)) return e;
  e.svg = file.readAll();
  QSvgRenderer renderer(e.svg);
  e.size = renderer.viewBoxF().size();
  static const QRegularExpression group(QStringLiteral("<g id=\"([^\"]+)\">"));
  for (auto it = group.globalMatch(QString::fromUtf8(e.svg)); it.hasNext();) {
    const QString element = it.next().captured(1);
    e.places.append({symbolOf(element), renderer.boundsOnElement(element)});
  }
  return e;
}

double distanceTo(const QRectF& box, const QPointF& p) {
  const double x = std::max({box.left() - p.x(), 0.0, p.x() - box.right()});
  const double y = std::max({box.top() - p.y(), 0.0, p.y() - box.bottom()});
  return std::hypot(x, y);
}
}  // namespace

bool Equation::has(const QString& symbol) const {
  return std::any_of(places.begin(), places.end(), [&](const Place& place) { return place.symbol == symbol; });
}

QString Equation::symbolAt(const QPointF& unit) const {
  double nearest = kReach;
  QString found;
  for (const Place& place : places) {
    const double d = distanceTo(place.box, unit);
    if (d >= nearest) continue;
    nearest = d;
    found = place.symbol;
  }
  return found;
}

QImage Equation::image(const QSize& pixels, const QColor& ink, const QSet<QString>& lit, const QColor& litInk) const {
  QString drawn = QString::fromUtf8(svg);
  drawn.replace(QLatin1String("currentColor"), ink.name());
  for (const QString& symbol : lit)
    drawn.replace(QRegularExpression(QStringLiteral("<g id=\"(%1(\\.\\d+)?)\">").arg(QRegularExpression::escape(symbol))),
                  QStringLiteral("<g id=\"\\1\" fill=\"%1\">").arg(litInk.name()));
  QImage image(pixels, QImage::Format_ARGB32_Premultiplied);
  image.fill(Qt::transparent);
  QPainter painter(&image);
  QSvgRenderer(drawn.toUtf8()).render(&painter, QRectF(QPointF(), QSizeF(pixels)));
  return image;
}

const QList<EquationSymbol>& equationSymbols() {
  static const QList<EquationSymbol> all = [] {
    QList<EquationSymbol> read;
    for (const QJsonValue& v : equationsJson()["symbols"].toArray()) {
      const QJsonObject o = v.toObject();
      read.append({o["id"].toString(), o["notation"].toString(), o["name"].toString(), listOf(o["numbers"]), listOf(o["words"]),
                   listOf(o["shows"])});
    }
    return read;
  }();
  return all;
}

const QList<Equation>& equations() {
  static const QList<Equation> all = [] {
    QList<Equation> read;
    for (const QJsonValue& v : equationsJson()["equations"].toArray()) read.append(readEquation(v.toObject()));
    return read;
  }();
  return all;
}

const Equation* equationById(const QString& id) {
  const auto& all = equations();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Equation& e) { return e.id == id; });
  return found == all.end() ? nullptr : &*found;
}

const EquationSymbol* symbolById(const QString& id) {
  const auto& all = equationSymbols();
  const auto found = std::find_if(all.begin(), all.end(), [&](const EquationSymbol& s) { return s.id == id; });
  return found == all.end() ? nullptr : &*found;
}

QString equationHtml(const QString& plain, const QColor& base) {
  const QString text = plain.toHtmlEscaped();
  for (const Equation& e : equations())
    if (e.plain == plain && !e.size.isEmpty())
      return QStringLiteral(
                 "<tt><img src='equation:%1' style='vertical-align:middle'>"
                 "<span style='font-size:1px; color:%2'>%3</span></tt>")
          .arg(e.id, base.name(), text);
  return QStringLiteral("<tt>%1</tt>").arg(text);
}

QString withEquations(QString html, const QColor& base) {
  for (const Equation& e : equations()) html.replace(e.plain.toHtmlEscaped(), equationHtml(e.plain, base));
  return html;
}

}  // namespace glint::gui

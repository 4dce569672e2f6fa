// SPDX-License-Identifier: BSD-3-Clause
// The errors of the timeline: lines of all models or bars of one, and above them a row for frames where a highlight was missed
// (cross) or is spurious (triangle).
#include <QPainter>
#include <QPainterPath>
#include <algorithm>
#include <cmath>

#include "core/draw/frame_overlay.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/document/frame_roles.h"
#include "gui/timeline/timeline_strip.h"
#include "viz/style.h"

namespace glint::gui {

namespace {
constexpr double kMissedLine = 6, kLeastMissedRow = 12;  // px: height of a model's crosses; of their row with its name
constexpr double kRoomForName = 34;                      // height of the chart, px
constexpr double kTwoTexts = 22, kThreeTexts = 36;       // height of the errors, px, that has room for so many texts beside it
constexpr double kBesideChart = 5;                       // px between a text and the chart
constexpr double kTinyPx = 9;                            // the word "missed"
}  // namespace

bool TimelineStrip::marksMissed(const viz::TimelineData::Series& series) const {
  if (bars_ && series.model != plotted_) return false;
  // A model that answers nowhere has no line either; its crosses would fill the row.
  if (!bars_ && data_.series.size() > 1 && !series.answers()) return false;
  for (std::size_t i = 0; i < series.missed.size(); ++i)
    if ((series.missed[i] || series.spurious[i]) && document_.role(int(i)) != FrameRole::Excluded) return true;
  return false;
}

QRectF TimelineStrip::missedRow() const {
  const QRectF c = chart();
  const auto models = std::count_if(data_.series.begin(), data_.series.end(), [this](const auto& s) { return marksMissed(s); });
  if (models == 0) return QRectF(c.topLeft(), QSizeF(c.width(), 0));
  return QRectF(c.left(), c.top(), c.width(),
                std::min(std::max(kLeastMissedRow * scale_, double(models) * kMissedLine), c.height() / 3));
}

QStringList TimelineStrip::axisTexts() const {
  const auto percent = [](double value) { return numberText(value) + QStringLiteral(" %"); };
  if (axis_.logarithmic) return {percent(axis_.highPct), percent(axis_.lowPct), tr("log")};
  return {percent(axis_.highPct), QStringLiteral("0")};
}

bool TimelineStrip::axisFits() const {
  const QFontMetricsF metrics(smallFont());
  const QStringList texts = axisTexts();
  return metrics.height() <= lineHeight() && std::all_of(texts.begin(), texts.end(), [&](const QString& text) {
           return metrics.horizontalAdvance(text) <= chart().left() - kBesideChart;
         });
}

int TimelineStrip::columns() const { return int(std::min(inView_, chart().width())); }

bool TimelineStrip::perFrame() const { return columns() >= int(inView_); }

double TimelineStrip::middleX(int i) const {
  return perFrame() ? frameX(i + 0.5) : frameX(first_ + (i + 0.5) * inView_ / columns());
}

/// A cross for each frame, or column of frames, where a model missed a highlight: it has no error there. A triangle where one is
/// spurious.
void TimelineStrip::paintMissed(QPainter& painter) {
  const QRectF row = missedRow();
  if (row.height() <= 0) return;
  painter.setClipRect(row.adjusted(0, -1, 0, 0));
  std::vector<const viz::TimelineData::Series*> marked;
  for (const viz::TimelineData::Series& series : data_.series)
    if (marksMissed(series)) marked.push_back(&series);
  painter.setBrush(Qt::NoBrush);
  const double line = row.height() / double(marked.size()), r = std::clamp(0.5 * line - 0.75, 1.0, 3.0);
  for (std::size_t k = 0; k < marked.size(); ++k) {
    QColor colour = toQColor(draw::modelColour(marked[k]->model, marked[k]->poor));
    if (badge_->marks()) colour.setAlpha(90);
    painter.setPen(QPen(colour, 1.5));
    const auto shownOf = [&](std::vector<char> marks) {
      for (const int frame : shownExcluded(document_))
        if (frame >= 0 && frame < int(marks.size())) marks[std::size_t(frame)] = 0;
      return perFrame() ? marks : viz::columnMarks(marks, first_, first_ + inView_, columns());
    };
    const std::vector<char> shown = shownOf(marked[k]->missed), spurious = shownOf(marked[k]->spurious);
    for (int i = 0; i < int(shown.size()); ++i) {
      if (!shown[std::size_t(i)] && !spurious[std::size_t(i)]) continue;
      const QPointF at(middleX(i), row.top() + (double(k) + 0.5) * line);
      if (spurious[std::size_t(i)]) {
        const double half = r + (shown[std::size_t(i)] ? 1.5 : 0.5);  // around the cross, where there is one
        const QPointF corners[] = {at + QPointF(-half, half), at + QPointF(half, half), at + QPointF(0, -half)};
        painter.drawPolygon(corners, 3);
      }
      if (!shown[std::size_t(i)]) continue;
      painter.drawLine(at - QPointF(r, r), at + QPointF(r, r));
      painter.drawLine(at + QPointF(-r, r), at + QPointF(r, -r));
    }
  }
  painter.setClipping(false);
  if (chart().height() < kRoomForName * scale_) return;
  painter.setPen(palette().color(QPalette::PlaceholderText));
  const QFont usual = painter.font();
  QFont tiny = usual;
  tiny.setPixelSize(int(kTinyPx * scale_));
  painter.setFont(tiny);
  painter.drawText(QRectF(0, row.top() - 2, chart().left() - kBesideChart, kLeastMissedRow * scale_),
                   Qt::AlignRight | Qt::AlignVCenter, tr("missed"));
  painter.setFont(usual);
}

void TimelineStrip::paintErrors(QPainter& painter) {
  QRectF c = chart();
  const QPen grid(palette().color(QPalette::Mid), 1, Qt::DotLine);
  painter.setPen(grid);
  painter.drawLine(c.topLeft(), c.topRight());
  painter.setPen(palette().color(QPalette::Mid));
  painter.drawLine(c.bottomLeft(), c.bottomRight());
  if (data_.series.empty()) return;
  painter.setRenderHint(QPainter::Antialiasing);
  paintMissed(painter);
  painter.setRenderHint(QPainter::Antialiasing, false);
  c.setTop(missedRow().bottom());
  if (missedRow().height() > 0) {
    painter.setPen(grid);
    painter.drawLine(c.topLeft(), c.topRight());
  }
  paintAxisTexts(painter, c);
  painter.setClipRect(c.adjusted(0, -2, 0, 1));
  QColor excluded = toQColor(draw::kExcluded);
  excluded.setAlpha(70);
  for (const int frame : shownExcluded(document_))
    painter.fillRect(QRectF(frameX(frame), c.top(), std::max(1.0, frameX(frame + 1) - frameX(frame)), c.height()), excluded);
  painter.setRenderHint(QPainter::Antialiasing);
  for (const viz::TimelineData::Series& series : data_.series) {
    if (bars_ && series.model != plotted_) continue;
    QColor colour = toQColor(draw::modelColour(series.model, series.poor));
    if (badge_->marks()) colour.setAlpha(90);
    std::vector<std::optional<double>> shown = series.errorPct;
    for (const int frame : shownExcluded(document_))
      if (frame >= 0 && frame < int(shown.size())) shown[std::size_t(frame)].reset();
    // Per frame where there is room, else the largest error of each screen column.
    if (!perFrame()) shown = viz::columnMaxima(shown, first_, first_ + inView_, columns());
    const auto place = [&](int i) {
      return QPointF(middleX(i), c.bottom() - std::max(1.0, c.height() * axis_.place(*shown[std::size_t(i)])));
    };
    std::vector<std::optional<QPointF>> points;
    for (int i = 0; i < int(shown.size()); ++i) points.push_back(shown[std::size_t(i)] ? std::optional(place(i)) : std::nullopt);
    if (bars_)
      paintBars(painter, series, points, colour, c);
    else
      paintLine(painter, series, points, colour);
  }
  painter.setClipping(false);
}

/// Beside the errors, which have the chart's rectangle without the row of missed ones.
void TimelineStrip::paintAxisTexts(QPainter& painter, const QRectF& errors) {
  painter.setPen(palette().color(QPalette::PlaceholderText));
  const QStringList texts = axisTexts();
  const auto write = [&](const QString& text, double middle) {
    painter.drawText(QRectF(0, middle - lineHeight() / 2, errors.left() - kBesideChart, lineHeight()),
                     Qt::AlignRight | Qt::AlignVCenter, text);
  };
  // The label stands below the line if the word "missed" is above it.
  const bool named = missedRow().height() > 0 && chart().height() >= kRoomForName * scale_;
  const double lower = named ? lineHeight() / 2 : 0;
  write(texts[0], errors.top() + lower);
  if (errors.height() > kTwoTexts * scale_ + lower) write(texts[1], errors.bottom() + 1 - lineHeight() / 2);
  if (texts.size() > 2 && errors.height() > kThreeTexts * scale_ + lower) write(texts[2], errors.center().y());
}

void TimelineStrip::paintBars(QPainter& painter, const viz::TimelineData::Series& series,
                              const std::vector<std::optional<QPointF>>& tops, const QColor& colour, const QRectF& errors) {
  const double slot = errors.width() / (perFrame() ? inView_ : columns()), wide = std::clamp(slot - 2, std::min(1.0, slot), 14.0);
  for (int i = 0; i < int(tops.size()); ++i) {
    const std::optional<QPointF>& top = tops[std::size_t(i)];
    if (top) painter.fillRect(QRectF(top->x() - wide / 2, top->y(), wide, errors.bottom() - top->y()), colour);
    const bool unsaid = !top && perFrame() && !series.missed[std::size_t(i)] && !series.reason[std::size_t(i)].empty();
    if (unsaid && document_.role(i) != FrameRole::Excluded && slot > 8) {
      painter.setPen(warningColour());
      painter.drawText(QRectF(middleX(i) - 10, errors.bottom() - 15, 20, 14), Qt::AlignCenter, QStringLiteral("?"));
    }
  }
}

void TimelineStrip::paintLine(QPainter& painter, const viz::TimelineData::Series& series,
                              const std::vector<std::optional<QPointF>>& points, const QColor& colour) {
  QPainterPath path;
  bool down = false;
  for (const std::optional<QPointF>& at : points) {
    if (at && down)
      path.lineTo(*at);
    else if (at)
      path.moveTo(*at - QPointF(1, 0)), path.lineTo(*at + QPointF(1, 0));  // a lone frame is seen too
    down = at.has_value();
  }
  painter.strokePath(
      path, QPen(colour, series.model == document_.selection().model ? 2.4 : 1.2, series.poor ? Qt::DashLine : Qt::SolidLine));
}

}  // namespace glint::gui

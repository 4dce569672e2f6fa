// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/tradeoff_panel.h"

#include <QHBoxLayout>
#include <QHelpEvent>
#include <QLabel>
#include <QMouseEvent>
#include <QPainter>
#include <QPushButton>
#include <QToolTip>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "core/model/model.h"
#include "gui/base/focus_frame.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"

namespace glint::gui {

namespace {

constexpr double kTitle = 15;  // height of the y axis' title, which is written upwards
constexpr double kLeft = 62 + kTitle, kRight = 16, kTop = 10, kBottom = 36;
constexpr double kReachPx = 12;             // of a click
constexpr double kSmallestErrorPct = 1e-6;  // what a logarithmic axis shows of an exact scene

double errorOf(const TradeoffPoint& p) { return std::max(p.rankedErrorPct, kSmallestErrorPct); }

QString namesOf(const Tradeoff& t, int point) {
  QStringList names;
  for (const char* name : {"fast", "balanced", "exact"})
    if (const auto it = t.presets.find(name); it != t.presets.end() && it->second == point) names << QLatin1String(name);
  return names.join(QStringLiteral(", "));
}

}  // namespace

/// Decimal logarithms at the ends of both axes, and where they are drawn.
struct TradeoffPlot::Axes {
  double x0 = 0, x1 = 1, y0 = 0, y1 = 1;
  QRectF area;
  bool valid = false;
  double x(double us) const { return area.left() + area.width() * (std::log10(us) - x0) / (x1 - x0); }
  double y(double pct) const { return area.bottom() - area.height() * (std::log10(pct) - y0) / (y1 - y0); }
};

TradeoffPlot::TradeoffPlot(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  setObjectName(QStringLiteral("tradeoffPlot"));
  setFocusPolicy(Qt::StrongFocus);
  new FocusFrame(this);
  setMouseTracking(true);
  connect(&document_, &Document::tradeoffChanged, this, [this] {
    current_ = -1;
    update();
  });
  connect(&document_, &Document::requestChanged, this, [this] { update(); });
}

TradeoffPlot::Axes TradeoffPlot::axes() const {
  Axes a;
  a.area = QRectF(kLeft, kTop, width() - kLeft - kRight, height() - kTop - kBottom);
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  if (!t) return a;
  for (const TradeoffPoint& p : t->points) {
    if (!std::isfinite(p.rankedErrorPct) || !(p.predictUs > 0)) continue;
    const double x = std::log10(p.predictUs), y = std::log10(errorOf(p));
    a.x0 = a.valid ? std::min(a.x0, x) : x;
    a.x1 = a.valid ? std::max(a.x1, x) : x;
    a.y0 = a.valid ? std::min(a.y0, y) : y;
    a.y1 = a.valid ? std::max(a.y1, y) : y;
    a.valid = true;
  }
  const double dx = std::max(0.15, 0.05 * (a.x1 - a.x0)), dy = std::max(0.15, 0.08 * (a.y1 - a.y0));
  a.x0 -= dx;
  a.x1 += dx;
  a.y0 -= dy;
  a.y1 += dy;
  return a;
}

std::optional<QPointF> TradeoffPlot::positionOf(int point) const {
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  if (!t || point < 0 || point >= int(t->points.size())) return std::nullopt;
  const TradeoffPoint& p = t->points[std::size_t(point)];
  const Axes a = axes();
  if (!a.valid || !std::isfinite(p.rankedErrorPct) || !(p.predictUs > 0)) return std::nullopt;
  return QPointF(a.x(p.predictUs), a.y(errorOf(p)));
}

int TradeoffPlot::pointAt(const QPointF& place) const {
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  int best = -1;
  double nearest = kReachPx;
  for (int i = 0; t && i < int(t->points.size()); ++i) {
    const std::optional<QPointF> p = positionOf(i);
    if (!p) continue;
    const double d = std::hypot(p->x() - place.x(), p->y() - place.y());
    if (d < nearest) nearest = d, best = i;
  }
  return best;
}

void TradeoffPlot::load(int point) {
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  if (!t || point < 0 || point >= int(t->points.size())) return;
  const TradeoffPoint& p = t->points[std::size_t(point)];
  document_.load(p, tr("Load %1").arg(toQString(describe(*t, p))));
}

QString TradeoffPlot::message() const {
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  if (!document_.scene()) return tr("No scene");
  if (t) return axes().valid ? QString() : withMicro(toQString(t->reason));
  return measuring_ ? tr("Measuring; the status bar shows progress. Esc stops; \"Measure\" continues from there")
                    : tr("Not measured yet: \"Measure\" tests models and settings on these frames");
}

void TradeoffPlot::setMeasuring(bool measuring) {
  measuring_ = measuring;
  update();
}

void TradeoffPlot::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  const QColor faded = palette().color(QPalette::PlaceholderText), text = palette().color(QPalette::Text);
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  const Axes a = axes();
  if (!t || !a.valid) {
    painter.setPen(faded);
    painter.drawText(rect().adjusted(20, 0, -20, 0), Qt::AlignCenter | Qt::TextWordWrap, message());
    return;
  }
  QFont small = font();
  small.setPointSizeF(font().pointSizeF() * 0.85);
  painter.setFont(small);
  const auto ticks = [](double from, double to) {
    std::vector<double> all;
    for (double d = std::floor(from); d <= to; ++d)
      for (const double m : {1.0, 2.0, 5.0}) {
        if (m > 1 && to - from > 2.2) continue;
        const double v = m * std::pow(10, d);
        if (std::log10(v) >= from && std::log10(v) <= to) all.push_back(v);
      }
    return all;
  };
  QColor grid = palette().color(QPalette::Mid);
  grid.setAlpha(110);
  for (const double v : ticks(a.y0, a.y1)) {
    painter.setPen(QPen(grid, 1, Qt::DotLine));
    painter.drawLine(QPointF(a.area.left(), a.y(v)), QPointF(a.area.right(), a.y(v)));
    painter.setPen(faded);
    painter.drawText(QRectF(kTitle, a.y(v) - 7, kLeft - kTitle - 5, 14), Qt::AlignRight | Qt::AlignVCenter,
                     numberText(v) + QStringLiteral(" %"));
  }
  for (const double v : ticks(a.x0, a.x1)) {
    painter.setPen(QPen(grid, 1, Qt::DotLine));
    painter.drawLine(QPointF(a.x(v), a.area.top()), QPointF(a.x(v), a.area.bottom()));
    painter.setPen(faded);
    painter.drawText(QRectF(a.x(v) - 40, a.area.bottom() + 2, 80, 14), Qt::AlignCenter, numberText(v));
  }
  painter.setPen(faded);
  painter.drawText(QRectF(a.area.left(), height() - 17, a.area.width(), 15), Qt::AlignCenter, tr("microseconds per frame"));
  painter.save();
  painter.rotate(-90);
  const QString title = tr("contour error");
  painter.drawText(QRectF(-a.area.bottom(), 1, a.area.height(), kTitle), Qt::AlignCenter,
                   painter.fontMetrics().elidedText(title, Qt::ElideRight, int(a.area.height())));
  painter.restore();

  painter.setRenderHint(QPainter::Antialiasing);
  QPolygonF front;
  for (int i = 0; i < int(t->points.size()); ++i) {
    const std::optional<QPointF> p = positionOf(i);
    if (!p || !t->points[std::size_t(i)].pareto) continue;
    if (!front.isEmpty()) front << QPointF(p->x(), front.last().y());  // until then the error before is the best to be had
    front << *p;
  }
  if (!front.isEmpty()) front << QPointF(a.area.right(), front.last().y());
  painter.setPen(QPen(faded, 1.2, Qt::DashLine));
  painter.drawPolyline(front);

  for (const bool onFront : {false, true})
    for (int i = 0; i < int(t->points.size()); ++i) {
      const TradeoffPoint& point = t->points[std::size_t(i)];
      const std::optional<QPointF> p = positionOf(i);
      if (!p || point.pareto != onFront) continue;
      const QColor colour = toQColor(draw::modelColour(point.model));
      painter.setPen(QPen(colour, 1.6));
      painter.setBrush(onFront ? QBrush(colour) : QBrush(Qt::NoBrush));
      const double r = onFront ? 5 : 4;
      painter.drawEllipse(*p, r, r);
      painter.setBrush(Qt::NoBrush);
      if (document_.isLoaded(point)) {
        painter.setPen(QPen(text, 1.8));
        painter.drawEllipse(*p, 9, 9);
      }
      if (i == current_) {
        painter.setPen(QPen(accentColour(), 1.8));
        painter.drawEllipse(*p, 7, 7);
      }
    }
  painter.setPen(text);
  for (const auto& [point, place] : presetNames()) painter.drawText(place, Qt::AlignCenter, namesOf(*t, point));
}

std::map<int, QRectF> TradeoffPlot::presetNames() const {
  constexpr double kHigh = 14, kBeside = 11, kDot = 6;
  constexpr int kRows = 4;  // farther, a name would not be seen as its point's
  std::map<int, QRectF> names;
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  if (!t) return names;
  QFont small = font();
  small.setPointSizeF(font().pointSizeF() * 0.85);
  const QFontMetrics metrics(small);
  const QRectF area = axes().area.adjusted(0, -kTop, kRight, 0);
  std::map<int, QPointF> dots;
  for (int i = 0; i < int(t->points.size()); ++i)
    if (const std::optional<QPointF> p = positionOf(i); p && !namesOf(*t, i).isEmpty()) dots[i] = *p;
  const auto isFree = [&](const QRectF& r) {
    return area.contains(r) &&
           std::none_of(names.begin(), names.end(), [&](const auto& other) { return other.second.intersects(r); }) &&
           std::none_of(dots.begin(), dots.end(), [&](const auto& dot) {
             return r.intersects(QRectF(dot.second - QPointF(kDot, kDot), dot.second + QPointF(kDot, kDot)));
           });
  };
  // Beside its point: above to the right first, then below and to the left, then in rows farther away.
  for (const auto& [i, dot] : dots) {
    const double wide = metrics.horizontalAdvance(namesOf(*t, i)) + 2;
    for (int row = 0; row < kRows && !names.count(i); ++row)
      for (const double y : {dot.y() - 18 - row * kHigh, dot.y() + 4 + row * kHigh})
        for (const double x : {dot.x() + kBeside, dot.x() - kBeside - wide})
          if (const QRectF place(x, y, wide, kHigh); !names.count(i) && isFree(place)) names[i] = place;
  }
  return names;
}

void TradeoffPlot::mousePressEvent(QMouseEvent* e) {
  if (e->button() == Qt::LeftButton) load(pointAt(e->localPos()));
}

void TradeoffPlot::mouseMoveEvent(QMouseEvent* e) {
  const int at = pointAt(e->localPos());
  setCursor(at >= 0 ? Qt::PointingHandCursor : Qt::ArrowCursor);
  if (at == current_) return;
  current_ = at;
  update();
}

void TradeoffPlot::leaveEvent(QEvent*) {
  current_ = -1;
  update();
}

void TradeoffPlot::moveAlongFront(int by) {
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  if (!t) return;
  int start = current_;
  for (int i = 0; start < 0 && i < int(t->points.size()); ++i)
    if (document_.isLoaded(t->points[std::size_t(i)])) start = i;
  if (start < 0 && by < 0) start = int(t->points.size());
  for (int i = start + by; i >= 0 && i < int(t->points.size()); i += by)
    if (t->points[std::size_t(i)].pareto) {
      current_ = i;
      break;
    }
  update();
}

void TradeoffPlot::keyPressEvent(QKeyEvent* e) {
  switch (e->key()) {
    case Qt::Key_Left:
      return moveAlongFront(-1);
    case Qt::Key_Right:
      return moveAlongFront(1);
    case Qt::Key_Return:
    case Qt::Key_Enter:
      return load(current_);
    default:
      QWidget::keyPressEvent(e);
  }
}

bool TradeoffPlot::event(QEvent* e) {
  if (e->type() != QEvent::ToolTip) return QWidget::event(e);
  const auto* help = static_cast<QHelpEvent*>(e);
  const int i = pointAt(help->pos());
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  if (i < 0) {
    QToolTip::hideText();
    return true;
  }
  const TradeoffPoint& p = t->points[std::size_t(i)];
  showTip(help->globalPos(),
          tr("%1\nerror %2 %, IoU %3, coverage %4, %5 of %6 frames predicted\n%7 µs per frame, fit %8 ms, peak memory %9 "
             "MB\nClick to "
             "load")
              .arg(toQString(describe(*t, p)), numberText(p.contourErrorPct, 3), numberText(p.iou, 4), numberText(p.coverage, 3))
              .arg(p.predicted)
              .arg(p.frames)
              .arg(numberText(p.predictUs, 4), numberText(p.fitUs * 1e-3, 3), numberText(p.peakMb, 4)),
          this);
  return true;
}

TradeoffPanel::TradeoffPanel(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(6, 2, 0, 2);
  row->setSpacing(6);
  auto* column = new QVBoxLayout;
  measure_ = new QPushButton(tr("Measure"));
  measure_->setObjectName(QStringLiteral("measureTradeoff"));
  measure_->setToolTip(
      tr("Tests models and settings on these frames and plots error against time.\nEsc stops; nothing on screen changes "
         "until the measurement is done"));
  column->addWidget(measure_);
  presets_ = new QWidget;
  auto* presets = new QVBoxLayout(presets_);
  presets->setContentsMargins(0, 4, 0, 0);
  presets->setSpacing(3);
  for (const char* name : {"fast", "balanced", "exact"}) {
    auto* b = new QPushButton(QLatin1String(name));
    b->setObjectName(QStringLiteral("preset_%1").arg(QLatin1String(name)));
    connect(b, &QPushButton::clicked, this, [this, name = std::string(name)] {
      const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
      if (t && t->presets.count(name)) plot_->load(t->presets.at(name));
    });
    presets->addWidget(b);
  }
  column->addWidget(presets_);
  column->addStretch(1);
  row->addLayout(column);
  auto* right = new QVBoxLayout;
  right->setSpacing(2);
  plot_ = new TradeoffPlot(document);
  right->addWidget(plot_, 1);
  sentence_ = new QLabel;
  sentence_->setObjectName(QStringLiteral("tradeoffSentence"));
  sentence_->setProperty("role", "faded");
  sentence_->setWordWrap(true);
  sentence_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  right->addWidget(sentence_);
  row->addLayout(right, 1);
  connect(measure_, &QPushButton::clicked, this, [this] {
    plot_->setMeasuring(true);
    emit measureRequested();
  });
  connect(&document_, &Document::tradeoffChanged, this, &TradeoffPanel::refresh);
  connect(&document_, &Document::requestChanged, this, &TradeoffPanel::refresh);
  connect(&document_, &Document::sceneOpened, this, &TradeoffPanel::refresh);
  refresh();
}

void TradeoffPanel::setBusy(bool busy) {
  busy_ = busy;
  if (!busy) plot_->setMeasuring(false);
  refresh();
}

void TradeoffPanel::refresh() {
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  measure_->setEnabled(document_.scene() && !busy_);
  presets_->setEnabled(t && !t->presets.empty());
  for (const auto& name : {"fast", "balanced", "exact"}) {
    auto* b = presets_->findChild<QPushButton*>(QStringLiteral("preset_%1").arg(QLatin1String(name)));
    b->setToolTip(t && t->presets.count(name) ? toQString(describe(*t, t->points[std::size_t(t->presets.at(name))])) : QString());
  }
  QString words = t ? withMicro(toQString(t->reason)) : QString();
  if (t && document_.scene() && t->trainSpec != document_.request().train)
    words += tr(" (Measured on training frames %1.)").arg(toQString(t->trainSpec));
  sentence_->setText(words);
  sentence_->setVisible(!words.isEmpty());
}

}  // namespace glint::gui

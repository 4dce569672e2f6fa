// SPDX-License-Identifier: BSD-3-Clause
#include "gui/timeline/timeline.h"

#include <QComboBox>
#include <QContextMenuEvent>
#include <QHBoxLayout>
#include <QHelpEvent>
#include <QLabel>
#include <QMenu>
#include <QMouseEvent>
#include <QPainter>
#include <QSignalBlocker>
#include <QToolButton>
#include <QToolTip>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "viz/frame_overlay.h"

namespace glint::gui {

namespace {
constexpr double kLeft = 52, kRight = 10, kTop = 8, kMarkRow = 18, kNumberRow = 14;
constexpr double kNiceScales[] = {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100};
constexpr int kPlayMs = 120;
}  // namespace

TimelineStrip::TimelineStrip(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  setFocusPolicy(Qt::StrongFocus);
  setMouseTracking(true);
  const auto reread = [this] { readErrors(); };
  connect(&document_, &Document::sceneOpened, this, reread);
  connect(&document_, &Document::inspectionChanged, this, reread);
  connect(&document_, &Document::selectionChanged, this, reread);
  connect(&document_, &Document::requestChanged, this, reread);
  connect(&document_, &Document::staleChanged, this, reread);
}

QRectF TimelineStrip::chart() const {
  return QRectF(kLeft, kTop, width() - kLeft - kRight, height() - kTop - kMarkRow - kNumberRow);
}

QRectF TimelineStrip::cell(int frame) const {
  const QRectF c = chart();
  const double w = c.width() / std::max(1, document_.frameCount());
  return QRectF(c.left() + frame * w, c.top(), w, height() - kTop);
}

int TimelineStrip::frameAt(const QPointF& position) const {
  const QRectF c = chart();
  const int n = document_.frameCount();
  if (n == 0 || position.x() < c.left() || position.x() >= c.right()) return -1;
  return std::clamp(int((position.x() - c.left()) / c.width() * n), 0, n - 1);
}

void TimelineStrip::readErrors() {
  bars_.assign(std::size_t(document_.frameCount()), {});
  double largest = 0;
  if (const std::shared_ptr<const Inspection> inspection = document_.inspection()) {
    const auto model = inspection->models.find(document_.plottedModel());
    for (int i = 0; model != inspection->models.end() && i < int(bars_.size()); ++i) {
      const viz::FrameScore score = viz::frameScore(model->second, i);
      bars_[std::size_t(i)] = {score.errorPct, toQString(score.reason)};
      if (score.errorPct && document_.role(i) != FrameRole::Excluded) largest = std::max(largest, *score.errorPct);
    }
  }
  const auto* nice = std::find_if(std::begin(kNiceScales), std::end(kNiceScales), [&](double s) { return s >= largest; });
  scalePct_ = nice == std::end(kNiceScales) ? 100 : *nice;
  update();
}

void TimelineStrip::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  const int n = document_.frameCount();
  const QColor faded = palette().color(QPalette::PlaceholderText), text = palette().color(QPalette::Text);
  if (n == 0) {
    painter.setPen(faded);
    painter.drawText(rect(), Qt::AlignCenter, tr("No frames"));
    return;
  }
  QFont small = font();
  small.setPointSizeF(font().pointSizeF() * 0.85);
  painter.setFont(small);
  const QRectF c = chart();
  painter.setPen(QPen(palette().color(QPalette::Mid), 1, Qt::DotLine));
  painter.drawLine(c.topLeft(), c.topRight());
  painter.setPen(palette().color(QPalette::Mid));
  painter.drawLine(c.bottomLeft(), c.bottomRight());
  painter.setPen(faded);
  painter.drawText(QRectF(0, c.top() - 7, kLeft - 5, 14), Qt::AlignRight | Qt::AlignVCenter,
                   numberText(scalePct_) + QStringLiteral(" %"));
  painter.drawText(QRectF(0, c.bottom() - 7, kLeft - 5, 14), Qt::AlignRight | Qt::AlignVCenter, QStringLiteral("0"));

  const QRectF current = cell(document_.selection().frame).adjusted(0, -4, 0, -1);
  painter.fillRect(current, QColor(accentColour().red(), accentColour().green(), accentColour().blue(), 70));

  painter.setRenderHint(QPainter::Antialiasing);
  QColor bar = toQColor(viz::modelColour(document_.plottedModel()));
  if (document_.stale()) bar.setAlpha(90);
  const int labelEvery = std::max(1, int(std::ceil(34 / cell(0).width())));
  for (int i = 0; i < n; ++i) {
    const QRectF box = cell(i);
    const double barWidth = std::clamp(box.width() - 2, std::min(1.0, box.width()), 14.0);
    const FrameRole role = document_.role(i);
    const Bar& b = bars_[std::size_t(i)];
    if (b.errorPct && role != FrameRole::Excluded) {
      const double h = std::max(1.0, c.height() * std::min(1.0, *b.errorPct / scalePct_));
      painter.fillRect(QRectF(box.center().x() - barWidth / 2, c.bottom() - h, barWidth, h), bar);
    } else if (!b.reason.isEmpty() && role != FrameRole::Excluded) {
      painter.setPen(warningColour());
      painter.drawText(QRectF(box.center().x() - 10, c.bottom() - 16, 20, 14), Qt::AlignCenter, QStringLiteral("?"));
    }
    const QPointF mark(box.center().x(), c.bottom() + kMarkRow / 2);
    const double r = std::clamp(box.width() / 2 - 1, 1.0, 4.5);
    if (role == FrameRole::Training) {
      painter.fillRect(QRectF(mark - QPointF(r, r), mark + QPointF(r, r)), toQColor(viz::kTraining).lighter(130));
    } else if (role == FrameRole::HeldOut) {
      painter.setPen(QPen(toQColor(viz::kHeldOut), 1.3));
      painter.drawEllipse(mark, r - 0.5, r - 0.5);
    } else {
      painter.setPen(QPen(errorColour(), 1.5));
      painter.drawLine(mark - QPointF(r, r), mark + QPointF(r, r));
      painter.drawLine(mark + QPointF(-r, r), mark + QPointF(r, -r));
    }
    if (i % labelEvery == 0) {
      painter.setPen(i == document_.selection().frame ? text : faded);
      painter.drawText(QRectF(box.center().x() - 30, height() - kNumberRow - 1, 60, kNumberRow), Qt::AlignCenter,
                       QString::number(i));
    }
  }
}

void TimelineStrip::step(int by) {
  const int n = document_.frameCount();
  if (n > 0) document_.selectFrame(std::clamp(document_.selection().frame + by, 0, n - 1));
}

void TimelineStrip::mousePressEvent(QMouseEvent* e) {
  if (e->button() != Qt::LeftButton) return;
  gesture_ = document_.newGesture();
  if (const int frame = frameAt(e->pos()); frame >= 0) document_.selectFrame(frame, gesture_);
}

void TimelineStrip::mouseMoveEvent(QMouseEvent* e) {
  if (!(e->buttons() & Qt::LeftButton)) return;
  if (const int frame = frameAt(e->pos()); frame >= 0) document_.selectFrame(frame, gesture_);
}

void TimelineStrip::contextMenuEvent(QContextMenuEvent* e) {
  const int frame = frameAt(e->pos());
  if (frame < 0) return;
  QMenu menu(this);
  const FrameRole role = document_.role(frame);
  const auto add = [&](FrameRole r, const QString& text) {
    QAction* action = menu.addAction(text, this, [this, frame, r] { document_.setRole(frame, r); });
    action->setCheckable(true);
    action->setChecked(role == r);
  };
  add(FrameRole::Training, tr("Train on frame %1").arg(frame));
  add(FrameRole::HeldOut, tr("Hold out frame %1").arg(frame));
  add(FrameRole::Excluded, tr("Exclude frame %1").arg(frame));
  menu.exec(e->globalPos());
}

void TimelineStrip::keyPressEvent(QKeyEvent* e) {
  const int n = document_.frameCount();
  switch (e->key()) {
    case Qt::Key_Left:
      return step(-1);
    case Qt::Key_Right:
      return step(1);
    case Qt::Key_Home:
      return step(-n);
    case Qt::Key_End:
      return step(n);
    case Qt::Key_T:
      return document_.setRole(document_.selection().frame, FrameRole::Training);
    case Qt::Key_O:
      return document_.setRole(document_.selection().frame, FrameRole::HeldOut);
    case Qt::Key_X:
      return document_.setRole(document_.selection().frame, FrameRole::Excluded);
    default:
      QWidget::keyPressEvent(e);
  }
}

bool TimelineStrip::event(QEvent* e) {
  if (e->type() != QEvent::ToolTip) return QWidget::event(e);
  const auto* help = static_cast<QHelpEvent*>(e);
  const int frame = frameAt(help->pos());
  if (frame < 0) {
    QToolTip::hideText();
    return true;
  }
  const Bar& b = bars_[std::size_t(frame)];
  static const char* const roles[] = {QT_TR_NOOP("training"), QT_TR_NOOP("held out"), QT_TR_NOOP("excluded")};
  QString text = tr("Frame %1 (%2), %3")
                     .arg(frame)
                     .arg(toQString(document_.scene()->frames[std::size_t(frame)].id), tr(roles[int(document_.role(frame))]));
  if (b.errorPct)
    text += tr("\n%1: %2 %").arg(toQString(document_.plottedModel()), numberText(*b.errorPct, 3));
  else if (!b.reason.isEmpty())
    text += QStringLiteral("\n%1: %2").arg(toQString(document_.plottedModel()), b.reason);
  QToolTip::showText(help->globalPos(), text, this);
  return true;
}

Timeline::Timeline(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(6, 2, 0, 2);
  row->setSpacing(6);
  auto* controls = new QVBoxLayout;
  auto* buttons = new QHBoxLayout;
  buttons->setSpacing(2);
  const auto button = [&](const char* iconName, const QString& tip, const char* name) {
    auto* b = new QToolButton;
    b->setObjectName(QLatin1String(name));
    b->setIcon(icon(QLatin1String(iconName)));
    b->setToolTip(tip);
    b->setAutoRaise(true);
    buttons->addWidget(b);
    return b;
  };
  auto* back = button("previous", tr("Previous frame (Left)"), "previousFrame");
  auto* play = button("play", tr("Play (P)"), "play");
  auto* next = button("next", tr("Next frame (Right)"), "nextFrame");
  auto* model = new QComboBox;
  model->setObjectName(QStringLiteral("plottedModel"));
  model->setIconSize({11, 11});
  model->setToolTip(tr("Model whose error is plotted"));
  model->setSizeAdjustPolicy(QComboBox::AdjustToContents);
  controls->addStretch(1);
  controls->addLayout(buttons);
  controls->addWidget(model);
  controls->addStretch(1);
  row->addLayout(controls);
  strip_ = new TimelineStrip(document);
  strip_->setObjectName(QStringLiteral("timelineStrip"));
  row->addWidget(strip_, 1);

  connect(back, &QToolButton::clicked, strip_, [this] { strip_->step(-1); });
  connect(next, &QToolButton::clicked, strip_, [this] { strip_->step(1); });
  connect(play, &QToolButton::clicked, this, [this] { setPlaying(!playing()); });
  connect(this, &Timeline::playingChanged, play,
          [play](bool on) { play->setIcon(icon(on ? QStringLiteral("pause") : QStringLiteral("play"))); });
  clock_.setInterval(kPlayMs);
  connect(&clock_, &QTimer::timeout, this, [this] {
    const int n = document_.frameCount();
    if (n > 0) document_.selectFrame((document_.selection().frame + 1) % n, gesture_);
  });
  const auto listModels = [this, model] {
    const QSignalBlocker blocker(model);
    model->clear();
    for (const std::string& m : document_.request().models)
      model->addItem(colourSwatch(toQColor(viz::modelColour(m))), toQString(m));
    model->setCurrentIndex(model->findText(toQString(document_.plottedModel())));
  };
  connect(&document_, &Document::sceneOpened, model, listModels);
  connect(&document_, &Document::requestChanged, model, listModels);
  connect(&document_, &Document::selectionChanged, model, listModels);
  connect(model, QOverload<int>::of(&QComboBox::activated), this, [this, model](int i) {
    viz::Selection s = document_.selection();
    s.model = model->itemText(i).toStdString();
    document_.select(s);
  });
  listModels();
}

void Timeline::setPlaying(bool playing) {
  if (playing == this->playing()) return;
  gesture_ = document_.newGesture();
  if (playing)
    clock_.start();
  else
    clock_.stop();
  emit playingChanged(playing);
}

void Timeline::addActions(Actions& actions, QMenu* menu) {
  actions.add("frame.previous", menu, tr("&Previous"), [this] { strip_->step(-1); }, {{QKeySequence("Alt+Left")}, "previous"});
  actions.add("frame.next", menu, tr("&Next"), [this] { strip_->step(1); }, {{QKeySequence("Alt+Right")}, "next"});
  actions.add("frame.play", menu, tr("P&lay"), [this] { setPlaying(!playing()); }, {{Qt::Key_P}, "play"});
  menu->addSeparator();
  const auto role = [&](const char* id, const QString& text, FrameRole r) {
    actions.add(QLatin1String(id), menu, text, [this, r] { document_.setRole(document_.selection().frame, r); });
  };
  role("frame.train", tr("&Train on it"), FrameRole::Training);
  role("frame.hold-out", tr("&Hold it out"), FrameRole::HeldOut);
  role("frame.exclude", tr("E&xclude it"), FrameRole::Excluded);
}

}  // namespace glint::gui

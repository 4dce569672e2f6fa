// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/tradeoff_panel.h"

#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

#include "core/draw/plots.h"
#include "gui/base/focus_frame.h"
#include "gui/base/text.h"

namespace glint::gui {

TradeoffPlot::TradeoffPlot(Document& document, QWidget* parent) : PlotCanvas(parent), document_(document) {
  setObjectName(QStringLiteral("tradeoffPlot"));
  setFocusPolicy(Qt::StrongFocus);
  new FocusFrame(this);
  connect(&document_, &Document::tradeoffChanged, this, [this] {
    current_ = -1;
    refresh();
  });
  connect(&document_, &Document::sceneOpened, this, &TradeoffPlot::refresh);
  connect(&document_, &Document::requestChanged, this, &TradeoffPlot::mark);
  connect(this, &PlotCanvas::clicked, this, [this](const draw::PlotTarget& target) { load(target.setting); });
  refresh();
}

void TradeoffPlot::refresh() {
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  draw::PlotData data;
  if (t) data = draw::tradeoffPlot(*t);
  if (!t || !data.empty.empty()) data.empty = message().toStdString();
  show(data);
  mark();
}

/// The setting that is loaded, and the one that keys reached.
void TradeoffPlot::mark() {
  std::vector<draw::PlotSample> marked;
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  for (int i = 0; t && i < int(t->points.size()); ++i)
    if (i == current_ || document_.isLoaded(t->points[std::size_t(i)]))
      if (const std::optional<draw::PlotSample> sample = sampleOf(i)) marked.push_back(*sample);
  setMarked(marked);
}

std::optional<draw::PlotSample> TradeoffPlot::sampleOf(int setting) const {
  const std::vector<draw::PlotSeries>& all = plot().series;
  for (int s = 0; s < int(all.size()); ++s) {
    if (all[std::size_t(s)].shape != draw::PlotShape::Points) continue;  // the front repeats them
    const std::vector<draw::PlotPoint>& points = all[std::size_t(s)].points;
    for (int p = 0; p < int(points.size()); ++p)
      if (points[std::size_t(p)].target.setting == setting) return draw::PlotSample{s, p};
  }
  return std::nullopt;
}

std::optional<QPointF> TradeoffPlot::placeOf(int setting) const {
  const std::optional<draw::PlotSample> sample = sampleOf(setting);
  return sample ? positionOf(*sample) : std::nullopt;
}

void TradeoffPlot::load(int setting) {
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  if (!t || setting < 0 || setting >= int(t->points.size())) return;
  const TradeoffPoint& p = t->points[std::size_t(setting)];
  document_.load(p, tr("Load %1").arg(toQString(describe(*t, p))));
}

QString TradeoffPlot::message() const {
  const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
  if (!document_.scene()) return tr("No scene");
  if (t) return draw::tradeoffPlot(*t).empty.empty() ? QString() : withMicro(toQString(t->reason));
  return measuring_ ? tr("Measuring; the status bar shows progress. Esc stops; \"Measure\" continues from there")
                    : tr("Not measured yet: \"Measure\" tests models and settings on these frames");
}

void TradeoffPlot::setMeasuring(bool measuring) {
  measuring_ = measuring;
  refresh();
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
  mark();
}

void TradeoffPlot::keyPressEvent(QKeyEvent* e) {
  switch (e->key()) {
    case Qt::Key_Left: return moveAlongFront(-1);
    case Qt::Key_Right: return moveAlongFront(1);
    case Qt::Key_Return:
    case Qt::Key_Enter: return load(current_);
    default: PlotCanvas::keyPressEvent(e);
  }
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
    const bool known = t && t->presets.count(name);
    const QString names = known ? toQString(presetNames(*t, t->presets.at(name))) : QLatin1String(name);
    b->setText(names);
    b->setVisible(names.startsWith(QLatin1String(name)));  // presets that are one setting share the first one's button
    b->setToolTip(known ? toQString(describe(*t, t->points[std::size_t(t->presets.at(name))])) : QString());
  }
  QString words = t ? withMicro(toQString(t->reason)) : QString();
  if (t)
    if (const QString note = toQString(presetNote(*t)); !note.isEmpty()) words += QStringLiteral(" ") + note;
  if (t && document_.scene() && t->trainSpec != document_.request().train)
    words += tr(" (Measured on training frames %1.)").arg(toQString(trainedOn(*t)));
  sentence_->setText(words);
  sentence_->setVisible(!words.isEmpty());
}

}  // namespace glint::gui

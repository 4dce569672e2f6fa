// SPDX-License-Identifier: BSD-3-Clause
#include "gui/lamps/lamps_panel.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QVBoxLayout>
#include <algorithm>

#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/tips.h"
#include "gui/lamps/lamp_table.h"

namespace glint::gui {

namespace {

constexpr int kMostWarnings = 3;  // as many lines as leave room for the table in a low dock

QPushButton* button(const QString& text, const char* name, const QString& tip) {
  auto* b = new QPushButton(text);
  b->setObjectName(QLatin1String(name));
  b->setToolTip(tip);
  return b;
}

QString summaryOf(const LampsReport& report) {
  const auto of = [&](auto&& is) { return std::count_if(report.lamps.begin(), report.lamps.end(), is); };
  const auto positions = of([](const LampAnswer& l) { return !l.failure && l.position; });
  const auto failed = of([](const LampAnswer& l) { return l.failure.has_value(); });
  const auto all = std::ptrdiff_t(report.lamps.size());
  QStringList parts;
  if (positions > 0) parts << QObject::tr("%1 with a position").arg(positions);
  if (const auto directions = all - positions - failed; directions > 0)
    parts << QObject::tr("%1 with a direction").arg(directions);
  if (failed > 0) parts << QObject::tr("%1 without an answer").arg(failed);
  return all == 0
             ? QObject::tr("No frame names or shows a lamp")
             : QObject::tr("%1: %2").arg(all == 1 ? QObject::tr("1 lamp") : QObject::tr("%1 lamps").arg(all), parts.join(", "));
}

}  // namespace

LampsPanel::LampsPanel(QWidget* parent) : QWidget(parent), table_(new LampTable), summary_(new QLabel), warnings_(new QLabel) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 0);
  column->setSpacing(4);
  auto* row = new QHBoxLayout;
  measure_ = button(tr("Measure"), "measureLamps",
                    tr("Finds where the lamps are, from all highlights of every frame that is not excluded.\n"
                       "The true lights that a scene may hold are not read."));
  stop_ = button(tr("Stop"), "stopLamps", tr("Stops measuring; what was measured before stays"));
  save_ = button(tr("Save…"), "saveLamps",
                 tr("Writes the lamps as JSON, as a table (CSV) or as light positions for RTI programs (.lp)"));
  bar_ = new QProgressBar;
  bar_->setAccessibleName(tr("Progress of measuring lamps"));
  bar_->setMaximumWidth(220);
  summary_->setObjectName(QStringLiteral("lampsSummary"));
  for (QWidget* w : std::initializer_list<QWidget*>{measure_, stop_, bar_, summary_}) row->addWidget(w);
  row->addStretch(1);
  row->addWidget(save_);
  column->addLayout(row);
  warnings_->setObjectName(QStringLiteral("lampsWarnings"));
  warnings_->setProperty("role", "warning");
  warnings_->setTextFormat(Qt::PlainText);
  warnings_->setWordWrap(true);
  warnings_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  column->addWidget(warnings_);
  column->addWidget(table_, 1);
  stale_ = new StaleBadge(table_, Qt::BottomRightCorner);
  stale_->setUpdating(false);
  connect(measure_, &QPushButton::clicked, this, &LampsPanel::measureRequested);
  connect(stop_, &QPushButton::clicked, this, &LampsPanel::stopRequested);
  connect(save_, &QPushButton::clicked, this, &LampsPanel::saveRequested);
  show(nullptr, tr("Open a scene to measure its lamps."));
  refresh();
}

void LampsPanel::show(const LampsReport* report, const QString& why) {
  known_ = report != nullptr;
  summary_->setText(report ? summaryOf(*report) : why);
  QStringList lines;
  for (std::size_t i = 0; report && i < report->warnings.size(); ++i) lines << toQString(report->warnings[i]);
  warnings_->setToolTip(plainTip(lines.join('\n')));
  if (const qsizetype more = lines.size() - kMostWarnings; more > 0)  // the table stays in sight
    lines = lines.mid(0, kMostWarnings) << tr("and %1 more: see the table's last column").arg(more);
  warnings_->setText(lines.join('\n'));
  warnings_->setVisible(!lines.isEmpty());
  table_->show(report);
  refresh();
}

void LampsPanel::setStale(bool stale) { stale_->setStale(stale); }

void LampsPanel::setPossible(bool possible) {
  possible_ = possible;
  refresh();
}

void LampsPanel::setBusy(bool busy) {
  busy_ = busy;
  if (busy) setProgress(tr("starting"), 0, 0);
  refresh();
}

void LampsPanel::setProgress(const QString& stage, int done, int total) {
  bar_->setRange(0, std::max(1, total));  // not the moving stripes of an unknown length
  bar_->setValue(done);
  bar_->setFormat(total > 0 ? tr("%1 %2/%3").arg(stage).arg(done).arg(total) : stage);
}

void LampsPanel::refresh() {
  measure_->setEnabled(possible_ && !busy_);
  stop_->setVisible(busy_);
  bar_->setVisible(busy_);
  summary_->setVisible(!busy_);
  save_->setEnabled(known_ && !busy_);
}

}  // namespace glint::gui

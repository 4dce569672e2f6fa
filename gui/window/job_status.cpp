// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/job_status.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QToolButton>
#include <initializer_list>
#include <utility>

#include "gui/base/stale_badge.h"
#include "gui/base/theme.h"

namespace glint::gui {

namespace {
/// What a stage does, where the name that core gives it does not say so.
QString stageWords(const QString& stage) {
  if (stage == QLatin1String("hash")) return QObject::tr("checking input files");
  if (stage == QLatin1String("detect")) return QObject::tr("finding highlights");
  if (stage == QLatin1String("lobe")) return QObject::tr("fitting reflectance (the slowest model)");
  return stage;
}

constexpr int kShownAfterMs = 200;  // what ends sooner would only flicker, and take the time of laying out and painting
}  // namespace

JobStatus::JobStatus(Document& document, Runner& runner, QWidget* parent)
    : QWidget(parent), document_(document), runner_(runner) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 6, 0);
  row->setSpacing(6);
  text_ = new QLabel;
  text_->setObjectName(QStringLiteral("jobText"));
  text_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  row->addWidget(text_);
  bar_ = new QProgressBar;
  bar_->setFixedSize(140, 12);
  bar_->setTextVisible(false);
  bar_->setAccessibleName(tr("Progress"));
  row->addWidget(bar_);
  stop_ = new QToolButton;
  stop_->setObjectName(QStringLiteral("stop"));
  stop_->setIcon(icon(QStringLiteral("stop")));
  stop_->setIconSize({12, 12});
  stop_->setAutoRaise(true);
  stop_->setToolTip(tr("Stop (Esc)"));
  row->addWidget(stop_);
  connect(stop_, &QToolButton::clicked, &runner_, &Runner::cancel);
  for (QWidget* widget : std::initializer_list<QWidget*>{bar_, stop_}) {
    QSizePolicy keepsItsPlace = widget->sizePolicy();
    keepsItsPlace.setRetainSizeWhenHidden(true);
    widget->setSizePolicy(keepsItsPlace);
  }
  soon_.setSingleShot(true);
  soon_.setInterval(kShownAfterMs);
  connect(&soon_, &QTimer::timeout, this, &JobStatus::refresh);
  const auto changed = [this] {
    const bool ended = bar_->isVisible() && !runner_.busy();  // stopped, perhaps: results stay out of date
    if (!ended && (runner_.busy() || document_.stale()) && document_.inspection()) {
      if (!soon_.isActive() && !bar_->isVisible()) soon_.start();
    } else {
      soon_.stop();
      refresh();
    }
  };
  connect(&runner_, &Runner::busyChanged, this, changed);
  connect(&document_, &Document::staleChanged, this, changed);
  connect(&document_, &Document::inspectionChanged, this, changed);
  connect(&runner_, &Runner::busyChanged, this, &JobStatus::markBadges);
  connect(&document_, &Document::staleChanged, this, [this](bool stale) {
    if (!stale) markBadges();  // else a run begins, and tells
  });
  connect(&document_, &Document::sceneOpened, this, &JobStatus::refresh);
  connect(&runner_, &Runner::progressed, this, [this](const QString& stage, int done, int total) {
    if (!bar_->isVisible()) return;
    const QString words = stageWords(stage);
    text_->setText(total > 0 ? tr("%1 %2/%3").arg(words).arg(done).arg(total) : words);
    bar_->setRange(0, total);
    bar_->setValue(done);
  });
  refresh();
}

void JobStatus::changeEvent(QEvent* e) {
  QWidget::changeEvent(e);
  if (e->type() == QEvent::PaletteChange && text_ && !runner_.busy()) refresh();  // its colour is the theme's
}

void JobStatus::markBadges() {
  // A run that ends and leaves what is on screen out of date was stopped, or has failed.
  const bool now = runner_.busy() || !document_.stale();
  if (now == std::exchange(updating_, now)) return;  // every step of a slider comes here
  for (StaleBadge* badge : window()->findChildren<StaleBadge*>()) badge->setUpdating(now);
}

void JobStatus::refresh() {
  const bool busy = runner_.busy();
  bar_->setVisible(busy);
  stop_->setVisible(busy);
  if (busy) {
    bar_->setRange(0, 1);  // not the moving stripes of an unknown length: they would paint the window all the time
    bar_->setValue(0);
    text_->setText(tr("working…"));
    text_->setStyleSheet(QString());
  } else if (document_.scene() && document_.stale()) {
    text_->setText(document_.inspection() ? tr("results are out of date") : tr("no results"));
    text_->setStyleSheet(QStringLiteral("color: %1").arg(warningColour().name()));
  } else {
    text_->setText(document_.scene() ? tr("up to date") : QString());
    text_->setStyleSheet(QString());
  }
}

}  // namespace glint::gui

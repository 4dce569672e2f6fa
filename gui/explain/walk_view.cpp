// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/walk_view.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QPainter>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>

#include "gui/base/picture_access.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/explain/paint_picture.h"
#include "viz/walk_picture.h"

namespace glint::gui {

/// Paints what viz says.
class WalkView::Picture : public QWidget {
 public:
  explicit Picture(const WalkPlayer& player) : player_(player) { setMinimumSize(170, 190); }

 protected:
  void paintEvent(QPaintEvent*) override {
    QPainter painter(this);
    painter.fillRect(rect(), palette().color(QPalette::Base));
    if (!player_.story()) {
      painter.setPen(palette().color(QPalette::PlaceholderText));
      painter.drawText(rect().adjusted(12, 8, -12, -8), Qt::AlignCenter | Qt::TextWordWrap,
                       player_.problem().isEmpty() ? QString() : tr("No walk here: %1").arg(player_.problem()));
      return;
    }
    const viz::WalkPicture picture = viz::walkPicture(*player_.story(), player_.step(), width(), height(),
                                                      QFontMetricsF(font()).height(), currentTheme() == Theme::Dark);
    paintPicture(painter, picture, font());
  }

 private:
  const WalkPlayer& player_;
};

WalkView::WalkView(Document& document, WalkPlayer& player, QWidget* parent)
    : QWidget(parent),
      document_(document),
      player_(player),
      picture_(new Picture(player)),
      play_(new QToolButton),
      slider_(new QSlider(Qt::Horizontal)),
      where_(new QLabel) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(4);
  column->addWidget(picture_, 1);
  describePicture(picture_, tr("Walk of the limit angle in section"), [this] {
    if (!player_.story()) return player_.problem().isEmpty() ? tr("No walk") : tr("No walk here: %1").arg(player_.problem());
    return tr("Step %1: on the surface S and, beside it, on the tangent plane T").arg(where_->text());
  });
  auto* row = new QHBoxLayout;
  row->setSpacing(6);
  play_->setObjectName(QStringLiteral("explain.play"));
  play_->setIconSize({14, 14});
  slider_->setObjectName(QStringLiteral("explain.walk-step"));
  slider_->setAccessibleName(tr("Progress of the walk"));
  slider_->setToolTip(tr("Progress of the walk: on S to the limit angle, on T to the same angle"));
  row->addWidget(play_);
  row->addWidget(slider_, 1);
  row->addWidget(where_);
  column->addLayout(row);
  connect(play_, &QToolButton::clicked, &player_, &WalkPlayer::toggle);
  // One drag is one step of undo.
  connect(slider_, &QSlider::sliderPressed, this, [this] { gesture_ = document_.newGesture(); });
  connect(slider_, &QSlider::sliderReleased, this, [this] { gesture_ = 0; });
  connect(slider_, &QSlider::valueChanged, this, [this](int value) { player_.setStep(value, gesture_); });
  connect(&player_, &WalkPlayer::changed, this, &WalkView::refresh);
  refresh();
}

void WalkView::changeEvent(QEvent* e) {
  if (e->type() == QEvent::PaletteChange) picture_->update();
  QWidget::changeEvent(e);
}

void WalkView::refresh() {
  const auto story = player_.story();
  const QSignalBlocker quiet(slider_);
  slider_->setRange(0, story ? story->steps() - 1 : 0);
  slider_->setValue(player_.step());
  slider_->setEnabled(story != nullptr);
  play_->setEnabled(story != nullptr);
  play_->setIcon(icon(player_.playing() ? QStringLiteral("pause") : QStringLiteral("play")));
  play_->setToolTip(player_.playing() ? tr("Pause (W)") : tr("Play walk (W)"));
  where_->setText(story ? tr("%1 of %2").arg(player_.step() + 1).arg(story->steps()) : QString());
  picture_->update();
}

}  // namespace glint::gui

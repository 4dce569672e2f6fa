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

#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "viz/walk_picture.h"

namespace glint::gui {

namespace {
Qt::PenStyle penStyle(draw::Dash dash) {
  switch (dash) {
    case draw::Dash::Solid: return Qt::SolidLine;
    case draw::Dash::Dashed: return Qt::DashLine;
    case draw::Dash::DashDotted: return Qt::DashDotLine;
    case draw::Dash::Dotted: break;
  }
  return Qt::DotLine;
}
}  // namespace

/// Paints what viz says.
class WalkView::Picture : public QWidget {
 public:
  explicit Picture(const WalkPlayer& player) : player_(player) { setMinimumSize(170, 190); }

 protected:
  void paintEvent(QPaintEvent*) override {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.fillRect(rect(), palette().color(QPalette::Base));
    QFont plain = font(), strong = font();
    strong.setBold(true);
    if (!player_.story()) {
      painter.setPen(palette().color(QPalette::PlaceholderText));
      painter.drawText(rect().adjusted(12, 8, -12, -8), Qt::AlignCenter | Qt::TextWordWrap,
                       player_.problem().isEmpty() ? QString() : tr("No walk here: %1").arg(player_.problem()));
      return;
    }
    const QFontMetricsF metrics(plain);
    const viz::WalkPicture picture =
        viz::walkPicture(*player_.story(), player_.step(), width(), height(), metrics.height(), currentTheme() == Theme::Dark);
    for (const auto& line : picture.lines) {
      QPolygonF points;
      for (const Eigen::Vector2d& p : line.points) points << QPointF(p.x(), p.y());
      QColor colour = toQColor(line.colour);
      if (line.filled) {
        colour.setAlphaF(0.45);
        painter.setPen(Qt::NoPen);
        painter.setBrush(colour);
        painter.drawPolygon(points);
        continue;
      }
      painter.setBrush(Qt::NoBrush);
      painter.setPen(QPen(colour, line.width, penStyle(line.dash), Qt::RoundCap, Qt::RoundJoin));
      painter.drawPolyline(points);
    }
    for (const auto& dot : picture.dots) {
      painter.setPen(Qt::NoPen);
      painter.setBrush(toQColor(dot.colour));
      painter.drawEllipse(QPointF(dot.at.x(), dot.at.y()), dot.radius, dot.radius);
    }
    for (const auto& text : picture.texts) {
      painter.setFont(text.strong ? strong : plain);
      painter.setPen(toQColor(text.colour));
      const QString s = toQString(text.text);
      const double w = QFontMetricsF(painter.font()).horizontalAdvance(s);
      const double x = text.at.x() - (text.align == draw::Align::Left ? 0 : text.align == draw::Align::Centre ? w / 2 : w);
      painter.drawText(QPointF(x, text.at.y()), s);
    }
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
  auto* row = new QHBoxLayout;
  row->setSpacing(6);
  play_->setObjectName(QStringLiteral("explain.play"));
  play_->setIconSize({14, 14});
  slider_->setObjectName(QStringLiteral("explain.walk-step"));
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

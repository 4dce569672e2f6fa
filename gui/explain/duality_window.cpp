// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/duality_window.h"

#include <QEvent>
#include <QKeyEvent>
#include <QLabel>
#include <QMouseEvent>
#include <QPainter>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/explain/paint_picture.h"

namespace glint::gui {

namespace {
constexpr QSize kDualitySize(980, 620);  // px: two panes in which single planes can be told apart
constexpr QPoint kBesideText(40, 90);    // px in the main window: what explains stands on its right
constexpr double kRadPerPx = 0.008;      // a drag across a pane is half a turn
constexpr double kMostTilt = 1.4;        // rad: beyond, left and right would change sides
}  // namespace

/// Paints what viz says, and tells what the pointer is over.
class DualityWindow::Picture : public QWidget {
 public:
  explicit Picture(DualityWindow& window) : window_(window) {
    setMouseTracking(true);
    setFocusPolicy(Qt::StrongFocus);
    setMinimumSize(360, 260);
    setObjectName(QStringLiteral("duality.picture"));
    setAccessibleName(DualityWindow::tr("Tangent planes and their dual points"));
    setAccessibleDescription(
        DualityWindow::tr("Left and right: next plane. Up and down: next view. The text below says what is lit."));
  }

 protected:
  void paintEvent(QPaintEvent*) override {
    QPainter painter(this);
    painter.fillRect(rect(), palette().color(QPalette::Base));
    if (window_.duality_) return paintPicture(painter, window_.picture().drawn, font());
    painter.setPen(palette().color(QPalette::PlaceholderText));
    painter.drawText(rect().adjusted(24, 8, -24, -8), Qt::AlignCenter | Qt::TextWordWrap, window_.why_);
  }
  void mouseMoveEvent(QMouseEvent* e) override {
    if (e->buttons() & Qt::LeftButton) {
      window_.turn_ += kRadPerPx * (e->pos().x() - last_.x());
      window_.tilt_ = std::clamp(window_.tilt_ + kRadPerPx * (e->pos().y() - last_.y()), -kMostTilt, kMostTilt);
      last_ = e->pos();
      return update();
    }
    if (!window_.duality_) return;
    const auto found = viz::planeAt(window_.picture(), {double(e->pos().x()), double(e->pos().y())});
    window_.light(found.value_or(viz::DualityPlane()));
  }
  void mousePressEvent(QMouseEvent* e) override {
    last_ = e->pos();
    setFocus();
  }
  void leaveEvent(QEvent* e) override {
    QWidget::leaveEvent(e);
    window_.light({});
  }

 private:
  DualityWindow& window_;
  QPoint last_;
};

DualityWindow::DualityWindow(Document& document, QWidget* parent)
    : QDialog(parent), document_(document), picture_(new Picture(*this)), subject_(new QLabel), words_(new QLabel) {
  setObjectName(QStringLiteral("duality"));
  setWindowTitle(tr("Primal and dual side by side"));
  setModal(false);
  resize(kDualitySize);
  if (parent) move(parent->mapToGlobal(kBesideText));
  auto* column = new QVBoxLayout(this);
  subject_->setObjectName(QStringLiteral("duality.subject"));
  words_->setObjectName(QStringLiteral("duality.words"));
  words_->setWordWrap(true);
  words_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  words_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
  column->addWidget(subject_);
  column->addWidget(picture_, 1);
  connect(&document_, &Document::staleChanged, new StaleBadge(picture_), &StaleBadge::setStale);
  column->addWidget(words_);
  for (const auto signal : {&Document::inspectionChanged, &Document::selectionChanged, &Document::sceneOpened})
    connect(&document_, signal, this, [this] {
      if (isVisible()) refresh();
    });
}

void DualityWindow::open() {
  show();
  raise();
  activateWindow();
  picture_->setFocus();
}

QWidget* DualityWindow::canvas() const { return picture_; }

void DualityWindow::showEvent(QShowEvent* e) {
  QDialog::showEvent(e);
  if (!e->spontaneous()) lit_ = {};  // opened: one reads first what the planes are
  frame_ = document_.selection().frame;
  refresh();
}

void DualityWindow::hideEvent(QHideEvent* e) {
  QDialog::hideEvent(e);
  emit litChanged();
}

void DualityWindow::refresh() {
  duality_.reset();
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!inspection || inspection->scene->frames.empty()) {
    why_ = document_.scene() ? tr("No results yet") : tr("No scene");
  } else {
    const draw::Selection& s = document_.selection();
    const int frame = std::clamp(s.frame, 0, int(inspection->scene->frames.size()) - 1);
    Outcome<Duality> found = dualityOf(*inspection, frame, s.light, s.model);
    if (found)
      duality_ = std::move(*found);
    else
      why_ = tr("No ellipsoid to show here: %1").arg(toQString(found.failure().message()));
  }
  const auto has = [this](const viz::DualityPlane& p) {
    return duality_ && p.view < int(duality_->views.size()) &&
           (p.view < 0 || p.plane < int(duality_->views[std::size_t(p.view)].planes.size()));
  };
  if (!has(lit_)) lit_ = {};
  // Another training frame: its plane in the place of the one that was lit. Frames without a cone leave it.
  const int frame = document_.selection().frame;
  if (const int view = viewOf(frame); std::exchange(frame_, frame) != frame && view >= 0) {
    lit_ = {view, std::max(lit_.plane, 0)};
    if (!has(lit_)) lit_.plane = 0;
  }
  picture_->update();
  showWords();
  emit litChanged();
}

/// -1 = none.
int DualityWindow::viewOf(int frame) const {
  for (std::size_t i = 0; duality_ && i < duality_->views.size(); ++i)
    if (duality_->views[i].frame == frame) return int(i);
  return -1;
}

/// That of the selected frame, else the first.
int DualityWindow::strongView() const { return duality_ ? std::max(0, viewOf(document_.selection().frame)) : -1; }

void DualityWindow::showPicked(const viz::Picked& picked) {
  if (!isVisible() || !duality_ || picked.frame < 0) return;
  if (const auto found = viz::planeNearest(*duality_, picked.frame, picked.position)) light(*found);
}

void DualityWindow::showWords() {
  if (!duality_) {
    subject_->clear();
    return words_->setText({});
  }
  const int view = lit_.view >= 0 ? lit_.view : strongView();
  const std::string& frame = document_.scene()->frames[std::size_t(duality_->views[std::size_t(view)].frame)].id;
  subject_->setText(
      tr("Model %1, %2: %3 views, seen from their %4. Dual points y = ρ² n / h about the ellipsoid’s centre, ρ = %5 mm.")
          .arg(toQString(duality_->model), lightText(duality_->light))
          .arg(duality_->views.size())
          .arg(duality_->views.front().mirrored ? tr("virtual cameras") : tr("cameras"))
          .arg(1000 * duality_->chart.radius, 0, 'g', 3));
  QString words = toQString(viz::dualityWords(*duality_, lit_, frame));
  if (lit_.view < 0) words += tr(" Point at a plane or a point, click a cone in 3D, or use the arrow keys; drag to turn both.");
  words_->setText(words);
  words_->setMinimumHeight(5 * fontMetrics().lineSpacing());  // the panes keep their size while the words change
}

viz::DualityPicture DualityWindow::picture() const {
  viz::DualityLook look;
  look.turn = turn_;
  look.tilt = tilt_;
  look.frame = document_.selection().frame;
  look.lit = lit_;
  look.width = picture_->width();
  look.height = picture_->height();
  look.textPx = QFontMetricsF(picture_->font()).height();
  look.dark = currentTheme() == Theme::Dark;
  return viz::dualityPicture(*duality_, look);
}

void DualityWindow::light(const viz::DualityPlane& plane) {
  if (plane == lit_) return;
  lit_ = plane;
  picture_->update();
  showWords();
  emit litChanged();
}

void DualityWindow::keyPressEvent(QKeyEvent* e) {
  const int by = e->key() == Qt::Key_Right || e->key() == Qt::Key_Down ? 1 : -1;
  const bool along = e->key() == Qt::Key_Left || e->key() == Qt::Key_Right;
  if (!duality_ || !(along || e->key() == Qt::Key_Up || e->key() == Qt::Key_Down)) return QDialog::keyPressEvent(e);
  const int views = int(duality_->views.size());
  const int view = lit_.view >= 0 ? lit_.view : strongView();
  const int planes = int(duality_->views[std::size_t(view)].planes.size());
  if (lit_.view < 0) return light({view, 0});
  if (along) return light({view, (lit_.plane + by + planes) % planes});
  light({(view + by + views) % views, lit_.plane});
}

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/complaint.h"

#include <QKeyEvent>
#include <QLabel>
#include <QPointer>
#include <QTimer>
#include <algorithm>

#include "gui/base/theme.h"

namespace glint::gui {

namespace {
constexpr int kShownMs = 8000, kWidest = 320;

class Complaint : public QLabel {
 public:
  explicit Complaint(QWidget* window) : QLabel(window) {
    setObjectName(QStringLiteral("complaint"));
    setTextFormat(Qt::PlainText);
    setWordWrap(true);
    setMargin(5);
    setAttribute(Qt::WA_TransparentForMouseEvents);
    setAutoFillBackground(true);
    away_.setSingleShot(true);
    away_.setInterval(kShownMs);
    QObject::connect(&away_, &QTimer::timeout, this, &QLabel::hide);
  }
  void say(QWidget* box, const QString& words) {
    if (box_) box_->removeEventFilter(this);
    box_ = box;
    box->installEventFilter(this);
    setStyleSheet(
        QStringLiteral("QLabel { background: %1; color: %2; border-radius: 3px }")
            .arg(errorColour().name(), currentTheme() == Theme::Dark ? QStringLiteral("black") : QStringLiteral("white")));
    setText(words);
    const int width = std::min({kWidest, window()->width(), fontMetrics().horizontalAdvance(words) + 14});
    resize(width, heightForWidth(width));
    QPoint at = box->mapTo(window(), QPoint(0, box->height() + 2));
    if (at.y() + height() > window()->height()) at.setY(box->mapTo(window(), QPoint(0, 0)).y() - height() - 2);
    // Inside of the window even if the box has been scrolled out of it.
    move(std::clamp(at.x(), 0, std::max(0, window()->width() - width)),
         std::clamp(at.y(), 0, std::max(0, window()->height() - height())));
    show();
    raise();
    away_.start();
  }

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override {
    // The Return that ended the typing may still be on its way to the box.
    const bool typing = event->type() == QEvent::KeyPress && static_cast<QKeyEvent*>(event)->key() != Qt::Key_Return &&
                        static_cast<QKeyEvent*>(event)->key() != Qt::Key_Enter;
    if (watched == box_ && (typing || event->type() == QEvent::Hide)) hide();
    return QLabel::eventFilter(watched, event);
  }

 private:
  QPointer<QWidget> box_;
  QTimer away_;
};
}  // namespace

void complain(QWidget* box, const QString& words) {
  auto* label = box->window()->findChild<QLabel*>(QStringLiteral("complaint"), Qt::FindDirectChildrenOnly);
  auto* complaint = label ? static_cast<Complaint*>(label) : new Complaint(box->window());
  complaint->say(box, words);
}

}  // namespace glint::gui

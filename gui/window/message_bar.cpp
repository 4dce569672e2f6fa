// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/message_bar.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QToolButton>

#include "core/base/safe_text.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"

namespace glint::gui {

MessageBar::MessageBar(QWidget* parent) : QWidget(parent), row_(new QHBoxLayout(this)), label_(new QLabel) {
  setObjectName(QStringLiteral("messageBar"));
  setAutoFillBackground(true);
  row_->setContentsMargins(10, 3, 4, 3);
  label_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  label_->setTextFormat(Qt::PlainText);
  label_->setWordWrap(true);
  row_->addWidget(label_, 1);
  auto* close = new QToolButton;
  close->setText(QStringLiteral("×"));
  close->setAutoRaise(true);
  close->setToolTip(tr("Close"));
  connect(close, &QToolButton::clicked, this, [this] {
    closeLine();
    if (offer_) showOffer(offer_->first, Answers(offer_->second));
  });
  row_->addWidget(close, 0, Qt::AlignTop);
  hide();
}

void MessageBar::showError(const QString& oneLine, const Answers& answers) {
  showLine(oneLine, QColor(0x8c, 0x2b, 0x20), answers);
}
void MessageBar::showOffer(const QString& oneLine, const Answers& answers) {
  showLine(oneLine, QColor(0x24, 0x4f, 0x7a), answers);
  offer_ = {oneLine, answers};
  offerShown_ = true;
}

void MessageBar::queueOffer(const QString& oneLine, const Answers& answers) {
  if (!failed()) return showOffer(oneLine, answers);
  offer_ = {oneLine, answers};
}

void MessageBar::overtakeError() {
  if (waits() && !offerShown_ && buttons_.isEmpty()) hide();
}

void MessageBar::withdraw(const QString& oneLine) {
  if (!offer_ || offer_->first != oneLine) return;
  if (offerShown_) return closeLine();
  offer_.reset();
}

void MessageBar::closeLine() {
  hide();
  if (std::exchange(offerShown_, false)) offer_.reset();
}

void MessageBar::showNotice(const QString& oneLine) {
  showLine(oneLine, QColor(0x6b, 0x50, 0x12), {});
  notice_ = true;
}

void MessageBar::showLine(const QString& oneLine, const QColor& background, const Answers& answers) {
  notice_ = offerShown_ = false;
  QPalette p = palette();
  p.setColor(QPalette::Window, background);
  p.setColor(QPalette::WindowText, Qt::white);
  setPalette(p);
  label_->setPalette(p);
  label_->setText(toQString(messageLine(oneLine.toStdString())));
  for (QWidget* button : std::as_const(buttons_)) button->deleteLater();
  buttons_.clear();
  for (const auto& [title, run] : answers) {
    auto* button = new QPushButton(title);
    connect(button, &QPushButton::clicked, this, [this, run = run] {
      closeLine();
      run();
      if (isHidden() && offer_) showOffer(offer_->first, Answers(offer_->second));
    });
    row_->insertWidget(row_->count() - 1, button);
    buttons_.append(button);
  }
  show();
}

QString MessageBar::text() const { return label_->text(); }

}  // namespace glint::gui

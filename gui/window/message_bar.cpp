// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/message_bar.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QToolButton>

#include "gui/base/theme.h"

namespace glint::gui {

MessageBar::MessageBar(QWidget* parent) : QWidget(parent) {
  setObjectName(QStringLiteral("messageBar"));
  setAutoFillBackground(true);
  QPalette p = palette();
  p.setColor(QPalette::Window, QColor(0x8c, 0x2b, 0x20));
  p.setColor(QPalette::WindowText, Qt::white);
  setPalette(p);
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(10, 3, 4, 3);
  label_ = new QLabel;
  label_->setPalette(p);
  label_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  label_->setWordWrap(true);
  row->addWidget(label_, 1);
  auto* close = new QToolButton;
  close->setText(QStringLiteral("×"));
  close->setAutoRaise(true);
  close->setToolTip(tr("Close"));
  connect(close, &QToolButton::clicked, this, &QWidget::hide);
  row->addWidget(close, 0, Qt::AlignTop);
  hide();
}

void MessageBar::showError(const QString& oneLine) {
  label_->setText(oneLine);
  show();
}

QString MessageBar::text() const { return label_->text(); }

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/log_panel.h"

#include <QPlainTextEdit>
#include <QTime>
#include <QToolButton>
#include <QVBoxLayout>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr int kMostLines = 2000;
}

LogPanel::LogPanel(QWidget* parent) : QWidget(parent), lines_(new QPlainTextEdit) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(2);
  lines_->setReadOnly(true);
  lines_->setAccessibleName(tr("Log"));
  lines_->setMaximumBlockCount(kMostLines);
  column->addWidget(lines_, 1);
}

void LogPanel::add(const QString& line) {
  lines_->appendPlainText(QTime::currentTime().toString(QStringLiteral("HH:mm:ss  ")) + toQString(line.toStdString()));
}

QString LogPanel::text() const { return lines_->toPlainText(); }

void LogPanel::setReport(QAction* action) {
  auto* button = new QToolButton;
  button->setObjectName(QStringLiteral("copyDiagnostic"));
  button->setDefaultAction(action);
  static_cast<QVBoxLayout*>(layout())->insertWidget(0, button, 0, Qt::AlignRight);
}

}  // namespace glint::gui

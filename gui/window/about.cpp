// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/about.h"

#include <QApplication>
#include <QClipboard>
#include <QDialog>
#include <QDialogButtonBox>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QVBoxLayout>

#include "core/app/load_plugins.h"
#include "core/base/version.h"

namespace glint::gui {

QString aboutText() {
  QString text =
      QObject::tr(
          "Glint %1\n\nFinds specular highlights in photographs, predicts them in views that were not taken, and measures "
          "the lamps that make them. Licence: BSD-3-Clause.\n\nQt %2\n\n")
          .arg(QStringLiteral(GLINT_VERSION), QString::fromLatin1(qVersion()));
  const std::string plugins = pluginLines();
  text += plugins.empty() ? QObject::tr("No plugins are loaded.") : QString::fromStdString(plugins).trimmed();
  return text;
}

void showAbout(QWidget* parent) {
  QDialog dialog(parent);
  dialog.setObjectName(QStringLiteral("about"));
  dialog.setWindowTitle(QObject::tr("About Glint"));
  auto* column = new QVBoxLayout(&dialog);
  auto* text = new QPlainTextEdit(aboutText());
  text->setObjectName(QStringLiteral("about.text"));
  text->setReadOnly(true);
  text->setAccessibleName(QObject::tr("About Glint"));
  text->setMinimumSize(560, 220);
  column->addWidget(text);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
  QPushButton* copy = buttons->addButton(QObject::tr("Copy"), QDialogButtonBox::ActionRole);
  copy->setToolTip(QObject::tr("Copy this text, for a report of a fault"));
  QObject::connect(copy, &QPushButton::clicked, [] { QApplication::clipboard()->setText(aboutText()); });
  QObject::connect(buttons, &QDialogButtonBox::rejected, &dialog, &QDialog::reject);
  buttons->button(QDialogButtonBox::Close)->setDefault(true);
  column->addWidget(buttons);
  dialog.exec();
}

}  // namespace glint::gui

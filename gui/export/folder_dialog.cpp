// SPDX-License-Identifier: BSD-3-Clause
#include "gui/export/folder_dialog.h"

#include <QDialogButtonBox>
#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QVBoxLayout>

#include "gui/base/theme.h"

namespace glint::gui {

namespace {
bool taken(const QString& folder) {
  const QFileInfo info(folder);
  return info.exists() && (!info.isDir() || !QDir(folder).isEmpty(QDir::AllEntries | QDir::Hidden | QDir::NoDotAndDotDot));
}

QString freeName(const QString& suggested) {
  QString name = suggested;
  for (int i = 2; taken(name); ++i) name = QStringLiteral("%1-%2").arg(suggested).arg(i);
  return name;
}
}  // namespace

FolderRow::FolderRow(const QString& suggested, QWidget* parent)
    : QWidget(parent), line_(new QLineEdit(QDir::toNativeSeparators(freeName(suggested)))), note_(new QLabel) {
  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(0, 0, 0, 0);
  line_->setObjectName(QStringLiteral("newFolder"));
  line_->setAccessibleName(tr("New folder"));
  line_->setMinimumWidth(360);
  grid->addWidget(line_, 0, 0);
  auto* choose = new QPushButton(tr("Browse…"));
  choose->setToolTip(tr("Choose where to create the new folder"));
  choose->setAutoDefault(false);
  grid->addWidget(choose, 0, 1);
  note_->setWordWrap(true);
  grid->addWidget(note_, 1, 0, 1, 2);
  connect(choose, &QPushButton::clicked, this, &FolderRow::chooseParent);
  connect(line_, &QLineEdit::textChanged, this, [this] {
    showNote();
    emit changed();
  });
  showNote();
}

QString FolderRow::folder() const { return QDir::cleanPath(QDir::fromNativeSeparators(line_->text().trimmed())); }

QString FolderRow::problem() const {
  if (line_->text().trimmed().isEmpty()) return tr("Enter a folder name");
  const QFileInfo info(folder());
  if (!info.isAbsolute()) return tr("Enter the full path");
  if (taken(folder())) return tr("This folder already exists; nothing will be overwritten");
  if (!info.dir().exists()) return tr("Folder %1 does not exist").arg(QDir::toNativeSeparators(info.path()));
  return {};
}

void FolderRow::chooseParent() {
  const QFileInfo now(folder());
  const QString chosen = QFileDialog::getExistingDirectory(this, tr("Location of the new folder"), now.path());
  if (!chosen.isEmpty()) line_->setText(QDir::toNativeSeparators(freeName(QDir(chosen).filePath(now.fileName()))));
}

void FolderRow::showNote() {
  const QString why = problem();
  note_->setText(why.isEmpty() ? tr("This folder will be created.") : why);
  QPalette p = palette();
  if (!why.isEmpty()) p.setColor(QPalette::WindowText, warningColour());
  note_->setPalette(p);
}

FolderDialog::FolderDialog(const QString& title, const QString& what, const QString& suggested, const QString& verb,
                           QWidget* parent)
    : QDialog(parent), row_(new FolderRow(suggested)) {
  setWindowTitle(title);
  setObjectName(QStringLiteral("folderDialog"));
  auto* column = new QVBoxLayout(this);
  auto* text = new QLabel(what);
  text->setWordWrap(true);
  column->addWidget(text);
  column->addWidget(row_);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
  QPushButton* go = buttons->button(QDialogButtonBox::Ok);
  go->setText(verb);
  column->addWidget(buttons);
  connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
  const auto check = [this, go] { go->setEnabled(row_->problem().isEmpty()); };
  connect(row_, &FolderRow::changed, this, check);
  check();
}

}  // namespace glint::gui

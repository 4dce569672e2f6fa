// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/save_rules.h"

#include <QCoreApplication>
#include <QDir>
#include <QFileInfo>
#include <QMessageBox>
#include <QPushButton>

#include "core/base/json_text.h"
#include "gui/base/text.h"
#include "gui/document/own_files.h"

namespace glint::gui {

namespace {
QString tr(const char* text) { return QCoreApplication::translate("SaveRules", text); }
QString shownPath(const QString& file) { return shownText(QDir::toNativeSeparators(file)); }

/// An existing file that is no session stays as it is, even if the user chose it.
QString whyNoSession(const QString& file) {
  if (QFileInfo(file).isDir()) return tr("%1 is a folder; choose another name").arg(shownPath(file));
  if (documentKind(file.toStdString()) == "glint_session") return {};
  return tr("%1 exists and is not a session, so it is not overwritten; choose another name").arg(shownPath(file));
}
}  // namespace

void SaveRules::follow(const QString& session, const std::string& stamp) {
  lock_.hold(session);
  stamp_ = stamp;
}

SaveRules::Answer SaveRules::toOwnFile(QString& refusal) {
  const QString& file = document_.sessionFile();
  if (file.isEmpty() || isShipped(file)) return Answer::SaveAs;
  const QString other = otherHolder();
  const bool exists = QFileInfo::exists(file);
  if (exists) refusal = whyNoSession(file);
  if (!refusal.isEmpty()) return Answer::Cancel;
  if (!other.isEmpty())
    return ask(tr("%1 is also open in %2. Saving here overwrites what is saved there.").arg(shownPath(file), other), true);
  if (!exists) return Answer::Write;
  if (stamp_.empty()) return ask(tr("The recovered session overwrites the current contents of %1.").arg(shownPath(file)), true);
  if (stampOf(file) == stamp_) return Answer::Write;
  return ask(tr("%1 was changed by another program after it was opened or saved here.").arg(shownPath(file)), true);
}

SaveRules::Answer SaveRules::toChosenFile(const QString& file, QString& refusal) {
  const QFileInfo info(file);
  if (!info.exists()) return Answer::Write;
  if (isShipped(file)) {
    refusal = tr("%1 came with the program and is not overwritten; choose another location").arg(shownPath(file));
    return Answer::Cancel;
  }
  if (info.canonicalFilePath() == QFileInfo(document_.sessionFile()).canonicalFilePath()) return toOwnFile(refusal);
  refusal = whyNoSession(file);
  if (!refusal.isEmpty()) return Answer::Cancel;
  const QString other = lock_.otherHolder(file);
  return ask(other.isEmpty() ? tr("Another session named %1 already exists.").arg(shownPath(file))
                             : tr("Another session named %1 already exists and is open in %2.").arg(shownPath(file), other),
             false);
}

SaveRules::Answer SaveRules::ask(const QString& what, bool otherName) {
  QMessageBox question(QMessageBox::Warning, tr("Replace session?"), what, QMessageBox::Cancel, window_);
  question.setObjectName(QStringLiteral("replaceQuestion"));
  question.setTextFormat(Qt::PlainText);
  const QPushButton* replace = question.addButton(tr("Replace"), QMessageBox::DestructiveRole);
  const QPushButton* saveAs = otherName ? question.addButton(tr("Save as…"), QMessageBox::AcceptRole) : nullptr;
  question.setDefaultButton(QMessageBox::Cancel);
  question.exec();
  if (question.clickedButton() == replace) return Answer::Write;
  return saveAs && question.clickedButton() == saveAs ? Answer::SaveAs : Answer::Cancel;
}

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QDir>
#include <QDirIterator>
#include <QFile>
#include <QFileInfo>
#include <QtTest>

namespace glint::gui {

/// Copies of a folder's files, with its folders, that may be written to.
inline void copyFolder(const QString& from, const QString& to) {
  QDirIterator files(from, QDir::Files, QDirIterator::Subdirectories);
  while (files.hasNext()) {
    const QString name = files.next(), there = to + '/' + QDir(from).relativeFilePath(name);
    QVERIFY(QDir().mkpath(QFileInfo(there).path()) && QFile::copy(name, there));
    QFile(there).setPermissions(QFile::ReadOwner | QFile::WriteOwner);
  }
}

}  // namespace glint::gui

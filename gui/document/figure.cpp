// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/figure.h"

#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QImageReader>
#include <QImageWriter>
#include <QSaveFile>
#include <QUuid>

namespace glint::gui {

namespace {
const char* const kSessionKey = "glint-session";

[[noreturn]] void cannotWrite(const QString& file, const QString& why) {
  throw InputError(file.toStdString(), "", "cannot be written: " + why.toStdString());
}
}  // namespace

void writeFigure(const QImage& picture, const Opened& state, const Engine& engine, const QString& file) {
  // Beside the picture, so that the session's relative paths start there.
  const QString beside = QFileInfo(file).dir().filePath(QStringLiteral(".") + QUuid::createUuid().toString(QUuid::WithoutBraces) +
                                                        QStringLiteral(".glint"));
  engine.autosave(state, beside.toStdString());
  QFile session(beside);
  const bool read = session.open(QIODevice::ReadOnly);
  const QString text = QString::fromUtf8(session.readAll());
  session.close();
  QFile::remove(beside);
  if (!read) cannotWrite(file, session.errorString());
  QSaveFile out(file);
  if (!out.open(QIODevice::WriteOnly)) cannotWrite(file, out.errorString());
  QImageWriter writer(&out, "png");
  writer.setText(QString::fromLatin1(kSessionKey), text);
  if (!writer.write(picture)) cannotWrite(file, writer.errorString());
  if (!out.commit()) cannotWrite(file, out.errorString());
}

QString sessionInFigure(const QString& picture) { return QImageReader(picture).text(QString::fromLatin1(kSessionKey)); }

}  // namespace glint::gui

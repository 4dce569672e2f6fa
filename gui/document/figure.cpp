// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/figure.h"

#include <QImageReader>

#include "gui/base/write_png.h"

namespace glint::gui {

namespace {
const char* const kSessionKey = "glint-session";
}  // namespace

void writeFigure(const QImage& picture, const Opened& state, const Engine& engine, const QString& file) {
  writePng(picture, file, QString::fromLatin1(kSessionKey),
           QString::fromStdString(engine.recoveryText(state, file.toStdString())));
}

QString sessionInFigure(const QString& picture) { return QImageReader(picture).text(QString::fromLatin1(kSessionKey)); }

}  // namespace glint::gui

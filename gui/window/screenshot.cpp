// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/screenshot.h"

#include <QCoreApplication>
#include <QPixmap>
#include <QSaveFile>
#include <QTimer>
#include <cstdio>
#include <utility>

#include "core/base/outcome.h"
#include "gui/base/text.h"
#include "gui/window/main_window.h"

namespace glint::gui {

namespace {
constexpr int kLookMs = 50;
constexpr int kQuietLooks = 3;  // layouts, tables and the 3D view settle in the events after the last result
}  // namespace

Screenshot::Screenshot(MainWindow& window, QString file, bool waitIdle)
    : QObject(&window), window_(window), file_(std::move(file)), waitIdle_(waitIdle) {
  connect(&window_, &MainWindow::problem, this, &Screenshot::fail);
  QTimer::singleShot(kLookMs, this, &Screenshot::look);
}

void Screenshot::look() {
  const bool opening = !window_.document().scene() && window_.runner().busy();
  const bool quiet = waitIdle_ ? window_.idle() : !opening;
  quietLooks_ = quiet ? quietLooks_ + 1 : 0;
  if (quietLooks_ >= kQuietLooks)
    write();
  else
    QTimer::singleShot(kLookMs, this, &Screenshot::look);
}

void Screenshot::write() {
  QSaveFile out(file_);
  if (!out.open(QIODevice::WriteOnly) || !window_.picture().save(&out, "PNG") || !out.commit())
    return fail(toQString(
        InputError(file_.toStdString(), "--screenshot", "cannot be written: " + out.errorString().toStdString()).what()));
  QCoreApplication::exit(0);
}

void Screenshot::fail(const QString& oneLine) {
  std::fprintf(stderr, "glint-inspector: %s\n", oneLine.toUtf8().constData());
  QCoreApplication::exit(2);
}

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/screenshot.h"

#include <QCoreApplication>
#include <QFileInfo>
#include <QPixmap>
#include <QTimer>
#include <exception>
#include <utility>

#include "core/scene/outputs.h"
#include "gui/base/error_line.h"
#include "gui/base/text.h"
#include "gui/base/write_png.h"
#include "gui/document/own_files.h"
#include "gui/window/input_report.h"
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

/// InputError. Asked again at the end, because actions of `--run` may have opened or written something.
void Screenshot::requireReplaceable() const {
  const std::string file = file_.toStdString();
  Outputs(filesOfInput(window_.document())).file(file, "--screenshot", OutputKind::png());
  if (QFileInfo::exists(file_) && isShipped(file_))
    throw InputError(file, "--screenshot", "came with the program and is never overwritten; choose another file");
}

void Screenshot::look() {
  if (!checked_ && window_.document().scene()) {
    checked_ = true;
    try {
      requireReplaceable();
    } catch (const InputError& e) {
      return fail(toQString(e.what()));
    }
  }
  const bool opening = !window_.document().scene() && window_.runner().busy();
  const bool quiet = waitIdle_ ? window_.idle() && !window_.report()->busy() : !opening;
  quietLooks_ = quiet ? quietLooks_ + 1 : 0;
  if (quietLooks_ >= kQuietLooks)
    write();
  else
    QTimer::singleShot(kLookMs, this, &Screenshot::look);
}

void Screenshot::write() {
  try {
    requireReplaceable();
    writePng(window_.picture().toImage(), file_);
  } catch (const std::exception& e) {
    return fail(toQString(e.what()));
  }
  QCoreApplication::exit(0);
}

void Screenshot::fail(const QString& oneLine) {
  printErrorLine(oneLine.toStdString());
  QCoreApplication::exit(2);
}

}  // namespace glint::gui

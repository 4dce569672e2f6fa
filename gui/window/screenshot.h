// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QString>

namespace glint::gui {

class MainWindow;

/// `--screenshot`: writes the window as PNG and ends the program, with 0, or with 2 and one line on standard error when
/// the input or the file cannot be used. A file of the open input, one that came with the program, or one that holds something
/// else than a PNG stays as it is. Without `waitIdle` it waits for the input to be open, not for results.
class Screenshot : public QObject {
  Q_OBJECT
 public:
  Screenshot(MainWindow& window, QString file, bool waitIdle);

 private:
  void look();
  void write();
  void requireReplaceable() const;
  void fail(const QString& oneLine);

  MainWindow& window_;
  QString file_;
  bool waitIdle_;
  int quietLooks_ = 0;
  bool checked_ = false;  ///< against what is open, before the long wait
};

}  // namespace glint::gui

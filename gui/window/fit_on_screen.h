// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QMargins>
#include <QObject>
#include <QRect>
#include <functional>

class QWidget;

namespace glint::gui {

/// The content of a window that lies on the screen with its frame: smaller and moved if necessary.
/// @param frame  around the content: title bar and borders.  @param available  the screen without panels of the desktop.
QRect contentWithin(const QRect& content, const QMargins& frame, const QRect& available);

/// Keeps a window whose size the program chose on its screen. How thick the frame is that the window manager puts around it is
/// known only after the window is shown: until then its title bar is not counted, and the lowest line would lie below the screen.
/// Acts for a moment after the window is shown first; later its size is the user's.
class FitOnScreen : public QObject {
  Q_OBJECT
 public:
  /// @param frame  empty = what Qt knows of the window's frame.
  explicit FitOnScreen(QWidget* window, std::function<QMargins()> frame = {});

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void fit();

  QWidget* window_;
  std::function<QMargins()> frame_;
  bool shown_ = false;
};

}  // namespace glint::gui

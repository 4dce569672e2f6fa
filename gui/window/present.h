// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QByteArray>
#include <QFont>
#include <QMap>
#include <QObject>
#include <QString>
#include <functional>

class QMainWindow;
class QWidget;

namespace glint::gui {

/// Shows the window to a room: the whole screen, large texts, nothing but the views, the timeline and what is
/// explained; a remote control steps (Page down, Page up; B for a black screen), and Esc gives back everything as it was.
class Present : public QObject {
  Q_OBJECT
 public:
  /// @param arrange  shows only what belongs on a screen for a room.
  Present(QMainWindow* window, std::function<void()> arrange);
  bool on() const { return on_; }
  /// How much larger than usual texts are now.
  double textScale() const;

 public slots:
  void start();
  void leave();
  void toggle() { on_ ? leave() : start(); }

 signals:
  void changed(bool on);
  void step(int by);  ///< the remote control: 1 = on, -1 = back

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  bool take(int key);
  void setBlack(bool black);

  QMainWindow* window_;
  std::function<void()> arrange_;
  bool on_ = false;
  QWidget* black_ = nullptr;        ///< covers the window
  QMap<QWidget*, bool> barsShown_;  ///< before
  QByteArray docks_;                ///< before
  QFont font_;
  Qt::WindowStates state_;
};

}  // namespace glint::gui

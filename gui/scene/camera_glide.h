// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QVariantAnimation>
#include <functional>

#include "viz/scene_view.h"

namespace glint::gui {

/// Whether views may move by themselves to where they are wanted: only where the program says so (a person looks at it, no
/// script), and the desktop does not switch animations off.
void setAnimationsWanted(bool wanted);
bool animationsWanted();

/// Moves a 3D view to another place within a moment, so that the way is seen. Ends if the user moves the view.
class CameraGlide : public QObject {
  Q_OBJECT
 public:
  static constexpr int kMs = 400;
  explicit CameraGlide(QObject* parent = nullptr);
  /// @param show  gets every place on the way, the last one being `to`; at once, and only that, where there is no animation.
  void start(const viz::ViewPoint& from, const viz::ViewPoint& to, std::function<void(const viz::ViewPoint&)> show);
  void stop() { animation_.stop(); }  ///< leaves the view where it is
  bool running() const { return animation_.state() == QAbstractAnimation::Running; }

 private:
  QVariantAnimation animation_;
  viz::ViewPoint from_, to_;
  std::function<void(const viz::ViewPoint&)> show_;
};

}  // namespace glint::gui

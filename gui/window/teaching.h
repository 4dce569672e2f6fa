// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <memory>
#include <vector>

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "viz/scene_view.h"

class QMainWindow;
class QMenu;

namespace glint::gui {

class Docks;
class ExplainPanel;
class FramePanel;
class Present;
class Reader;
class ScenePanel;
class WindowLayout;

/// Explains the program and its pictures: wires the explanation to the views and to the arrangement of the window, opens
/// pages to read, and presents.
class Teaching : public QObject {
  Q_OBJECT
 public:
  struct Parts {
    QMainWindow* window;
    Document& document;
    Docks& docks;
    WindowLayout& layout;
    ExplainPanel& explain;
    ScenePanel& scene;
    FramePanel& frame;
  };
  explicit Teaching(const Parts& parts);
  void addActions(Actions& actions, QMenu* help, QMenu* view);
  /// @param page, place  see Reader::open.
  void read(const QString& page, const QString& place = {});

 signals:
  void frameRequested(int by);  ///< a remote control steps through the frames

 private:
  bool teaches() const;
  void makeRoom();
  void putBack();

  Parts parts_;
  Present* present_;
  Reader* reader_ = nullptr;                 ///< made when it is first asked for
  std::shared_ptr<const Scene> explained_;   ///< the one that is open
  std::vector<viz::ViewPoint> viewsBefore_;  ///< of the 3D views, before the explanation began; empty = not known
};

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>
#include <memory>

#include "gui/base/actions.h"
#include "gui/document/document.h"

class QVTKOpenGLNativeWidget;

namespace glint::gui {

/// The 3D view: shows the document through viz::SceneView, turns clicks into picks.
class ScenePanel : public QWidget {
  Q_OBJECT
 public:
  explicit ScenePanel(Document& document, QWidget* parent = nullptr);
  ~ScenePanel() override;
  viz::SceneView& view() { return *view_; }
  void addActions(Actions& actions, QMenu* menu);
  /// Draws now, so that a grab of the window shows the newest state.
  void renderNow();
  void setDark(bool dark);
  /// Where the next results are looked at from; none = show everything.
  void setViewPoint(const std::optional<viz::ViewPoint>& viewPoint) { firstViewPoint_ = viewPoint; }
  /// The 3D camera to save: the one on screen, and before there are results the one that they will be looked at from.
  std::optional<viz::ViewPoint> viewPoint() const;

 public slots:
  void frameAll();
  void lookThroughSelected();

 signals:
  void picked(const glint::viz::Picked& picked);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void showScene();
  void showInspection();
  void showLayers();
  void showSelection();
  void scheduleRender();
  void pickAt(const QPointF& position);

  Document& document_;
  std::unique_ptr<viz::SceneView> view_;
  QVTKOpenGLNativeWidget* widget_;
  QPointF pressed_;
  bool renderPending_ = false;
  bool framed_ = false;  ///< the picture was framed since the scene was opened
  std::optional<viz::ViewPoint> firstViewPoint_;
};

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <QElapsedTimer>
#include <QTimer>
#include <QWidget>
#include <array>
#include <deque>
#include <limits>
#include <memory>
#include <set>
#include <vector>

#include "gui/scene/photograph_store.h"
#include "gui/scene/scene_options.h"

class vtkCallbackCommand;

namespace glint::gui {

class VtkCanvas;

/// Up to four 3D views in one widget: arrangement, linked cameras, the wipe's line, what the mouse does. Knows no document.
class SceneViews : public QWidget {
  Q_OBJECT
 public:
  explicit SceneViews(QWidget* parent = nullptr);
  ~SceneViews() override;

  viz::SceneView& view(int index = 0) { return *views_[std::size_t(index)]; }
  int viewCount() const { return options_.viewCount(); }
  /// The one that was clicked last; actions on one view are about it.
  int activeView() const { return active_; }
  viz::SceneView& active() { return view(active_); }
  VtkCanvas* widget() { return widget_; }
  /// A view of its own that shows what the active one shows, for pictures that leave the program.
  std::unique_ptr<viz::SceneView> copyOf(int view);
  std::unique_ptr<viz::SceneView> copyOfActive() { return copyOf(active_); }
  /// Where a view lies in the picture: left, bottom, right, top, shares of it.
  std::array<double, 4> placeOf(int view) const;
  /// The first view has the legend; another one only where it shows other models or layers, and then without the title.
  bool hasLegend(int view) const;
  bool wiping() const { return options_.arrangement == Arrangement::Wipe; }
  /// See behindChanged().
  bool behind() const { return behind_; }
  bool busy() const { return photographs_->busy() || renderPending_; }
  /// The place of every view, shown or not; linked ones all where the active one does.
  std::vector<viz::ViewPoint> places() const;
  void setPlaces(const std::vector<viz::ViewPoint>& places);

  void setScene(std::shared_ptr<const Scene> scene);
  void setInspection(const std::shared_ptr<const Inspection>& inspection);
  void setSelection(const draw::Selection& selection);
  void setLayerVisible(int view, const std::string& name, bool visible);
  /// What the layer "measured-lamps" draws; null = nothing.
  void setLamps(const std::shared_ptr<const std::vector<LampAnswer>>& lamps);
  /// What the layer "solver-runs" draws; null = nothing.
  void setRuns(const std::shared_ptr<const std::vector<viz::DrawnRuns>>& runs);
  void setDark(bool dark);
  void setTextScale(double scale);  ///< of the texts in all views; draws at once
  void apply(const SceneOptions& options);
  /// Draws soon; several changes in one turn of the event loop make one picture.
  void scheduleRender();
  /// Draws now, in full.
  void renderNow();
  /// Draws now as while something moves, and in full when nothing moved for a while.
  void renderMoving();
  /// Names the camera that is looked through; else "".
  QString eyeText() const;

 signals:
  void taken();  ///< the user is about to move a view
  void picked(const glint::viz::Picked& picked);
  void emptyClicked();
  void activeChanged();
  /// The picture shows an older selection or older results. It ends only after a pause, so that a mark does not
  /// flicker while one picture after the other is late.
  void behindChanged(bool behind);
  void wipeMoved(double share, bool released);
  /// A true light is being dragged, m since the button went down.
  void lampMoved(const QString& light, double dx, double dy, double dz);
  void lampReleased();
  void menuWanted(const glint::viz::Picked& picked, const QPoint& global);  ///< a right click
  void leaveEye();                                                          ///< the escape key while looking through a camera

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  enum class Drag { None, Vtk, Wipe, Photograph, Lamp };
  void arrange();
  void showLegends();
  void fetchPhotograph();
  int viewAt(const QPointF& position) const;
  void activate(int view);
  bool onWipe(const QPointF& position) const;
  QPointF toDisplay(const QPointF& position) const;  ///< device px, y up
  void renderInTurn();
  void renderFull();
  void loadPhotograph();
  viz::LayerCache::Photograph photograph(int frame, int maxWidth);
  void setMoving(bool moving);
  void setBehind();
  void endBehind();
  void syncCameras();
  /// These say whether the event is dealt with: it does not go on to VTK.
  bool mouse(QEvent* event);
  bool wheel(const QWheelEvent& event);
  bool press(const QMouseEvent& event);
  bool drag(const QMouseEvent& event);
  bool release(const QMouseEvent& event);
  void click(const QMouseEvent& event);
  /// What the user moves about: what lies under a point of the active view, else a place there as far away as the focal point.
  Eigen::Vector3d underPointer(const QPointF& position) const;
  void turn(const QPointF& from, const QPointF& to);

  std::shared_ptr<viz::LayerCache> cache_;
  PhotographStore* photographs_;
  std::array<std::unique_ptr<viz::SceneView>, kMostSceneViews> views_;
  std::array<bool, kMostSceneViews> own_{};  ///< a view that is not shown comes back to its place
  std::shared_ptr<const Inspection> inspection_;
  std::shared_ptr<const std::vector<LampAnswer>> lamps_;
  std::shared_ptr<const std::vector<viz::DrawnRuns>> runs_;
  draw::Selection selection_;
  SceneOptions options_;
  VtkCanvas* widget_;
  vtkNew<vtkCallbackCommand> onRender_, onInteraction_;
  QTimer full_;      ///< draws in full when nothing moved for a while
  QTimer caughtUp_;  ///< runs from a picture of what was set last
  QElapsedTimer behindSince_;
  bool behind_ = false;
  QPointF pressed_, last_;
  Drag drag_ = Drag::None;
  viz::Picked lamp_;                      ///< what is dragged
  bool turns_ = false;                    ///< the plain left button was pressed: the view turns about `pivot_`
  std::optional<Eigen::Vector3d> pivot_;  ///< looked for when the drag begins
  Eigen::Vector3d zoomedAt_{0, 0, 0};     ///< of the last turn of the wheel
  QPointF wheelAt_;
  QElapsedTimer sinceWheel_;
  int active_ = 0, shown_ = 0;
  bool renderPending_ = false, dark_ = true;
  std::deque<vtkSmartPointer<vtkImageData>> toLoad_;  ///< photographs that wait for the graphics card
  std::set<vtkImageData*> loaded_;                    ///< that have been brought there; only to compare with
  bool allPhotographs_ = false;                       ///< the next picture has to be complete
  QElapsedTimer sinceRender_;
  qint64 lastRenderMs_ = 0, fullMs_ = std::numeric_limits<int>::max();  ///< of the last picture, of the last one in full
};

}  // namespace glint::gui

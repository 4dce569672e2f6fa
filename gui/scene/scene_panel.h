// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QPointer>
#include <QStringList>
#include <QWidget>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "gui/scene/scene_options.h"
#include "gui/scene/view_history.h"

class QToolBar;
class QMenu;
class QSlider;

namespace glint::gui {

class CameraGlide;
class SceneViews;

/// The 3D views with their toolbar: shows the document through viz::SceneView, turns clicks into selections, and what the user
/// sets into options of the document.
class ScenePanel : public QWidget {
  Q_OBJECT
 public:
  explicit ScenePanel(Document& document, QWidget* parent = nullptr);
  ~ScenePanel() override;
  /// The first view.
  viz::SceneView& view();
  SceneViews& views() { return *views_; }
  /// Also fills the toolbar, whose buttons are these actions.
  void addActions(Actions& actions, QMenu* menu);
  /// Draws now, so that a grab of the window shows the newest state.
  void renderNow();
  void setDark(bool dark);
  bool busy() const;  ///< photographs are on their way
  /// Where the views look at the next results from, those beyond the last as the first; empty = show everything.
  void setViewPoints(const std::vector<viz::ViewPoint>& viewPoints);
  /// The 3D cameras to save: those on screen (one where they are linked), and before there are results those that they will be
  /// looked at from.
  std::vector<viz::ViewPoint> viewPoints() const;
  /// Goes there at once; of views beyond the last, to the first.
  void lookFrom(const std::vector<viz::ViewPoint>& viewPoints);
  QStringList savedViews() const;

 public slots:
  /// What the layer "walk" draws, as far as `step`.
  /// @param playing  drawn at once, so that it is in step with what else shows the walk.
  void showWalk(const std::shared_ptr<const glint::viz::WalkStory>& walk, int step, bool playing = false);
  /// Moves the view to a part of the scene: "scene", "ellipsoid" (of a model), or a highlight: "tangent" (S and T from the
  /// side), "highlight" (as its camera sees it), "mirror" (with camera, virtual camera and light). The user may move on from
  /// there.
  void look(const QString& at, int highlight, const QString& model);
  void frameAll();
  void frameSelection();
  void lookAlong(glint::viz::AxisView axis);
  /// Moves the active view, or all views if they are linked.
  void setEye(glint::viz::Eye eye);
  void setArrangement(glint::gui::Arrangement arrangement);
  void setColourBy(const QString& by);
  void saveView();
  void goToView(const QString& name);
  void removeView(const QString& name);
  /// The next of "all models", then each model alone, in the active view.
  void nextModels();

 signals:
  void activeViewChanged(int view);
  void picked(const glint::viz::Picked& picked);
  void influenceRequested();  ///< camera colours need an influence that is not measured yet

 private:
  void moveLamp(const QString& light, const Eigen::Vector3d& by);
  void showMenu(const viz::Picked& picked, const QPoint& global);
  void buildBars();
  void showScene();
  void showInspection();
  /// Shows what is known before all results exist; null = nothing.
  void showFirst(const std::shared_ptr<const Inspection>& inspection);
  void frameFirst();  ///< all views, from where the first results are looked at; not where the user has moved on
  bool movedBeforeResults() const;
  void showLayers();
  void showSelection();
  void showOptions();
  void followHistory();  ///< the undo stack's index has changed
  void showEye();
  void select(const viz::Picked& picked);
  QAction* addToggle(Actions& actions, const char* id, QMenu* menu, const QString& title, const Actions::Look& look,
                     const std::function<void(bool)>& run);
  QMenu* addAxesMenu(Actions& actions, QMenu* menu);
  QMenu* addArrangeMenu(Actions& actions, QMenu* menu);
  QMenu* addColourMenu(Actions& actions, QMenu* menu);
  void addMenuButton(QMenu* menu, const char* iconName, const QString& tip);
  void checkToggles();  ///< after the options
  void goToNextView();
  void setSwitch(const char* option, bool on, const QString& text);
  void scaleGlyphs(double factor);
  int eyeView() const;  ///< whose option says what is looked through

  Document& document_;
  SceneViews* views_;
  CameraGlide* glide_;
  ViewHistory history_;
  std::optional<std::pair<Arrangement, bool>> arranged_;  ///< how the views are: arrangement, linked; none before a scene
  QToolBar* bar_ = nullptr;
  bool mayAskForInfluence_ = true;  ///< once for each scene by itself
  QAction* slider_ = nullptr;       ///< the last one of the bar
  QWidget* eyeBar_ = nullptr;
  QList<QPointer<QSlider>> sizes_;  ///< of cameras and points: in the bar, and in the menu of what it has no room for
  QSlider* opacity_ = nullptr;
  QMenu* savedMenu_ = nullptr;
  /// Actions that are on or off as the options say; null before addActions().
  struct {
    QAction *camera = nullptr, *mirrored = nullptr, *parallel = nullptr, *linked = nullptr, *solo = nullptr;
    QList<std::pair<QAction*, Arrangement>> arrangements;
    QList<std::pair<QAction*, QString>> colours;
  } toggles_;
  int gesture_ = 0;
  std::optional<WhatIf> lampStart_;  ///< while a lamp is dragged
  bool framed_ = false;              ///< the picture was framed since the scene was opened
  std::vector<viz::ViewPoint> firstViewPoints_;
  std::vector<viz::ViewPoint> beforeResults_;  ///< where the views were put before there were results; empty = nothing was shown
};

}  // namespace glint::gui

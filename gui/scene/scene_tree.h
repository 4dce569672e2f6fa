// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>
#include <functional>
#include <vector>

#include "gui/base/actions.h"
#include "gui/document/step_run.h"
#include "gui/scene/scene_tree_model.h"

class QLineEdit;
class QMenu;
class QSortFilterProxyModel;
class QTreeView;

namespace glint::gui {

/// The scene tree with a line to search in: a click selects an object everywhere, its tick hides it in the 3D views, a click on
/// the role of a camera excludes the frame or takes it back.
class SceneTree : public QWidget {
  Q_OBJECT
 public:
  explicit SceneTree(Document& document, QWidget* parent = nullptr);
  void addActions(Actions& actions, QMenu* menu);
  SceneTreeModel& model() { return *model_; }
  QTreeView* view() { return tree_; }
  /// The objects of the selected rows.
  std::vector<SceneObject> selected() const;

 public slots:
  void setActiveView(int view);
  void hideSelected();
  void showSelectedOnly();  ///< hides what is of the same kinds and not selected
  void showAll();

 signals:
  void influenceRequested();
  void frameSelectionRequested();  ///< the 3D view is to show what is selected (a double click)
  void lookThroughRequested();     ///< the selected frame's camera

 protected:
  bool eventFilter(QObject* watched, QEvent* e) override;

 private:
  void find(const QString& text);
  void followDocument();
  void select(const SceneObject& object);
  SceneObject partOf(const draw::Selection& selection) const;
  bool isRole(const QModelIndex& index) const;  ///< of a camera, where one click excludes
  void exclude(const QModelIndex& index);       ///< or take back
  bool isTick(const QPoint& position) const;    ///< in the viewport
  void showMenu(const QPoint& position);
  void setHiddenOf(const std::vector<SceneObject>& objects, bool hide);
  QString nameOf(const std::vector<SceneObject>& objects) const;
  std::optional<SceneObject> objectAt(const QModelIndex& index) const;
  void mark(const SceneObject& object);
  void showColumns();
  void keepInSight();  ///< the current row; opens no group that the user has closed

  Document& document_;
  SceneTreeModel* model_;
  QSortFilterProxyModel* shown_;  ///< found and sorted
  QTreeView* tree_;
  QLineEdit* search_;
  draw::Selection followed_;  ///< the last selection that the tree has shown
  StepRun steps_;             ///< from row to row
  bool selecting_ = false;    ///< by this tree
  int leaving_ = 0;           ///< rows are removed: the user has not chosen the new current one
  bool ticked_ = false;       ///< the double click that comes was on a tick
};

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QAbstractItemModel>
#include <QString>
#include <QStringList>
#include <array>
#include <set>
#include <string>
#include <vector>

#include "core/draw/selection.h"
#include "gui/document/document.h"
#include "viz/hidden_objects.h"

namespace glint::gui {

/// A thing of the scene that can be selected, and but for highlights be hidden.
struct SceneObject {
  enum class Kind { Surface, Camera, Light, Ellipsoid, Highlight };
  Kind kind = Kind::Surface;
  int frame = -1;      ///< of a camera or highlight
  int highlight = -1;  ///< index in the frame's evidence
  std::string key;     ///< of a surface: its key; of a light: its id; of an ellipsoid or a spurious highlight: its model
  std::string light;   ///< of an ellipsoid or highlight
  int predicted = -1;  ///< of a spurious highlight: index in what its model predicts for its light; `highlight` is -1 then

  friend bool operator==(const SceneObject&, const SceneObject&) = default;
};

/// Takes an object out of the picture or puts it back; highlights are drawn with their camera.
void setHiddenIn(viz::HiddenObjects& hidden, const SceneObject& object, bool hide);
bool isHiddenIn(const viz::HiddenObjects& hidden, const SceneObject& object);
/// Whether the selection is, or holds, the object. Never of a surface.
bool isSelected(const SceneObject& object, const draw::Selection& selection);

/// The scene as a tree: surfaces, cameras with the highlights observed in them (each with the models
/// that miss it) and the spurious ones, lights and the models' ellipsoids. A tick says
/// that an object is drawn; changing it is one step of undo.
class SceneTreeModel : public QAbstractItemModel {
  Q_OBJECT
 public:
  enum Column { Name, Detail, Effect, ColumnCount };
  static constexpr int kSortRole = Qt::UserRole;  ///< numbers, invalid = none; groups and, but for Effect, objects by their order
  static constexpr int kFindRole = Qt::UserRole + 1;  ///< what a search looks through

  explicit SceneTreeModel(Document& document, QObject* parent = nullptr);
  QModelIndex index(int row, int column, const QModelIndex& parent = {}) const override;
  QModelIndex parent(const QModelIndex& index) const override;
  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  bool setData(const QModelIndex& index, const QVariant& value, int role) override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;

  /// Nothing for a group.
  std::optional<SceneObject> objectAt(const QModelIndex& index) const;
  /// Invalid when there is no such object.
  QModelIndex indexOf(const SceneObject& object) const;
  /// A group and its objects. Invalid for Highlight, whose parents are cameras.
  QModelIndex groupOf(SceneObject::Kind kind) const;
  std::vector<SceneObject> objectsOf(SceneObject::Kind kind) const;
  /// What the object is called in menus and in the history: "camera 0007", "light A".
  QString nameOf(const SceneObject& object) const;
  bool hasEffects() const { return !effects_.empty(); }
  /// The 3D view whose layers say what is drawn at all.
  void setActiveView(int view);

 signals:
  void effectsChanged();  ///< hasEffects(), or their values

 private:
  static constexpr int kGroups = 4;
  struct Group {
    SceneObject::Kind kind;
    QString title;
    std::vector<const char*> layers;  ///< any of them draws these objects
    std::vector<SceneObject> objects;
  };
  void rebuild();
  void followInspection();
  void followView();
  void followSelection();
  void followRoles();
  void refreshEffects();
  void setObjects(int group, std::vector<SceneObject> objects);
  void setHighlights(int camera, std::vector<SceneObject> highlights);
  void emitChanged(int group);  ///< its head and its objects
  void emitHighlightsChanged(int camera);
  QString highlightName(const SceneObject& object) const;
  std::vector<std::string> missedBy(const SceneObject& object) const;  ///< none if it is spurious, or if no one misses it
  void emitAllChanged();
  std::array<bool, kGroups> layersShown() const;
  bool layerShown(const Group& group) const;
  QVariant groupData(const Group& group, int column, int role) const;
  QVariant objectData(const SceneObject& object, const Group& group, int row, int column, int role) const;
  QString detailOf(const SceneObject& object) const;
  const ModelResult::Fit* fitOf(const SceneObject& model) const;  ///< for the frame that is selected; null without one
  QString tipOf(const SceneObject& object, int column) const;
  QString highlightTip(const SceneObject& object) const;

  Document& document_;
  std::array<Group, kGroups> groups_;
  std::vector<std::vector<SceneObject>> highlights_;  ///< by camera: observed ones, then spurious ones
  std::map<int, draw::FrameUnmatched> unmatched_;     ///< by frame
  // What the rows were shown for: a long sequence has a thousand, and none is told of a change that is not about it.
  viz::HiddenObjects hidden_;
  draw::Selection selection_;
  std::string train_;
  std::vector<int> excluded_;
  std::array<bool, kGroups> layersShown_{};
  QStringList details_;            ///< of lights and models
  std::map<int, double> effects_;  ///< what a training frame does, by frame; empty = not measured
  bool effectsAreErrors_ = false;  ///< %, without held-out frames; else percentage points
  double mostEffect_ = 0;
  int view_ = 0;
};

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QString>
#include <map>
#include <optional>
#include <vector>

#include "core/app/ball_photographs.h"
#include "gui/frame/frame_canvas.h"

namespace glint::gui {

/// The outlines of balls that a person draws over photographs, and the mouse that draws and drags them. Photographs of a ball
/// may lie in a folder of their own, cut out of the shots; all places here are pixels of those photographs.
class BallOutlines : public QObject, public DragTool {
  Q_OBJECT
 public:
  struct Ball {
    QString folder;  ///< of its photographs; "" = that of all
    BallOutline outline;
  };
  /// Outlines that are smaller cannot be refined.
  static constexpr double kLeastRadius = 8;
  /// What a click or a drag on the photograph begins.
  enum class Drawing { Nothing, FromMiddle, ThroughRim };

  explicit BallOutlines(QObject* parent = nullptr) : QObject(parent) {}
  const std::vector<Ball>& balls() const { return balls_; }
  int selected() const { return selected_; }
  void select(int ball);
  /// Selects it.
  void add(const BallOutline& outline);
  void remove(int ball);
  void set(int ball, const BallOutline& outline);
  /// Removes all outlines, and the steps back.
  void clear();
  /// One step back, and forth again: a drag, a new or removed outline, or what was typed into one field.
  void undo() { step(past_, future_); }
  void redo() { step(future_, past_); }
  bool canUndo() const { return !past_.empty() && !drag_; }
  bool canRedo() const { return !future_.empty() && !drag_; }
  void forgetSteps();
  /// Which photographs are shown: only their balls can be dragged, and new ones are theirs.
  void setFolder(const QString& folder);
  const QString& folder() const { return folder_; }
  /// Where the photographs of a folder lie in the shots.
  Eigen::Vector2d cornerOf(const QString& folder) const;
  void setCorner(const QString& folder, const Eigen::Vector2d& corner);
  void setDrawing(Drawing drawing);
  Drawing drawing() const { return drawing_; }
  /// A point of the rim, while drawing() is through these; the third one makes a ball.
  void clickRim(const Pixel& at);
  const std::vector<Eigen::Vector2d>& rim() const { return rim_; }
  /// As the computing core takes them, with places of the shots. Their texts are those of `--ball`.
  std::vector<NamedBall> named() const;

  bool wouldTake(const Pixel& at, double nearPx, Qt::KeyboardModifiers modifiers) const override;
  bool take(const Pixel& at, double nearPx, Qt::KeyboardModifiers modifiers) override;
  void carry(const Pixel& to) override;
  void release() override;

 signals:
  void changed();       ///< outlines, selection, or what is drawn next
  void ballsChanged();  ///< how many there are, or where: results are of others now
  void problem(const QString& oneLine);

 private:
  enum class Part { Middle, Rim };
  /// What a step restores: also the photographs and the tool with which it was made.
  struct State {
    std::vector<Ball> balls;
    std::map<QString, Eigen::Vector2d> corners;
    QString folder;
    Drawing drawing;
    int selected;
  };
  /// What is typed into one field, value by value, is one step.
  struct Field {
    int ball = -1;
    Eigen::Index number = -1;  ///< centre x, y, radius; corner x, y
    bool operator==(const Field&) const = default;
  };
  std::optional<std::pair<int, Part>> partAt(const Pixel& at, double nearPx) const;
  State state() const { return {balls_, corners_, folder_, drawing_, selected_}; }
  void keep(State before, std::optional<Field> field = {});
  void step(std::vector<State>& from, std::vector<State>& to);
  std::vector<Ball> balls_;
  std::map<QString, Eigen::Vector2d> corners_;
  std::vector<Eigen::Vector2d> rim_;
  QString folder_;
  Drawing drawing_ = Drawing::FromMiddle;
  int selected_ = -1;
  std::vector<State> past_, future_;
  std::optional<Field> lastField_;
  struct Drag {
    int ball = -1;
    Part part = Part::Middle;
    Eigen::Vector2d off = Eigen::Vector2d::Zero();  ///< from the mouse to the middle
    bool isNew = false, moved = false;
    State before = {};
  };
  std::optional<Drag> drag_;
};

}  // namespace glint::gui

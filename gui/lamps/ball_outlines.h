// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QString>
#include <map>
#include <optional>
#include <vector>

#include "core/lamps/ball_photographs.h"
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
  void clear();
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
  std::optional<std::pair<int, Part>> partAt(const Pixel& at, double nearPx) const;
  std::vector<Ball> balls_;
  std::map<QString, Eigen::Vector2d> corners_;
  std::vector<Eigen::Vector2d> rim_;
  QString folder_;
  Drawing drawing_ = Drawing::FromMiddle;
  int selected_ = -1;
  struct Drag {
    int ball = -1;
    Part part = Part::Middle;
    Eigen::Vector2d off = Eigen::Vector2d::Zero();  ///< from the mouse to the middle
    bool isNew = false, moved = false;
  };
  std::optional<Drag> drag_;
};

}  // namespace glint::gui

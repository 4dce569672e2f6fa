// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QTimer>
#include <QWidget>
#include <string>
#include <vector>

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "viz/canvas.h"

class QLabel;

namespace glint::gui {

class FrameCanvas;
class PhotoLoader;

/// The selected frame once per model, from simple to rich: the same part of the picture with the observed contour and that
/// model's prediction, its error below. Zooming and panning one moves all; a click selects the model (and the contour point).
/// Follows the selection.
class LadderPanel : public QWidget {
  Q_OBJECT
 public:
  /// @param loader  of the frame view: its pictures are shown here too.
  LadderPanel(Document& document, PhotoLoader& loader, QWidget* parent = nullptr);
  std::vector<FrameCanvas*> canvases() const;
  void addActions(Actions& actions, QMenu* menu);
  QSize sizeHint() const override { return {700, 260}; }
  QSize minimumSizeHint() const override { return {150, 80}; }

 public slots:
  void lookAtHighlight();

 protected:
  void changeEvent(QEvent* e) override;
  void resizeEvent(QResizeEvent*) override;
  void showEvent(QShowEvent*) override;

 private:
  struct Tile {
    std::string model;
    QWidget* box;
    FrameCanvas* canvas;
    QLabel* text;
    QString below = {};  ///< error or reason
    QString brief = {};  ///< where there is no room for that
    bool failed = false;
    QColor colour = {};  ///< of the caption's square
  };
  void scheduleRefresh();
  void markStale();
  void refresh();
  void rebuild(const std::vector<std::string>& models);
  void arrange();
  void showTile(Tile& tile);
  void showCaption(const Tile& tile);
  /// Error and model side by side.
  bool fitsOneLine(const Tile& tile, int width) const;
  int captionHeight(int lines) const;
  std::shared_ptr<const Inspection> inspection() const;
  void selectIn(const std::string& model, double x, double y);

  Document& document_;
  PhotoLoader& loader_;
  std::vector<Tile> tiles_;
  QLabel* empty_;
  QTimer refresh_;
  int lines_ = 1;         ///< of every caption
  int frame_ = -1;        ///< that the view was moved to
  bool moved_ = false;    ///< the user chose the zoom: it stays, only the centre follows
  bool recentre_ = true;  ///< the next arrangement puts the contours into the middle
  bool whole_ = false;    ///< there were no contours to look at yet
  draw::Crop crop_;       ///< of the frame's contours
};

}  // namespace glint::gui

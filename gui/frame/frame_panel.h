// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>
#include <vector>

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "gui/frame/photo_loader.h"
#include "viz/frame_overlay.h"

class QLabel;
class QSlider;
class QToolButton;
class QHBoxLayout;
class QVBoxLayout;

namespace glint::gui {

class FrameCanvas;

/// The frame view: the selected frame's photograph with its overlay, a legend whose entries are toggles, and below it one line
/// per model with its error or the reason for none, as a table.
class FramePanel : public QWidget {
  Q_OBJECT
 public:
  explicit FramePanel(Document& document, QWidget* parent = nullptr);
  FrameCanvas* canvas() const { return canvas_; }
  PhotoLoader* loader() { return &loader_; }
  void addActions(Actions& actions, QMenu* menu);
  /// Zooms to the selected frame's highlights.
  void goToHighlight();

 signals:
  void probed(const QString& text);

 private:
  struct Toggle {
    viz::OverlayRole role;
    const char* name;  ///< layer name "frame/NAME"
    const char* title;
    QToolButton* button;
  };
  void buildToolbar(QVBoxLayout* column);
  void showScene();
  void showFrame();
  void showOverlay();
  void showCaptions(const viz::FrameOverlay& overlay);
  void selectAt(double x, double y);

  Document& document_;
  PhotoLoader loader_;
  FrameCanvas* canvas_;
  QLabel* title_;
  QLabel* role_;
  QSlider* exposure_;
  QLabel* zoom_;
  QLabel* captions_;
  std::vector<Toggle> toggles_;
};

}  // namespace glint::gui

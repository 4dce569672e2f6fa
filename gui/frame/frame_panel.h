// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QTimer>
#include <QWidget>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/draw/frame_overlay.h"
#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "gui/frame/pair_bar.h"
#include "gui/frame/photo_loader.h"
#include "gui/frame/pixel_probe.h"

class QLabel;
class QToolBar;
class QToolButton;
class QVBoxLayout;

namespace glint::viz {
struct WalkStory;
}

namespace glint::gui {

class DevelopBar;
class FrameCanvas;
class HandTool;
class HighlightEdits;
class LobeLayer;
class PanelScroll;
class RetextureBar;

/// The frame view: the selected frame's photograph or radiance with its overlay, beside it another frame when wished, a legend
/// whose entries are toggles, and below it one line per model with its error or the reason for none, as a table whose squares
/// show and hide the model.
class FramePanel : public QWidget {
  Q_OBJECT
 public:
  explicit FramePanel(Document& document, QWidget* parent = nullptr);
  FrameCanvas* canvas() const { return canvas_; }
  HighlightEdits* edits() const { return edits_; }
  FrameCanvas* secondCanvas() const { return second_; }
  const PairBar& pair() const { return *pair_; }  ///< the frame beside the selected one
  PhotoLoader* loader() { return &loader_; }
  RetextureBar* retexture() { return retexture_; }
  /// Something is still being read, developed or waiting to be drawn.
  bool busy() const;
  void addActions(Actions& actions, QMenu* menu);
  /// The image points of a walk, as far as `step`; null = none.
  void showWalk(std::shared_ptr<const viz::WalkStory> walk, int step);
  /// What of the overlays is shown, and how.
  draw::OverlayOptions overlayOptions() const;
  /// A step of the explanation is about a highlight ("tangent", "highlight": zooms to it) or about the scene (the whole
  /// photograph again, unless the user has moved on since).
  void look(const QString& at, int highlight);
  /// Zooms to the selected frame's highlights.
  void goToHighlight();
  /// What the colours of the picture's lines mean: those of the pair, then the observed contour and every model that is drawn.
  QList<PairBar::KeyEntry> figureKey() const;

 signals:
  void photographFailed(int frame, const QString& reason);  ///< there is nothing to show for it
  void probed(const QString& text);
  void problem(const QString& why);  ///< a request cannot be fulfilled

 protected:
  void changeEvent(QEvent* e) override;
  void resizeEvent(QResizeEvent* e) override;

 private:
  void buildToolbar(QVBoxLayout* column);
  QWidget* buildHeading();
  void buildTools(QToolBar& bar);
  QWidget* buildSwitches();
  void connectDocument();
  void showScene();
  void showFrame();
  void showTitle();
  void showLook();
  void showOverlay();
  void markStale();
  void showCaptions(const draw::FrameOverlay& overlay, bool earlier);
  void selectAt(double x, double y);
  void selectModelAt(double x, double y);
  void followLink(const QString& link);
  void foldOverlays();
  void followHighlight(int frame);
  int frameOn(const FrameCanvas* canvas) const;
  /// @param withCanonical  also the canonical ellipses about it that are shown.
  void zoomTo(int highlight, bool withCanonical = false);

  Document& document_;
  PhotoLoader loader_, secondLoader_;
  PixelProbeWorker probe_;
  FrameCanvas *canvas_, *second_;
  HandTool* hand_;
  HighlightEdits* edits_;
  LobeLayer* lobes_;
  DevelopBar* develop_;
  PairBar* pair_;
  QLabel *title_, *role_, *zoom_, *captions_;
  RetextureBar* retexture_;
  QAction *sideBySide_, *retextureTool_;
  PanelScroll *switches_, *captionsScroll_;
  std::vector<QToolButton*> toggles_;             ///< one per draw::overlayLayers()
  std::map<std::string, QAction*> layerActions_;  ///< by layer name
  QAction* colourByRole_ = nullptr;
  draw::FrameOverlay shown_, shownSecond_;
  std::size_t captionCount_ = 0;
  int failuresShown_ = 0;                ///< the captions hold the reasons of so many
  QToolButton* folded_ = nullptr;        ///< the overlays' switches, where there is no room for a row of them
  bool follows_ = false;                 ///< zoomed to the highlight by the user, who has not moved it since
  int seenFrame_ = -1;                   ///< that was selected last
  std::array<int, 2> pictured_{-1, -1};  ///< whose photographs the canvases show; -1 = none
  bool whatIf_ = false;                  ///< the request has a what-if
  bool fewerLines_ = false;              ///< a what-if was put back: the captions may shrink to what there was to say before it
  bool zoomedByLook_ = false;            ///< and the user has not moved it since
  QTimer refresh_;                       ///< many selections at once are drawn once
  std::shared_ptr<const viz::WalkStory> walk_;
  int walkStep_ = 0;
};

}  // namespace glint::gui

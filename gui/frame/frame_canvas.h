// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QImage>
#include <QString>
#include <QTimer>
#include <QWidget>
#include <optional>
#include <vector>

#include "core/draw/frame_overlay.h"
#include "gui/frame/photo_loader.h"

namespace glint::gui {

class StaleBadge;

/// Takes over drags that start on something that can be moved.
class DragTool {
 public:
  virtual ~DragTool() = default;
  /// Something is within reach. @param at  photograph pixel  @param nearPx  what counts as near, photograph pixels
  virtual bool wouldTake(const Pixel& at, double nearPx, Qt::KeyboardModifiers modifiers) const = 0;
  /// The button went down: true = the drag is the tool's.
  virtual bool take(const Pixel& at, double nearPx, Qt::KeyboardModifiers modifiers) = 0;
  virtual void carry(const Pixel& to) = 0;
  virtual void release() = 0;
};

/// A photograph with strokes over it, zoomed and panned without limits of accuracy: photograph coordinates stay double until
/// they are drawn. Pixel (0, 0) is the centre of the top-left pixel, so that pixel's square spans -0.5 .. 0.5.
class FrameCanvas : public QWidget {
  Q_OBJECT
 public:
  explicit FrameCanvas(QWidget* parent = nullptr);

  void setPicture(const FramePicture& picture);  ///< keeps the view where the size stays the same
  void setPhotograph(const QImage& photograph);  ///< a picture without numbers
  void setMessage(const QString& message);       ///< instead of a photograph
  /// Draws another picture of the frame in the photograph's place, from a column on; all of it without a photograph. The user can
  /// drag the line between them. A picture without pixels ends it. @param left, right  texts of the chips beside the line
  void setCompared(const FramePicture& other, int from, const QString& left, const QString& right);
  bool comparing() const { return !other_.shown.isNull(); }
  /// What is drawn is another frame's photograph until the next picture or message: where that takes a moment, it is drawn faint,
  /// with these words.
  void setAwaited(const QString& words);
  void setOverlay(draw::FrameOverlay overlay);
  void setStale(bool stale);
  const StaleBadge& staleBadge() const { return *stale_; }
  /// Scale bar of false colours in a corner; empty = none.
  void setScale(std::vector<viz::ScaleTick> ticks);
  /// May be null; must outlive the canvas.
  void setDragTool(DragTool* tool) { tool_ = tool; }
  /// What is held by hand, where the hand has it: a closed line of photograph pixels and a mark; empty = nothing.
  void setHeld(std::vector<Pixel> line, std::optional<Pixel> mark);
  bool showsHeld() const { return !heldLine_.empty() || heldMark_; }
  /// A line of text in the top left corner; "" = none.
  void setCaption(const QString& caption);
  const QString& caption() const { return caption_; }
  bool hasPicture() const { return !photograph_.isNull(); }
  QSize photographSize() const { return photograph_.size(); }

  /// Widget (logical) coordinates of a photograph pixel, and back.
  QPointF widgetFromPixel(const Pixel& pixel) const;
  Pixel pixelFromWidget(const QPointF& position) const;
  bool fitted() const { return fitted_; }  ///< shows the whole photograph
  double zoom() const { return zoom_; }    ///< logical widget pixels per photograph pixel
  Pixel centre() const { return pixelFromWidget(QRectF(rect()).center()); }
  /// The values of pixels are written into them from this zoom on.
  static constexpr double kValuesFromZoom = 44;
  /// A contour this near to the mouse is meant, logical pixels.
  static constexpr double kNearScreenPx = 7;
  /// @param anchor  widget position that keeps its photograph pixel.
  void setZoom(double zoom, const QPointF& anchor);
  /// What the canvas shows, drawn again over `target` (painter units): the same photograph pixel in the middle, and at least the
  /// part on screen; strokes and texts keep their size relative to it. Vector formats get strokes as strokes.
  /// @param background  fills what lies beside the photograph; invalid = nothing does.
  void drawFigure(QPainter& painter, const QRectF& target, const QColor& background) const;
  /// Puts a photograph pixel in the middle.
  void lookAt(const Pixel& pixel, double zoom);

  QSize sizeHint() const override { return {640, 480}; }
  QSize minimumSizeHint() const override { return {200, 150}; }

 public slots:
  void fit();
  void onePixelPerPixel();

 signals:
  void probed(const QString& text);  ///< "" if the mouse leaves the photograph
  void hovered(double x, double y);  ///< photograph pixel under the mouse, after probed()
  void clicked(double x, double y);  ///< photograph pixel
  void zoomChanged(double zoom);
  void viewMoved();  ///< the user zoomed or panned
  /// The user drags the line between photograph and compared picture; share of the width.
  void dividerMoved(double share, bool begins);

 protected:
  void paintEvent(QPaintEvent*) override;
  void resizeEvent(QResizeEvent*) override;
  void wheelEvent(QWheelEvent*) override;
  void mousePressEvent(QMouseEvent*) override;
  void mouseMoveEvent(QMouseEvent*) override;
  void mouseReleaseEvent(QMouseEvent*) override;
  void mouseDoubleClickEvent(QMouseEvent*) override;
  void leaveEvent(QEvent*) override;
  bool event(QEvent* e) override;

 private:
  void draw(QPainter& painter) const;
  void drawPhotograph(QPainter& painter) const;
  void drawOverlay(QPainter& painter) const;
  void drawHeld(QPainter& painter) const;
  void drawValues(QPainter& painter, const QRect& visible) const;
  void drawValues(QPainter& painter, const FramePicture& of, const QRect& visible) const;
  void drawScale(QPainter& painter) const;
  void drawChip(QPainter& painter, const QString& text, int top) const;
  void drawChip(QPainter& painter, const QString& text, const QRect& chip) const;
  void drawDivider(QPainter& painter) const;
  void compose();
  double dividerX() const;
  bool nearDivider(const QPointF& at) const;
  const FramePicture& pictureAt(int column) const {
    return comparing() && (picture_.shown.isNull() || column >= from_) ? other_ : picture_;
  }
  void probe(const QPointF& position);

  FramePicture picture_;
  FramePicture other_;  ///< is compared with it
  int from_ = 0;        ///< its first column
  QString leftName_, rightName_;
  bool dividing_ = false, divides_ = false;  ///< the line is held; it has begun to move
  QImage photograph_;                        ///< what is on screen
  std::vector<viz::ScaleTick> scale_;
  QString message_, caption_, awaited_;
  QTimer awaiting_;  ///< runs until awaited_ is shown
  draw::FrameOverlay overlay_;
  double zoom_ = 1;
  QPointF corner_{0, 0};  ///< widget position of the photograph's top-left corner, pixel (-0.5, -0.5)
  bool fitted_ = true;    ///< follows the widget's size until the user zooms or pans
  StaleBadge* stale_;
  bool figure_ = false;  ///< drawn for a file: the photograph is cut beforehand, which vector formats cannot do
  bool dragging_ = false;
  DragTool* tool_ = nullptr;
  bool held_ = false;  ///< by the tool
  std::vector<Pixel> heldLine_;
  std::optional<Pixel> heldMark_;
  QPointF pressed_, last_;
};

}  // namespace glint::gui

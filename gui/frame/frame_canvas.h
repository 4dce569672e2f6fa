// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QImage>
#include <QString>
#include <QWidget>

#include "viz/frame_overlay.h"

namespace glint::gui {

/// A photograph with strokes over it, zoomed and panned without limits of accuracy: photograph coordinates stay double until
/// they are drawn. Pixel (0, 0) is the centre of the top-left pixel, so that pixel's square spans -0.5 .. 0.5.
class FrameCanvas : public QWidget {
  Q_OBJECT
 public:
  explicit FrameCanvas(QWidget* parent = nullptr);

  void setPhotograph(const QImage& photograph);  ///< keeps the view where the size stays the same
  void setMessage(const QString& message);       ///< instead of a photograph
  void setOverlay(viz::FrameOverlay overlay);
  void setStale(bool stale);
  /// Brightens the photograph on screen by so many stops; numbers and overlays do not change.
  void setExposure(double stops);

  /// Widget (logical) coordinates of a photograph pixel, and back.
  QPointF widgetFromPixel(const Pixel& pixel) const;
  Pixel pixelFromWidget(const QPointF& position) const;
  double zoom() const { return zoom_; }  ///< logical widget pixels per photograph pixel
  /// @param anchor  widget position that keeps its photograph pixel.
  void setZoom(double zoom, const QPointF& anchor);
  /// Puts a photograph pixel in the middle.
  void lookAt(const Pixel& pixel, double zoom);

  QSize sizeHint() const override { return {640, 480}; }
  QSize minimumSizeHint() const override { return {200, 150}; }

 public slots:
  void fit();
  void onePixelPerPixel();

 signals:
  void probed(const QString& text);  ///< "" when the mouse leaves the photograph
  void clicked(double x, double y);  ///< photograph pixel
  void zoomChanged(double zoom);

 protected:
  void paintEvent(QPaintEvent*) override;
  void resizeEvent(QResizeEvent*) override;
  void wheelEvent(QWheelEvent*) override;
  void mousePressEvent(QMouseEvent*) override;
  void mouseMoveEvent(QMouseEvent*) override;
  void mouseReleaseEvent(QMouseEvent*) override;
  void mouseDoubleClickEvent(QMouseEvent*) override;
  void leaveEvent(QEvent*) override;

 private:
  void develop();
  void drawPhotograph(QPainter& painter) const;
  void drawOverlay(QPainter& painter) const;
  void probe(const QPointF& position);

  QImage photograph_;  ///< as read
  QImage shown_;       ///< with the exposure
  double exposure_ = 0;
  QString message_;
  viz::FrameOverlay overlay_;
  double zoom_ = 1;
  QPointF corner_{0, 0};  ///< widget position of the photograph's top-left corner, pixel (-0.5, -0.5)
  bool fitted_ = true;    ///< follows the widget's size until the user zooms or pans
  bool stale_ = false;
  bool dragging_ = false;
  QPointF pressed_, last_;
};

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QMap>
#include <QPixmap>
#include <QWidget>

#include "gui/document/step_run.h"
#include "gui/timeline/thumbnails.h"
#include "viz/timeline_data.h"

class QPainter;

namespace glint::gui {

class StaleBadge;

/// Strip of all frames, from top to bottom: thumbnails, crosses where a model missed a highlight, errors (thin lines of all
/// models, or bars of the selected one), lights on and off, roles by colour and shape (training: filled square, held out: ring,
/// excluded: cross), numbers. Click and drag select; a click on a role's mark gives the frame the next role, one on a light
/// switches it there; the context menu has them all; the wheel zooms, with Shift it scrolls; Left and Right step.
///
/// What does not depend on the selected frame is painted once and kept, so that scrubbing over many frames draws a cursor only.
class TimelineStrip : public QWidget {
  Q_OBJECT
 public:
  explicit TimelineStrip(Document& document, QWidget* parent = nullptr);
  QRectF cell(int frame) const;                  ///< in widget coordinates, from the thumbnails to the errors
  QRectF roleMark(int frame) const;              ///< where the role is drawn
  QRectF missedRow() const;                      ///< above the errors: frames where a model missed a highlight; empty without any
  QRectF lightMark(int light, int frame) const;  ///< where a click switches that light of lights()
  const std::vector<viz::LightRow>& lights() const { return data_.lights; }
  int frameAt(const QPointF& position) const;  ///< -1 outside
  /// Frames in view: from `firstFrame`, as many as `framesInView` (not whole numbers while zooming).
  double firstFrame() const { return first_; }
  double framesInView() const { return inView_; }
  /// Whether every text beside the chart has room there.
  bool axisFits() const;
  void setView(double first, double inView);
  /// Frames that are marked as without a readable photograph, with the reason.
  void setUnreadable(const QMap<int, QString>& reasons);
  QList<int> unreadable() const { return unreadable_.keys(); }
  /// The tool tip there: for a light's row its light, for a frame all that is known; "" = none.
  QString tipAt(const QPoint& position) const;
  int backgroundsPainted() const { return backgroundsPainted_; }
  const Thumbnails& thumbnails() const { return thumbnails_; }
  QSize sizeHint() const override { return {600, 136}; }
  QSize minimumSizeHint() const override { return {200, 70}; }

 public slots:
  void step(int by);
  void zoom(double factor);  ///< around the selected frame; > 1 shows fewer
  void showAll() { setView(0, document_.frameCount()); }

 signals:
  void viewChanged();

 protected:
  void paintEvent(QPaintEvent*) override;
  void resizeEvent(QResizeEvent*) override;
  void changeEvent(QEvent*) override;
  void wheelEvent(QWheelEvent*) override;
  void mousePressEvent(QMouseEvent*) override;
  void mouseMoveEvent(QMouseEvent*) override;
  void contextMenuEvent(QContextMenuEvent*) override;
  void keyPressEvent(QKeyEvent*) override;
  bool event(QEvent*) override;

 private:
  void describe();  ///< for screen readers
  void readData();
  void readView();  ///< what of the document changes the background
  void showSelection();
  void repaintAll();
  void zoomAt(double frame, double factor);
  void paintBackground();
  void paintThumbnails(QPainter& painter);
  void paintErrors(QPainter& painter);
  void paintMissed(QPainter& painter);
  void paintAxisTexts(QPainter& painter, const QRectF& errors);
  void paintBars(QPainter& painter, const viz::TimelineData::Series& series, const std::vector<std::optional<QPointF>>& tops,
                 const QColor& colour, const QRectF& errors);
  void paintLine(QPainter& painter, const viz::TimelineData::Series& series, const std::vector<std::optional<QPointF>>& points,
                 const QColor& colour);
  /// Errors are drawn per frame where there is room, else per column of the screen.
  bool perFrame() const;
  int columns() const;
  double middleX(int i) const;  ///< of a frame or a column
  void paintLights(QPainter& painter);
  void paintRoles(QPainter& painter);
  void paintRole(QPainter& painter, int frame, double wide);
  void paintUnreadable(QPainter& painter);
  int firstInView() const { return std::max(0, int(first_)); }
  int endOfView() const { return std::min(document_.frameCount(), int(std::ceil(first_ + inView_))); }
  double frameX(double frame) const;
  QRectF thumbnailRow() const;
  QRectF chart() const;
  bool marksMissed(const viz::TimelineData::Series& series) const;
  double lightRowHeight() const;
  double lineHeight() const { return kLine * scale_; }  ///< of a text, px
  QFont smallFont() const;
  void measure();                 ///< scale_ and left_, after font or axis have changed
  QStringList axisTexts() const;  ///< texts beside the chart: its upper end, its lower end, "log"
  QString toolTip(int frame) const;
  QString lightTip(int row, int frame) const;  ///< frame -1: of the row
  int lightAt(double y) const;                 ///< row, -1 outside
  /// The id as elsewhere in the window; of a long one its end.
  QString idText(int frame) const;
  bool namesLights() const;  ///< their rows are high enough for their names

  Document& document_;
  viz::TimelineData data_;
  viz::ErrorAxis axis_;
  Thumbnails thumbnails_;
  StaleBadge* badge_;
  struct Drawn {
    std::string train;
    std::vector<int> excluded;
    WhatIf whatIf;
  } drawn_;  ///< of the request
  static constexpr double kLine = 14;
  double scale_ = 1;  ///< of its texts: 1 = as usual, or smaller
  double left_ = 56;  ///< px, of the chart: the texts of its axis are left of it
  double first_ = 0, inView_ = 1;
  bool bars_ = false, thumbnailsOn_ = true;
  std::string plotted_;
  QMap<int, QString> unreadable_;
  QPixmap background_;  ///< null = to be painted
  int backgroundsPainted_ = 0;
  int gesture_ = 0;
  StepRun steps_;  ///< by a key or a button
  bool scrubbing_ = false;
};

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkNew.h>

#include <QImage>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QWidget>
#include <memory>

class QVTKRenderWindowAdapter;
class vtkCallbackCommand;
class vtkGenericOpenGLRenderWindow;

namespace glint::gui {

/// A VTK render window in a plain widget: it draws into a buffer of its own, and the widget shows the picture of it.
///
/// VTK's QVTKOpenGLNativeWidget is a QOpenGLWidget, and one of those anywhere in a window makes Qt compose the whole window by
/// OpenGL at every update of any widget: without a graphics card 10 to 25 ms each time, for a number that changed in a label.
/// Reading one view's picture back costs less, and only when that view was drawn.
///
/// As there, renderWindow()->Render() draws and QWidget::update() shows the last picture again. In a new size it shows the last
/// picture until its turn to draw has come (drawInTurn). Where there is no OpenGL it says so.
class VtkCanvas : public QWidget {
  Q_OBJECT
 public:
  explicit VtkCanvas(QWidget* parent = nullptr);
  ~VtkCanvas() override;
  vtkGenericOpenGLRenderWindow* renderWindow() const { return window_; }
  /// It has an OpenGL context; not before it was first shown, and nowhere without OpenGL.
  bool ready() const { return adapter_ != nullptr; }
  /// Draws at once, also before the first turn; if the picture or its coordinates are needed now.
  void renderNow();

 protected:
  bool event(QEvent* event) override;
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  bool prepare();  ///< false if OpenGL is missing
  void fitWindow();
  void drawNext();
  bool upToDate() const;  ///< the last picture has the widget's size
  void fetch();

  vtkNew<vtkGenericOpenGLRenderWindow> window_;
  vtkNew<vtkCallbackCommand> onFrame_;
  QOffscreenSurface surface_;
  QOpenGLContext context_;
  std::unique_ptr<QVTKRenderWindowAdapter> adapter_;
  QImage picture_;
  QSize fitted_, drawnFor_;  ///< size of the widget that the window has, and that the last picture was drawn for
  double fittedRatio_ = 0, drawnRatio_ = 0;
  bool drawn_ = false, painting_ = false, failed_ = false;
};

}  // namespace glint::gui

// SPDX-License-Identifier: BSD-3-Clause
// The widget that shows what VTK draws.
#include <vtkActor2D.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkPlaneSource.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <cmath>

#include "gui/base/vtk_canvas.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class CanvasTest : public QObject {
  Q_OBJECT
 private slots:
  void aCanvasShowsWhatVtkDraws() {
    VtkCanvas canvas;
    vtkNew<vtkRenderer> above, below;
    above->SetViewport(0, 0.5, 1, 1);
    above->SetBackground(1, 0, 0);
    below->SetViewport(0, 0, 1, 0.5);
    below->SetBackground(0, 0, 1);
    for (vtkRenderer* renderer : {above.Get(), below.Get()}) canvas.renderWindow()->AddRenderer(renderer);
    canvas.resize(120, 80);
    canvas.show();
    const auto expectHalves = [&] {
      const QImage picture = canvas.grab().toImage();
      QCOMPARE(picture.size(), canvas.size() * canvas.devicePixelRatioF());
      int others = 0;  // but for the rows about the border between the halves
      for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width() && std::abs(y - picture.height() / 2) > 1; ++x)
          others += picture.pixelColor(x, y) != (y < picture.height() / 2 ? QColor(255, 0, 0) : QColor(0, 0, 255));
      QCOMPARE(others, 0);
    };
    expectHalves();
    canvas.resize(61, 201);
    expectHalves();
    below->SetBackground(0, 1, 0);
    canvas.update();
    expectHalves();  // the last picture again, until VTK draws
    canvas.renderWindow()->Render();
    const QImage last = canvas.grab().toImage();  // twice as large at 200 %
    QCOMPARE(last.pixelColor(last.width() / 2, last.height() - 3), QColor(0, 255, 0));
  }

  void whatACanvasDrawsFlatCoversWhatWasDrawnFlatBefore() {
    VtkCanvas canvas;
    vtkNew<vtkRenderer> renderer;
    canvas.renderWindow()->AddRenderer(renderer);
    vtkNew<vtkPlaneSource> sheet;  // a photograph over the scene: the lower left 400 x 400 pixels
    sheet->SetOrigin(0, 0, 0);
    sheet->SetPoint1(400, 0, 0);
    sheet->SetPoint2(0, 400, 0);
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputConnection(sheet->GetOutputPort());
    vtkNew<vtkActor2D> photograph;
    photograph->SetMapper(mapper);
    photograph->GetProperty()->SetColor(0, 0, 1);
    vtkNew<vtkTextActor> caption;
    caption->SetInput("caption");
    caption->GetTextProperty()->SetBackgroundColor(1, 0, 0);
    caption->GetTextProperty()->SetBackgroundOpacity(1);
    caption->SetPosition(10, 10);
    renderer->AddActor2D(photograph);
    renderer->AddActor2D(caption);
    canvas.resize(100, 80);
    canvas.show();
    const QImage picture = canvas.grab().toImage();
    int red = 0;
    for (int y = 0; y < picture.height(); ++y)
      for (int x = 0; x < picture.width(); ++x) red += picture.pixelColor(x, y) == QColor(255, 0, 0);
    QCOMPARE(picture.pixelColor(picture.width() - 2, 2), QColor(0, 0, 255));
    QVERIFY2(red > 50, qPrintable(QString::number(red)));
  }
};

QObject* makeCanvasTest() { return new CanvasTest; }

}  // namespace glint::gui

#include "canvas_test.moc"

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkCoordinate.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>

#include "core/draw/colours.h"

namespace glint::viz {

/// A plain rectangle in display pixels, on which a legend is read over any photograph.
class LegendPanel {
 public:
  LegendPanel() {
    points_->SetNumberOfPoints(4);
    polygons_->InsertNextCell({0, 1, 2, 3});
    data_->SetPoints(points_);
    data_->SetPolys(polygons_);
    vtkNew<vtkPolyDataMapper2D> mapper;
    vtkNew<vtkCoordinate> display;
    display->SetCoordinateSystemToDisplay();
    mapper->SetTransformCoordinate(display);
    mapper->SetInputData(data_);
    actor_->SetMapper(mapper);
    actor_->PickableOff();
    actor_->VisibilityOff();
  }
  /// Add it before its texts.
  vtkActor2D* actor() const { return actor_; }
  void hide() { actor_->VisibilityOff(); }
  void show(double x0, double y0, double x1, double y1, const draw::Colour& colour) {
    constexpr double kOpacity = 0.85;  // bright text stays above 4.5 : 1 over white; the photograph can still be made out
    points_->SetPoint(0, x0, y0, 0);
    points_->SetPoint(1, x1, y0, 0);
    points_->SetPoint(2, x1, y1, 0);
    points_->SetPoint(3, x0, y1, 0);
    points_->Modified();
    data_->Modified();
    actor_->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
    actor_->GetProperty()->SetOpacity(kOpacity);
    actor_->VisibilityOn();
  }

 private:
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> polygons_;
  vtkNew<vtkPolyData> data_;
  vtkNew<vtkActor2D> actor_;
};

}  // namespace glint::viz

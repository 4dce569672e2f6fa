// SPDX-License-Identifier: BSD-3-Clause
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include "core/surface/analytic_shape.h"

namespace glint {

TriangleMesh contourShape(const AnalyticShape& shape, const Eigen::AlignedBox3d& box, int resolution) {
  const int n = resolution + 1;
  const Eigen::Vector3d step = box.sizes() / resolution;
  vtkNew<vtkImageData> grid;
  grid->SetDimensions(n, n, n);  // unit spacing: positions are scaled in double afterwards
  vtkNew<vtkDoubleArray> values;
  values->SetNumberOfTuples(static_cast<vtkIdType>(n) * n * n);
  vtkIdType id = 0;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) values->SetValue(id++, shape.value(box.min() + step.cwiseProduct(Eigen::Vector3d(i, j, k))));
  grid->GetPointData()->SetScalars(values);
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(grid);
  contour->SetValue(0, 0.0);
  contour->ComputeNormalsOff();
  contour->ComputeGradientsOff();
  contour->ComputeScalarsOff();
  contour->Update();

  TriangleMesh mesh;
  vtkPolyData* out = contour->GetOutput();
  for (vtkIdType i = 0; i < out->GetNumberOfPoints(); ++i) {
    double x[3];
    out->GetPoint(i, x);
    Eigen::Vector3d p = box.min() + step.cwiseProduct(Eigen::Vector3d(x[0], x[1], x[2]));
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3d g = shape.gradient(p);
      if (!(g.squaredNorm() > 0)) break;
      p -= shape.value(p) / g.squaredNorm() * g;
    }
    mesh.vertices.push_back(p);
  }
  vtkNew<vtkIdList> ids;
  vtkCellArray* cells = out->GetPolys();
  for (cells->InitTraversal(); cells->GetNextCell(ids);)
    if (ids->GetNumberOfIds() == 3)
      mesh.triangles.emplace_back(static_cast<int>(ids->GetId(0)), static_cast<int>(ids->GetId(1)),
                                  static_cast<int>(ids->GetId(2)));
  return mesh;
}

}  // namespace glint

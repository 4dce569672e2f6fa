// SPDX-License-Identifier: BSD-3-Clause
#include <vtkActor.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>

#include "viz/layers.h"

namespace glint::viz {

LayerContent surfaceLayer(const LayerInput& in) {
  LayerContent content;
  if (!in.surface) {
    content.notes.push_back("surface: " + (in.surfaceProblem.empty() ? "none" : in.surfaceProblem));
    return content;
  }
  vtkSmartPointer<vtkPolyData> triangles = in.cache->tessellation(in.surface, in.scale.surfaceBox);
  if (triangles->GetNumberOfPolys() == 0) {
    content.notes.push_back("surface: no triangles to draw");
    return content;
  }
  vtkNew<vtkPolyDataMapper> mapper;
  if (triangles->GetPointData()->GetNormals()) {
    mapper->SetInputData(triangles);
  } else {
    vtkNew<vtkPolyDataNormals> normals;
    normals->SetInputData(triangles);
    normals->SetFeatureAngle(40);
    normals->Update();
    mapper->SetInputData(normals->GetOutput());
  }
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty* look = actor->GetProperty();
  look->SetColor(kSurface[0], kSurface[1], kSurface[2]);
  look->SetAmbient(0.18);
  look->SetDiffuse(0.72);
  look->SetSpecular(0.12);  // enough to look glossy, too little to be mistaken for a measured highlight
  look->SetSpecularPower(30);
  look->SetInterpolationToPhong();
  look->BackfaceCullingOff();
  Picked info;
  info.layer = "surface";
  content.add(actor.Get(), info, 0, false);  // picked through Surface::firstHit, exactly
  return content;
}

}  // namespace glint::viz

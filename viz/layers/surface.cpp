// SPDX-License-Identifier: BSD-3-Clause
#include <vtkActor.h>
#include <vtkPlane.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include "viz/layers.h"

namespace glint::viz {

LayerContent surfaceLayer(const LayerInput& in) {
  LayerContent content;
  if (!in.surface) {
    // Before there are results a surface that is read from a file is still on its way: that is no failure.
    const bool loading = !in.inspection->surfaces && in.inspection->evidence.empty();
    if (loading)
      content.remarks.push_back("surface: loading\u2026");
    else
      content.notes.push_back("surface: " + (in.surfaceProblem.empty() ? "none" : in.surfaceProblem));
    return content;
  }
  if (in.hidden.hidesSurface(in.surfaceKey)) return content;
  const vtkSmartPointer<vtkPolyData> triangles = in.cache->tessellation(in.surface, in.scale.surfaceBox).fine;
  if (triangles->GetNumberOfPolys() == 0) {
    content.notes.push_back("surface: no triangles to draw");
    return content;
  }
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(triangles);
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

namespace {
/// Bodies that are inside need more than what stands out beyond the surface.
double opacityBefore(Behind behind) { return behind == Behind::Ellipsoids ? 0.35 : behind == Behind::VirtualCameras ? 0.7 : 1.0; }
}  // namespace

void styleSurface(const LayerContent& surface, const LayerInput& in, Behind behind, bool moving) {
  const double opacity = in.eye == Eye::Outside ? opacityBefore(behind) : 1.0;
  for (const Drawn& drawn : surface.drawn) {
    auto* actor = vtkActor::SafeDownCast(drawn.prop);
    auto* mapper = actor ? vtkPolyDataMapper::SafeDownCast(actor->GetMapper()) : nullptr;
    if (!mapper || !in.surface) continue;
    const LayerCache::Triangles triangles = in.cache->tessellation(in.surface, in.scale.surfaceBox);
    const vtkSmartPointer<vtkPolyData> coarse = moving ? triangles.coarseIfReady() : nullptr;
    const vtkSmartPointer<vtkPolyData> shown = coarse ? coarse : triangles.fine;
    if (mapper->GetInput() != shown) mapper->SetInputData(shown);
    actor->GetProperty()->SetOpacity(shown->GetNumberOfPolys() <= kLargeSurface ? opacity : 1.0);
    mapper->RemoveAllClippingPlanes();
    if (!in.eyeMirror) continue;
    const Plane& plane = *in.eyeMirror;  // its normal is on the camera's side, where the light is
    const Eigen::Vector3d at = (in.scale.lift - plane.offset) * plane.normal;
    vtkNew<vtkPlane> cut;
    cut->SetOrigin(at.x(), at.y(), at.z());
    cut->SetNormal(plane.normal.x(), plane.normal.y(), plane.normal.z());
    mapper->AddClippingPlane(cut);
  }
}

}  // namespace glint::viz

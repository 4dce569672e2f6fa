// SPDX-License-Identifier: BSD-3-Clause
#include "viz/photograph_overlay.h"

#include <vtkCellArray.h>
#include <vtkCoordinate.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkTexture.h>
#include <vtkTexturedActor2D.h>

#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace glint::viz {
namespace {

constexpr int kCells = 64;  ///< across a distorted photograph: between the nodes distortion is taken as linear

bool sameLens(const Camera& a, const Camera& b) {
  return a.width == b.width && a.height == b.height && a.lens == b.lens && a.pixelFromRay == b.pixelFromRay;
}

}  // namespace

struct PhotographOverlay::Impl {
  vtkRenderer* renderer = nullptr;
  vtkSmartPointer<vtkImageData> photograph;
  vtkNew<vtkTexture> texture;
  vtkNew<vtkPoints> points;
  vtkNew<vtkPolyData> data;
  vtkNew<vtkTexturedActor2D> actor;
  std::optional<Camera> lens;  // whose nodes are stored
  std::vector<Pixel> nodes;    // ideal pixels; not finite where the lens shows nothing

  /// Nodes on a grid of the photograph, and the cells between those that exist.
  void mesh(const Camera& camera) {
    if (lens && sameLens(*lens, camera)) return;
    lens = camera;
    nodes.clear();
    const int n = camera.hasDistortion() ? kCells : 1;
    vtkNew<vtkFloatArray> coordinates;
    coordinates->SetNumberOfComponents(2);
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
        nodes.push_back(camera.undistorted({u * camera.width - 0.5, v * camera.height - 0.5}));
        coordinates->InsertNextTuple2(u, 1 - v);
      }
    }
    vtkNew<vtkCellArray> cells;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const vtkIdType at = j * (n + 1) + i;
        const std::array<vtkIdType, 4> corners{at, at + 1, at + n + 2, at + n + 1};
        bool whole = true;
        for (const vtkIdType c : corners) whole = whole && nodes[static_cast<std::size_t>(c)].allFinite();
        if (whole) cells->InsertNextCell(4, corners.data());
      }
    }
    data->SetPolys(cells);
    data->GetPointData()->SetTCoords(coordinates);
  }
};

PhotographOverlay::PhotographOverlay(vtkRenderer* renderer) : impl_(std::make_unique<Impl>()) {
  impl_->renderer = renderer;
  impl_->points->SetDataTypeToDouble();
  impl_->data->SetPoints(impl_->points);
  impl_->texture->InterpolateOn();
  impl_->texture->MipmapOn();
  impl_->texture->SetWrap(vtkTexture::ClampToEdge);
  vtkNew<vtkPolyDataMapper2D> mapper;
  vtkNew<vtkCoordinate> display;
  display->SetCoordinateSystemToDisplay();
  mapper->SetTransformCoordinate(display);
  mapper->SetTransformCoordinateUseDouble(true);  // else every node is rounded to a whole pixel
  mapper->SetInputData(impl_->data);
  impl_->actor->SetMapper(mapper);
  impl_->actor->PickableOff();
  impl_->actor->VisibilityOff();
  renderer->AddActor2D(impl_->actor);
}

PhotographOverlay::~PhotographOverlay() { impl_->renderer->RemoveActor2D(impl_->actor); }

void PhotographOverlay::setPhotograph(vtkSmartPointer<vtkImageData> photograph) {
  if (photograph == impl_->photograph) return;
  impl_->photograph = std::move(photograph);
  if (impl_->photograph) {
    impl_->texture->SetInputData(impl_->photograph);
    impl_->actor->SetTexture(impl_->texture);
  } else {
    hide();
  }
}

bool PhotographOverlay::hasPhotograph() const { return impl_->photograph != nullptr; }

void PhotographOverlay::place(const Camera& camera, const PhotographPlacement& placement, double opacity) {
  if (!impl_->photograph || !(opacity > 0)) return hide();
  impl_->mesh(camera);
  impl_->points->SetNumberOfPoints(static_cast<vtkIdType>(impl_->nodes.size()));
  for (std::size_t i = 0; i < impl_->nodes.size(); ++i) {
    const Eigen::Vector2d at = impl_->nodes[i].allFinite() ? placement.at(impl_->nodes[i]) : Eigen::Vector2d(0, 0);
    impl_->points->SetPoint(static_cast<vtkIdType>(i), at.x(), at.y(), 0);
  }
  impl_->points->Modified();
  impl_->data->Modified();
  impl_->actor->GetProperty()->SetOpacity(opacity);
  impl_->actor->VisibilityOn();
}

void PhotographOverlay::hide() { impl_->actor->VisibilityOff(); }

}  // namespace glint::viz

// SPDX-License-Identifier: BSD-3-Clause
#include "viz/photograph_stand.h"

#include <vtkImageData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <algorithm>

namespace glint::viz {

void PhotographStand::setPhotograph(int frame, vtkSmartPointer<vtkImageData> photograph) {
  frame_ = photograph ? frame : -1;
  overlay_.setPhotograph(std::move(photograph));
}

void PhotographStand::setOpacity(double opacity) { opacity_ = std::clamp(opacity, 0.0, 1.0); }

void PhotographStand::zoom(double factor, const Eigen::Vector2d& display) {
  constexpr double kLeast = 0.2, kMost = 200;
  const double wanted = std::clamp(zoom_ * factor, kLeast, kMost);
  const PictureArea whole = area();
  const Eigen::Vector2d at = display - origin() - 0.5 * Eigen::Vector2d(whole.width, whole.height);
  shift_ = at + (wanted / zoom_) * (shift_ - at);
  zoom_ = wanted;
}

void PhotographStand::resetZoom() {
  zoom_ = 1;
  shift_.setZero();
}

PictureArea PhotographStand::area() const {
  vtkRenderWindow* window = renderer_->GetRenderWindow();
  if (!window) return lastArea_;
  const int* own = renderer_->GetSize();
  const int width = std::max(own[0], 1), height = std::max(own[1], 1);
  if (!partOfWindow_) return {width, height, 0, width};
  const int left = renderer_->GetOrigin()[0];
  return {std::max(window->GetSize()[0], left + width), height, left, left + width};
}

Eigen::Vector2d PhotographStand::origin() const {
  return {partOfWindow_ ? 0.0 : double(renderer_->GetOrigin()[0]), double(renderer_->GetOrigin()[1])};
}

void PhotographStand::show(int frame, const Camera& camera) {
  if (frame_ != frame) return hide();
  PhotographPlacement place = placement(camera);
  place.topLeft += origin();
  overlay_.place(camera, place, opacity_);
}

}  // namespace glint::viz

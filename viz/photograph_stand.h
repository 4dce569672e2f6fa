// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkSmartPointer.h>

#include <Eigen/Core>

#include "viz/photograph_overlay.h"
#include "viz/view_camera.h"

class vtkImageData;
class vtkRenderer;

namespace glint::viz {

/// The picture that a renderer draws while it looks through a camera, and where the camera's photograph lies in it: enlarged and
/// moved by the user, over the 3D picture. Display coordinates are window px, y up.
class PhotographStand {
 public:
  explicit PhotographStand(vtkRenderer* renderer) : renderer_(renderer), overlay_(renderer) {}

  /// @param photograph  of that frame; null = none.
  void setPhotograph(int frame, vtkSmartPointer<vtkImageData> photograph);
  void setOpacity(double opacity);
  /// The renderer draws its own columns of the window's picture (the wipe) instead of a picture of its own.
  void setPartOfWindow(bool part) { partOfWindow_ = part; }
  bool partOfWindow() const { return partOfWindow_; }

  /// Enlarges by a factor; what lies under `display` stays there.
  void zoom(double factor, const Eigen::Vector2d& display);
  void move(const Eigen::Vector2d& by) { shift_ += by; }
  void resetZoom();

  /// The picture that the renderer draws, or draws its part of; that of the last frame while it is in no window.
  PictureArea area() const;
  /// Once at the start of each frame.
  void keepArea() { lastArea_ = area(); }
  PhotographPlacement placement(const Camera& camera) const { return placePhotograph(camera, area(), zoom_, shift_); }
  /// Where an ideal pixel of the camera is drawn, display coordinates.
  Eigen::Vector2d displayOf(const Camera& camera, const Pixel& ideal) const { return placement(camera).at(ideal) + origin(); }

  /// Shows the photograph if it belongs to the frame.
  void show(int frame, const Camera& camera);
  void hide() { overlay_.hide(); }

 private:
  Eigen::Vector2d origin() const;  ///< lower left corner of the picture in the window

  vtkRenderer* renderer_;
  PhotographOverlay overlay_;
  int frame_ = -1;
  double opacity_ = 0.5, zoom_ = 1;
  Eigen::Vector2d shift_{0, 0};
  bool partOfWindow_ = false;
  PictureArea lastArea_;
};

}  // namespace glint::viz

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkSmartPointer.h>

#include <memory>

#include "viz/view_camera.h"

class vtkImageData;
class vtkRenderer;

namespace glint::viz {

/// A photograph over the 3D picture, its lens distortion removed while it is drawn: each measured pixel lies where its ideal
/// pixel is placed, to 0.05 px of a 640 px wide photograph.
class PhotographOverlay {
 public:
  explicit PhotographOverlay(vtkRenderer* renderer);
  ~PhotographOverlay();
  /// @param photograph  RGB, bottom row first; null = none.
  void setPhotograph(vtkSmartPointer<vtkImageData> photograph);
  bool hasPhotograph() const;
  /// @param camera  of the photograph. @param opacity  0..1; 0 draws nothing.
  void place(const Camera& camera, const PhotographPlacement& placement, double opacity);
  void hide();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint::viz

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkSmartPointer.h>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

class vtkRenderer;

namespace glint::viz {

/// A layer of the 3D picture, toggled by name (formats.md: layer visibility in sessions uses `name`).
struct Layer {
  std::string name;     ///< "surface", "virtual-cameras"
  std::string title;    ///< "Virtual cameras"
  bool onByDefault = true;
};
/// surface, cameras, photographs, virtual-cameras, peaks, tangent-planes, canonical-ellipses, directions, ellipsoids,
/// light, true-light, rays, observed-contours, predicted-contours.
const std::vector<Layer>& sceneLayers();

/// What is selected; shared by all views.
struct Selection {
  int frame = 0;
  std::string model;            ///< "" = all models
  int highlight = -1;           ///< index in the frame's evidence, -1 = none
};

/// What lies under the mouse, with its numbers.
struct Picked {
  std::string layer;
  int frame = -1;
  std::string model;
  Eigen::Vector3d position{0, 0, 0};    ///< world, m
  std::string text;                     ///< lines "name = value unit" for the panel and the clipboard
};

/// The 3D picture of an inspection: one actor group per layer, rebuilt only where its input changed. No Qt.
class SceneView {
 public:
  SceneView();
  ~SceneView();
  vtkRenderer* renderer() const;
  /// May be null (empty picture).
  void setInspection(std::shared_ptr<const Inspection> inspection);
  void setSelection(const Selection& selection);
  void setLayerVisible(const std::string& name, bool visible);  ///< std::invalid_argument for an unknown name
  bool layerVisible(const std::string& name) const;
  void setDarkBackground(bool dark);
  void frameAll();
  std::optional<Picked> pick(int xDisplay, int yDisplay) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint::viz

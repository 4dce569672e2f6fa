// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkSmartPointer.h>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"
#include "viz/selection.h"

class vtkRenderer;
class vtkRenderWindow;

namespace glint::viz {

/// A layer of the 3D picture, toggled by name (formats.md: layer visibility in sessions uses `name`).
struct Layer {
  std::string name;   ///< "surface", "virtual-cameras"
  std::string title;  ///< "Virtual cameras"
  bool onByDefault = true;
};
/// surface, cameras, photographs, virtual-cameras, peaks, tangent-planes, canonical-ellipses, directions, ellipsoids,
/// light, true-light, rays, observed-contours, predicted-contours.
const std::vector<Layer>& sceneLayers();

/// What lies under the mouse, with its numbers.
struct Picked {
  std::string layer;
  int frame = -1;
  std::string model;
  int highlight = -1;                 ///< index in the frame's evidence, -1 = none
  std::string light;                  ///< "" = none
  std::optional<double> direction;    ///< see Selection::direction
  Eigen::Vector3d position{0, 0, 0};  ///< world, m
  std::string text;                   ///< lines "name = value unit" for the panel and the clipboard
};

/// A 3D camera, as sessions store it. World units; `viewAngleDeg` is the vertical field of view.
struct ViewPoint {
  Eigen::Vector3d position{0, 0, 1}, focalPoint{0, 0, 0}, up{0, 1, 0};
  double viewAngleDeg = 30;
};

/// Makes a render window fit for SceneView: alpha bit planes and no multisampling (depth peeling needs both).
/// Call before the window's first render.
void prepareWindow(vtkRenderWindow* window);

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
  /// Models whose parts are drawn; empty = all.
  void setModels(const std::set<std::string>& models);
  /// Size of cameras, arrows, points and lines relative to the default for the scene's extent; > 0.
  void setGlyphScale(double scale);
  /// A view from outside that holds the surface, the cameras and a light that is not far beyond them.
  void frameAll();
  /// Looks from a frame's camera along its axis with its vertical field of view.
  void lookThrough(int frame);
  ViewPoint viewPoint() const;
  void setViewPoint(const ViewPoint& viewPoint);
  /// Brings the actors of all visible layers up to date. Rendering does this by itself; only code that reads actors needs it.
  void update();
  /// How often a layer was built since construction; for tests of "rebuilt only where its input changed".
  int buildCount(const std::string& layer) const;
  std::optional<Picked> pick(int xDisplay, int yDisplay) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint::viz

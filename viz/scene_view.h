// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkSmartPointer.h>

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/draw/selection.h"
#include "core/pipeline/inspection.h"
#include "viz/hidden_objects.h"
#include "viz/style.h"

class vtkImageData;
class vtkRenderer;
class vtkRenderWindow;

namespace glint {
struct LampAnswer;
}

namespace glint::viz {

class LayerCache;
struct WalkStory;
struct DrawnRuns;

/// A layer of the 3D picture, toggled by name (sessions keep visibility by `name`: docs/formats.md, "Session").
struct Layer {
  std::string name;   ///< "surface", "virtual-cameras"
  std::string title;  ///< "Virtual cameras"
  bool onByDefault = true;
};
/// surface, cameras, photographs, virtual-cameras, peaks, tangent-planes, canonical-ellipses, directions, walk, cones,
/// ellipsoids, light, true-light, measured-lamps, solver-runs, rays, observed-contours, predicted-contours.
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
  int predicted = -1;                 ///< of a spurious highlight, see Selection::predicted
  std::string text;                   ///< lines "name = value unit" for the panel and the clipboard
};

/// A 3D camera, as sessions store it. World units; `viewAngleDeg` is the vertical field of view.
struct ViewPoint {
  Eigen::Vector3d position{0, 0, 1}, focalPoint{0, 0, 0}, up{0, 1, 0};
  double viewAngleDeg = 30;
  bool parallel = false;  ///< orthographic, as high at the focal point as the perspective view would be
};

/// Where the picture is seen from: freely, or through the selected frame's camera, or through its virtual camera P M.
enum class Eye { Outside, Camera, VirtualCamera };

/// Along the world's axes; which is upwards is guessed from the cameras.
enum class AxisView { Front, Back, Left, Right, Top, Bottom };

/// How a highlight is looked at: T from the side, so that the gap between S and T shows, with the ends of its walks; as its
/// camera sees it, from a little aside; with its camera, the virtual camera and the light, square to the plane of reflection.
enum class HighlightLook { Section, Camera, Mirror };

/// What the colour of a drawn camera says.
struct CameraColours {
  enum class By { Role, Model, Error, Influence };
  By by = By::Role;
  std::string model;                ///< whose error or influence, "" = the richest shown
  std::map<int, double> influence;  ///< by training frame: see influenceOf(), percentage points; absent = not left out
  friend bool operator==(const CameraColours&, const CameraColours&) = default;
};

/// Makes a render window fit for SceneView: alpha bit planes and no multisampling (depth peeling needs both).
/// Call before the window's first render.
void prepareWindow(vtkRenderWindow* window);

/// The 3D picture of an inspection: one actor group per layer, rebuilt only where its input changed. No Qt.
class SceneView {
 public:
  /// @param cache  shared by views of the same inspection; null = its own.
  explicit SceneView(std::shared_ptr<LayerCache> cache = nullptr);
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
  /// Only the selected frame's camera, and what was derived from it.
  void setSolo(bool solo);
  void setHidden(const HiddenObjects& hidden);
  void setCameraColours(const CameraColours& colours);

  /// What the layer "walk" draws, as far as `step`; null = nothing.
  void setWalk(std::shared_ptr<const WalkStory> walk, int step);

  /// What the layer "measured-lamps" draws; null = nothing. They stay until others come, also over another scene.
  void setLamps(std::shared_ptr<const std::vector<LampAnswer>> lamps);

  /// What the layer "solver-runs" draws; null = nothing.
  void setRuns(std::shared_ptr<const std::vector<DrawnRuns>> runs);

  /// A view from outside that holds the surface, the cameras and a light that is not far beyond them.
  void frameAll();
  /// The same direction, but only what is selected: the highlight on the surface, else the model's ellipsoids, else the camera
  /// with its brightest points.
  void frameSelection();
  /// A view of the selected frame's highlight. @param highlight  index in the frame's evidence; out of range = the first.
  /// False, and nothing moves, where that is not on the surface.
  bool frameHighlight(int highlight, HighlightLook look);
  /// A view of the surface's highlights and of all that leads to the ellipsoids of the model (of all models: ""): their cones.
  void frameEllipsoids(const std::string& model);
  void lookAlong(AxisView view);
  void setParallel(bool parallel);
  bool parallel() const;
  /// Follows the selected frame until it is set back to Outside, which brings the earlier view back. Pixels of the photograph and
  /// geometry agree exactly, see displayOf(). Where there is no virtual camera the view stays outside, and eyeText() says why.
  void setEye(Eye eye);
  Eye eye() const;
  bool looksThrough() const;    ///< setEye() is in effect
  std::string eyeText() const;  ///< "through camera 0007", or why not; "" outside
  /// The photograph over the picture while looking through a camera, its lens distortion removed.
  /// @param photograph  RGB, bottom row first; null = none. Drawn only while `frame` is selected.
  void setPhotograph(int frame, vtkSmartPointer<vtkImageData> photograph);
  void setPhotographOpacity(double opacity);  ///< 0..1
  /// While looking through a camera: enlarges about a window px (y up), moves. Looking through another eye resets them.
  void zoomPhotograph(double factor, double x, double y);
  void movePhotograph(double dx, double dy);
  /// Window px (y up, corner of the lower left pixel = 0) of an ideal pixel of the selected frame while looking through it.
  std::optional<Eigen::Vector2d> displayOf(double idealX, double idealY) const;

  /// The renderer's viewport shows its part of the picture of the whole window (the wipe) instead of a picture of its own.
  void setPartOfWindow(bool part);
  /// Draws a border, in the accent colour where the view is the active one. @param name  shown in the upper right corner, may be
  /// "".
  void setFrame(bool border, bool active, const std::string& name);
  /// Legend, notes and title (`title`: also that); labels, axes and scale stay.
  void setLegendVisible(bool visible, bool title = true);
  void setTextScale(double scale);  ///< of all texts; 1 = as usual
  /// While something moves, a surface of more than 200,000 triangles is drawn coarsely, once its coarse version is ready.
  void setMoving(bool moving);
  /// There is a coarse version, so that setMoving() changes the picture.
  bool hasCoarseSurface() const;
  /// Photographs that were not there yet may be there now: see LayerCache::setPhotographSource.
  void photographsArrived();

  ViewPoint viewPoint() const;
  void setViewPoint(const ViewPoint& viewPoint);
  /// Brings the actors of all visible layers up to date. Rendering does this by itself; only code that reads actors needs it.
  void update();
  /// How often a layer was built since construction; for tests of "rebuilt only where its input changed".
  int buildCount(const std::string& layer) const;
  std::optional<Picked> pick(int xDisplay, int yDisplay) const;
  /// The true light that is drawn there, also behind an ellipsoid, rays or whatever else shines through; nothing if the
  /// surface hides it.
  std::optional<Picked> pickLamp(int xDisplay, int yDisplay) const;
  /// The nearest camera that is drawn there, also between its lines; nothing if none is or cameras are hidden.
  std::optional<Picked> pickCamera(int xDisplay, int yDisplay) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint::viz

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/draw/colours.h"
#include "core/draw/on_surface.h"
#include "core/draw/scene_scale.h"
#include "core/geometry/ellipsoid.h"
#include "core/reflectance/lamp.h"

// What a 3D picture shows of an inspection, as plain data. The window, the shared page, Python and the programs that use it paint
// the same things; each chooses widths, and what to hide. World units (m) and world coordinates throughout.
namespace glint::draw {

/// What a thing shows. Painters choose its look by it, switches of views hide it by it.
enum class SceneRole {
  Surface,
  Camera,
  VirtualCamera,
  BrightestPoint,
  TangentPlane,
  CanonicalEllipse,
  ViewRay,
  ReflectedRay,
  ObservedContour,
  PredictedContour,
  Ellipsoid,
  Light,       ///< estimated from the contours with one limit angle
  FittedLamp,  ///< as a model's fit has it
  TrueLamp
};
/// "tangent-plane".
const char* nameOf(SceneRole role);

/// One thing of the picture: what it is, whose it is, and what is painted of it: everything that is set.
struct SceneThing {
  SceneRole role = SceneRole::Camera;
  int frame = -1;      ///< index; -1 = of the whole scene
  int highlight = -1;  ///< index; of contours into FrameEvidence::scored(), else into its highlights; predicted: the prediction's
  std::string light{};                   ///< id; "" = of none
  std::string model{};                   ///< of a fit or a prediction; "" = observed, estimated or true
  std::optional<std::string> surface{};  ///< key of the one surface for which it holds; none = for all
  bool poor = false;                     ///< its model explains the training views badly
  bool shared = false;                   ///< a fitted lamp in the place of an estimate
  std::string label{};
  std::string problem{};  ///< why nothing is painted of it

  std::vector<WorldChain> chains{};        ///< lines; a closed one ends at its first point
  bool gap = false;                        ///< the chains only bridge directions without an answer
  std::optional<Eigen::Vector4d> place{};  ///< a point, homogeneous; w = 0: at infinity
  Eigen::Vector3d normal{0, 0, 0};         ///< unit normal of the surface or plane at `place`; 0 = it has none
  double radius = 0;                       ///< of a disc about `place` across `normal`
  std::optional<Ellipsoid> body{};
  std::shared_ptr<const Surface> mesh{};
  /// From, to: painted in place of all that, where it lies too far away to be seen in the same picture.
  std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> arrow{};

  Eigen::Vector3d position() const { return place->hnormalized(); }
};
using SceneDrawing = std::vector<SceneThing>;

/// The colour of its model, paler where that is poor; else of its role.
Colour colourOf(const SceneThing& thing);

struct DrawingOptions {
  SceneScale scale;
  double planeTimes = 3;         ///< radius of a tangent plane, of that of the highlight on it
  double leastLamp = 0;          ///< a true lamp is outlined at least so large; m
  std::size_t mostPoints = 0;    ///< of a contour on the surface; 0 = as many as a screen shows
  bool predictedMirrors = true;  ///< tangent planes, virtual cameras and canonical ellipses of predictions, too
};
/// What belongs to no frame: estimated lights, lamps of all fits, true lamps, ellipsoids of all fits; of those lights alone that
/// stand still in the scene.
SceneDrawing sceneThings(const Inspection& inspection, const DrawingOptions& options);
/// What belongs to one frame: its surface and camera; lights that stand elsewhere (LightFrameChoice::elsewhere); of each observed
/// highlight the contour on the surface, brightest point, tangent plane, virtual camera, canonical ellipse and rays; of each
/// model the predicted contours.
/// @param frame    index; std::invalid_argument if it does not exist
/// @param surface  of the frame; null = none, and only the camera is drawn
SceneDrawing frameThings(const Inspection& inspection, int frame, const std::shared_ptr<const Surface>& surface,
                         const DrawingOptions& options);

// Parts of these, for views that show fewer of them or other frames at the same time.

/// A circle of `n` points (the first repeated at the end) about `centre`.
WorldChain circle(const Eigen::Vector3d& centre, const Eigen::Vector3d& axisU, const Eigen::Vector3d& axisV, int n = 96);
/// The image plane's edge from its top left corner, clockwise in the image; the four edges from the centre; the tick above the
/// upper edge, which shows the side of the image that is up. @param depth  of the image plane
std::vector<WorldChain> frustum(const Camera& camera, double depth);
/// The four corners of the image plane at a depth, from top left clockwise in the image.
std::array<Eigen::Vector3d, 4> imagePlane(const Camera& camera, double depth);
/// Carries the unit sphere to the ellipsoid. @param least  of the largest semi-axis: a shorter one is taken as so long
Eigen::Affine3d ballOf(const Ellipsoid& ellipsoid, double least);
/// The three circles of the unit sphere in the coordinate planes, carried along.
std::vector<WorldChain> principalEllipses(const Eigen::Affine3d& worldFromUnitSphere);

/// @param label  continued by ", at infinity" or ", 12 m away" where an arrow stands for it
SceneThing lampThing(SceneRole role, const Lamp& lamp, const std::string& label, const SceneScale& scale);
SceneThing estimateThing(const std::string& light, const Lamp& estimate, const SceneScale& scale);
/// The lamp of a fit that has one: a shape where the model knows it, else a point.
std::optional<SceneThing> fittedLampThing(const Inspection& inspection, const ModelFit& fit, const SceneScale& scale);
/// @param least  radius of its outline, at least: so that a small one is seen
SceneThing trueLampThing(const TrueLight& light, double least, const SceneScale& scale);
/// With `problem`, and without `body`, where Q* is no ellipsoid; with both where the body is too large or too far away to be seen
/// with the scene; nothing for a model without ellipsoid.
std::optional<SceneThing> ellipsoidThing(const ModelFit& fit, const SceneScale& scale);

/// The mirror image of a camera in a tangent plane; `place` is its centre.
SceneThing virtualCameraThing(const Camera& camera, const Plane& plane, double depth);
/// A disc about a point of the plane, with its rim.
SceneThing tangentPlaneThing(const Plane& plane, const Eigen::Vector3d& at, double radius);
/// From the camera to the brightest point, and from there along the reflected direction: as far as the light, if it is in reach.
/// @param view  seen
std::vector<SceneThing> rayThings(const Inspection& inspection, const TrainingView& view, const SceneScale& scale);
/// A predicted contour on the surface: what is predicted, then what bridges failed directions, if any.
std::vector<SceneThing> predictedContourThings(const Camera& camera, const Surface& surface, const PredictedHighlight& highlight,
                                               double surfaceSize, std::size_t mostPoints = 0);

/// Training views of what was observed in a frame, whether it trains or not, on a surface that is not null; only those seen.
/// @param walked  with their canonical contours where the light is known, which takes some milliseconds each
std::vector<TrainingView> observedViews(const Inspection& inspection, int frame, const std::shared_ptr<const Surface>& surface,
                                        bool walked);
/// Index of a view's highlight in its frame's evidence; -1 if it is missing.
int highlightOf(const Inspection& inspection, const TrainingView& view);

}  // namespace glint::draw

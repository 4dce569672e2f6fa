// SPDX-License-Identifier: BSD-3-Clause
#include "viz/scene_view.h"

#include <vtkActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCellPicker.h>
#include <vtkLightKit.h>
#include <vtkMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "core/light/light.h"
#include "core/surface/mesh_policy.h"
#include "viz/annotations.h"
#include "viz/frame_overlay.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

constexpr unsigned kEverything = ~0u;

struct LayerState {
  LayerContent content;
  unsigned stale = kEverything;  ///< changes since the last build
  bool visible = true;
  bool built = false;
  int builds = 0;
};

std::size_t layerIndex(const std::string& name) {
  const std::vector<Layer>& layers = sceneLayers();
  const auto found = std::find_if(layers.begin(), layers.end(), [&](const Layer& layer) { return layer.name == name; });
  require(found != layers.end(), "SceneView: no layer named \"" + name + "\"");
  return static_cast<std::size_t>(found - layers.begin());
}

}  // namespace

void prepareWindow(vtkRenderWindow* window) {
  window->SetAlphaBitPlanes(1);
  window->SetMultiSamples(0);
}

struct SceneView::Impl {
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkLightKit> lights;
  vtkNew<vtkCallbackCommand> onStart;
  std::unique_ptr<Annotations> annotations;
  std::shared_ptr<const Inspection> inspection;
  Selection selection;
  std::set<std::string> models;
  std::vector<LayerState> layers{sceneLayers().size()};
  LayerCache cache;
  LayerInput input;
  double glyphScale = 1, lineScale = 1;
  bool dark = true;
  bool annotationsStale = true;
  bool frameAllPending = false;

  Impl() {
    renderer->SetUseDepthPeeling(1);
    renderer->SetMaximumNumberOfPeels(8);
    renderer->SetOcclusionRatio(0);
    renderer->SetUseFXAA(true);
    renderer->SetAutomaticLightCreation(0);
    lights->SetKeyLightIntensity(0.85);
    lights->AddLightsToRenderer(renderer);
    annotations = std::make_unique<Annotations>(renderer);
    for (std::size_t i = 0; i < layers.size(); ++i) layers[i].visible = sceneLayers()[i].onByDefault;
    onStart->SetClientData(this);
    onStart->SetCallback([](vtkObject*, unsigned long, void* self, void*) { static_cast<Impl*>(self)->beforeFrame(); });
    renderer->AddObserver(vtkCommand::StartEvent, onStart);
    applyBackground();
  }
  ~Impl() { renderer->RemoveObserver(onStart); }

  bool valid() const { return inspection && inspection->scene && !inspection->scene->frames.empty(); }

  void mark(unsigned change) {
    for (LayerState& layer : layers) layer.stale |= change;
    annotationsStale = true;
  }
  void applyBackground() {
    const Colour& c = dark ? kDarkBackground : kLightBackground;
    renderer->SetBackground(c[0], c[1], c[2]);
    annotations->setDark(dark);
  }
  /// Follows a change of inspection or frame: which surface is shown, and the sizes that come with it.
  void refreshInput() {
    if (!valid()) return;
    selection.frame = std::clamp(selection.frame, 0, static_cast<int>(inspection->scene->frames.size()) - 1);
    const std::shared_ptr<const Surface> before = input.surface;
    const std::vector<int> framesBefore = input.frames;
    input.inspection = inspection.get();
    input.selection = selection;
    input.models = modelsInOrder(*inspection, models);
    input.dark = dark;
    input.cache = &cache;
    input.glyphScale = glyphScale;
    input.surface.reset();
    input.surfaceKey.clear();
    input.surfaceProblem.clear();
    try {
      if (inspection->surfaces) {
        input.surfaceKey = inspection->surfaces->keyOf(selection.frame);
        const Outcome<std::shared_ptr<const Surface>> surface =
            // With the pipeline's policy, so that no second copy of a mesh is loaded for display.
            inspection->surfaces->surfaceOf(selection.frame, meshPolicy(inspection->request.settings));
        if (surface) {
          input.surface = *surface;
        } else {
          input.surfaceProblem = surface.failure().message();
        }
      }
    } catch (const InputError& error) {
      input.surfaceProblem = error.what();
    }
    input.frames = framesToDraw(*inspection, input.surfaceKey, selection.frame);
    input.scale = sceneScale(*inspection, input.surface.get(), input.frames, glyphScale);
    if (input.surface != before || (!input.surface && input.frames != framesBefore)) mark(kOnSurface);
  }
  void place(Drawn& drawn, bool visible) const {
    drawn.prop->SetVisibility(visible);
    if (drawn.lineWidthPx <= 0) return;
    if (auto* actor = vtkActor::SafeDownCast(drawn.prop))
      actor->GetProperty()->SetLineWidth(static_cast<float>(lineScale * drawn.lineWidthPx));
  }
  void clear(LayerState& layer) {
    for (const Drawn& drawn : layer.content.drawn) renderer->RemoveViewProp(drawn.prop);
    layer.content = {};
    layer.built = false;
  }
  void update() {
    for (std::size_t i = 0; i < layers.size(); ++i) {
      LayerState& layer = layers[i];
      const LayerRecipe& recipe = layerRecipes()[i];
      if (!valid()) {
        if (layer.built) clear(layer);
        continue;
      }
      const bool needed = layer.visible && (!layer.built || (layer.stale & recipe.dependencies));
      if (needed) {
        clear(layer);
        layer.content = recipe.build(input);
        layer.built = true;
        layer.stale = 0;
        ++layer.builds;
        for (Drawn& drawn : layer.content.drawn) {
          place(drawn, true);
          renderer->AddViewProp(drawn.prop);
        }
        annotationsStale = true;
      }
    }
    makeSurfaceTranslucent();
    if (annotationsStale) updateAnnotations();
  }
  /// Virtual cameras lie behind the surface, inside a convex one: it lets them shine through, unless it is so large that
  /// drawing it in several passes would be slow.
  void makeSurfaceTranslucent() {
    constexpr vtkIdType kMostTriangles = 200000;
    const LayerState& mirrored = layers[layerIndex("virtual-cameras")];
    const bool needed = mirrored.visible && !mirrored.content.drawn.empty();
    for (Drawn& drawn : layers[layerIndex("surface")].content.drawn) {
      auto* actor = vtkActor::SafeDownCast(drawn.prop);
      if (!actor || !actor->GetMapper()) continue;
      auto* data = vtkPolyData::SafeDownCast(actor->GetMapper()->GetInput());
      const bool small = data && data->GetNumberOfPolys() <= kMostTriangles;
      actor->GetProperty()->SetOpacity(needed && small ? 0.7 : 1.0);
    }
  }
  void updateAnnotations() {
    annotationsStale = false;
    std::vector<LegendEntry> legend;
    std::vector<std::string> notes, remarks;
    std::vector<DrawnLabel> labels;
    if (!valid()) {
      annotations->setLegend({}, {}, {}, "");
      annotations->setLabels({});
      return;
    }
    const auto shown = [&](const char* name) { return layers[layerIndex(name)].visible; };
    const auto drawn = [&](const char* name) { return shown(name) && !layers[layerIndex(name)].content.drawn.empty(); };
    if (drawn("cameras")) {
      legend.push_back({kTraining, "training camera"});
      legend.push_back({kHeldOut, "held-out camera"});
    }
    if (drawn("virtual-cameras") || drawn("tangent-planes")) legend.push_back({kVirtualCamera, "virtual camera, tangent plane"});
    if (drawn("observed-contours")) legend.push_back({kObserved, "observed contour"});
    if (drawn("light")) legend.push_back({kLightColour, "light, estimated"});
    if (drawn("true-light")) legend.push_back({kTruth, "light, truth"});
    if (shown("predicted-contours") || shown("ellipsoids")) {
      for (const std::string& model : input.models) {
        const FrameScore score = frameScore(inspection->models.at(model), selection.frame);
        char error[32] = "";
        if (score.errorPct) std::snprintf(error, sizeof error, "  %.2f %%", *score.errorPct);
        legend.push_back({modelColour(model), model + error, true});
        if (!score.errorPct && !score.reason.empty()) notes.push_back(model + ": " + score.reason);
      }
    }
    for (const LayerState& layer : layers) {
      if (!layer.visible) continue;
      notes.insert(notes.end(), layer.content.notes.begin(), layer.content.notes.end());
      remarks.insert(remarks.end(), layer.content.remarks.begin(), layer.content.remarks.end());
      labels.insert(labels.end(), layer.content.labels.begin(), layer.content.labels.end());
    }
    const Frame& frame = input.frame(selection.frame);
    const std::string use = inspection->isTraining(selection.frame)  ? "training"
                            : inspection->isHeldOut(selection.frame) ? "held out"
                                                                     : "excluded";
    annotations->setLegend(legend, notes, remarks, inspection->scene->name + ", frame " + frame.id + " (" + use + ")");
    annotations->setLabels(labels);
  }
  void beforeFrame() {
    const int* size = renderer->GetSize();
    const double wanted = std::clamp(size[1] / 900.0, 1.0, 4.0);
    const bool rescaled = wanted != lineScale;
    lineScale = wanted;
    update();
    if (rescaled) {
      for (LayerState& layer : layers) {
        for (Drawn& drawn : layer.content.drawn) place(drawn, layer.visible);
      }
    }
    if (frameAllPending && size[0] > 0) frameAll();
    renderer->ResetCameraClippingRange();
    annotations->place(valid() ? input.scale.surfaceBox.center() : Eigen::Vector3d::Zero().eval());
  }

  /// What "frame all" holds, as points.
  std::vector<Eigen::Vector3d> extent() {
    std::vector<Eigen::Vector3d> points;
    const Eigen::AlignedBox3d& box = input.scale.surfaceBox;
    for (int i = 0; i < 8; ++i) points.push_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
    if (layers[layerIndex("cameras")].visible || layers[layerIndex("photographs")].visible) {
      for (const int frame : input.frames) {
        points.push_back(input.frame(frame).camera.centreInWorld());
        for (const Eigen::Vector3d& corner : imagePlane(input.frame(frame).camera, input.scale.cameraDepth))
          points.push_back(corner);
      }
    }
    for (const LayerState& layer : layers) {
      if (!layer.visible) continue;
      for (const Eigen::Vector3d& p : layer.content.extent) {
        if ((p - input.scale.sceneBox.center()).norm() < 2.5 * input.scale.sceneSize) points.push_back(p);
      }
    }
    return points;
  }
  void frameAll() {
    frameAllPending = false;
    if (!valid()) return;
    update();
    Eigen::Vector3d up = Eigen::Vector3d::Zero(), eyes = Eigen::Vector3d::Zero();
    for (const int frame : input.frames) {
      up -= input.frame(frame).camera.camFromWorld.linear().row(1).transpose();
      eyes += input.frame(frame).camera.centreInWorld();
    }
    const double n = static_cast<double>(input.frames.size());
    up /= n;
    eyes /= n;
    if (up.norm() < 0.2) up = eyes - input.scale.surfaceBox.center();
    if (up.norm() < 1e-9 * input.scale.sceneSize) up = Eigen::Vector3d::UnitZ();
    // Scenes are modelled with an axis upwards more often than not: snap to it.
    Eigen::Index axis = 0;
    up.normalize();
    if (up.cwiseAbs().maxCoeff(&axis) > 0.8) up = Eigen::Vector3d::Unit(axis) * (up[axis] > 0 ? 1 : -1);
    // From above the highlights, a little aside of the cameras: then neither the surface nor the frustums hide what matters.
    Eigen::Vector3d normals = Eigen::Vector3d::Zero();
    for (const TrainingView& view : inspection->views) {
      if (view.brightest && view.tangentPlane) normals += facing(view.brightest->point, view.camera.centreInWorld()).normal;
    }
    const Eigen::Vector3d towardsCameras = eyes - input.scale.surfaceBox.center();
    Eigen::Vector3d towards = normals.norm() > 0.1 ? normals.normalized() : towardsCameras.normalized();
    const double height = up.dot(towards);
    Eigen::Vector3d flat = towards - height * up;
    if (flat.norm() < 0.1) {  // highlights on top: the cameras' side then, else any
      flat = towardsCameras - up.dot(towardsCameras) * up;
      if (flat.norm() < 0.05 * input.scale.sceneSize) flat = tangentBasis(up).col(0);
    }
    const double elevation = std::clamp(std::atan2(height, flat.norm()), 0.25, 0.6);
    const double side = up.dot(flat.cross(towardsCameras)) > 0 ? -1 : 1;  // away from the cameras
    flat = Eigen::AngleAxisd(0.6 * side, up) * flat.normalized();
    const Eigen::Vector3d back = std::cos(elevation) * flat + std::sin(elevation) * up;
    // The closest eye that still holds all points: bounds in the view's own axes, then distance along them.
    const Eigen::Vector3d right = up.cross(back).normalized(), top = back.cross(right);
    const int* size = renderer->GetSize();
    const double aspect = size[0] > 0 && size[1] > 0 ? static_cast<double>(size[0]) / size[1] : 4.0 / 3.0;
    constexpr double kFieldOfView = 30 * std::numbers::pi / 180;
    const double tanY = 0.92 * std::tan(kFieldOfView / 2), tanX = tanY * aspect;
    const double tanLeft = aspect > 1.2 ? 0.62 * tanX : tanX;  // the legend stands at the left
    // Each side of the view pyramid is a plane through the eye; the eye is fixed by the four that touch the points.
    double rightMost = -1e300, leftMost = -1e300, topMost = -1e300, bottomMost = -1e300;
    for (const Eigen::Vector3d& p : extent()) {
      const double x = right.dot(p), y = top.dot(p), z = back.dot(p);
      rightMost = std::max(rightMost, x / tanX + z);
      leftMost = std::max(leftMost, -x / tanLeft + z);
      topMost = std::max(topMost, y / tanY + z);
      bottomMost = std::max(bottomMost, -y / tanY + z);
    }
    const double ex = (rightMost - leftMost) / (1 / tanX + 1 / tanLeft), ey = tanY * (topMost - bottomMost) / 2;
    const double ez = std::max(rightMost - ex / tanX, (topMost + bottomMost) / 2);
    const Eigen::Vector3d eye = ex * right + ey * top + ez * back;
    const double depth = std::max(back.dot(eye - input.scale.surfaceBox.center()), 0.1 * input.scale.surfaceSize);
    setViewPoint({eye, eye - depth * back, top, 30});
  }
  void setViewPoint(const ViewPoint& view) {
    vtkCamera* camera = renderer->GetActiveCamera();
    camera->SetParallelProjection(0);
    camera->SetPosition(view.position.x(), view.position.y(), view.position.z());
    camera->SetFocalPoint(view.focalPoint.x(), view.focalPoint.y(), view.focalPoint.z());
    camera->SetViewUp(view.up.x(), view.up.y(), view.up.z());
    camera->SetViewAngle(view.viewAngleDeg);
    camera->OrthogonalizeViewUp();
    renderer->ResetCameraClippingRange();
  }
  /// Numbers of a surface point, for the selected frame's camera.
  Picked surfaceInfo(const SurfacePoint& hit) const {
    const Camera& camera = input.frame(selection.frame).camera;
    const Eigen::Vector3d eye = camera.centreInWorld();
    const SurfacePoint p = facing(hit, eye);
    Picked info;
    info.layer = "surface";
    info.frame = selection.frame;
    info.position = p.position;
    info.text = line("frame", input.frame(selection.frame).id) + line("P", p.position, "m") + line("N", p.normal);
    if (const std::optional<Pixel> pixel = camera.project(p.position))
      info.text += line("pixel x", pixel->x(), "px") + line("pixel y", pixel->y(), "px");
    const Eigen::Vector3d toCamera = (eye - p.position).normalized();
    info.text += line("view angle", std::acos(std::clamp(p.normal.dot(toCamera), -1.0, 1.0)) * 180 / std::numbers::pi, "deg");
    for (const auto& [key, estimate] : inspection->lights) {
      const std::size_t at = key.find('@');
      if (at != std::string::npos && key.substr(at + 1) != input.surfaceKey) continue;
      const double alpha = incidentAngle(p.normal, estimate.light.directionFrom(p.position), toCamera);
      if (std::isfinite(alpha)) info.text += line("alpha (" + key.substr(0, at) + ")", alpha * 180 / std::numbers::pi, "deg");
    }
    const Outcome<Curvature> curvature = input.surface->curvatureAt(hit);
    if (curvature) info.text += line("k1", curvature->k1, "1/m") + line("k2", curvature->k2, "1/m");
    if (hit.element >= 0) info.text += line("triangle", std::to_string(hit.element));
    return info;
  }
};

SceneView::SceneView() : impl_(std::make_unique<Impl>()) {}
SceneView::~SceneView() = default;

vtkRenderer* SceneView::renderer() const { return impl_->renderer; }

void SceneView::setInspection(std::shared_ptr<const Inspection> inspection) {
  const bool newScene =
      !impl_->inspection || !inspection || inspection->given != impl_->inspection->given;  // not that of a what-if
  if (newScene) {
    impl_->cache.clear();
    impl_->input = {};
  }
  impl_->inspection = std::move(inspection);
  impl_->refreshInput();
  impl_->mark(newScene ? kEverything : kOnInspection);
  if (newScene) impl_->frameAllPending = true;  // the window's shape is known at the first frame
}

void SceneView::setSelection(const Selection& selection) {
  Selection wanted = selection;
  if (impl_->valid()) wanted.frame = std::clamp(wanted.frame, 0, static_cast<int>(impl_->inspection->scene->frames.size()) - 1);
  const bool frame = wanted.frame != impl_->selection.frame, highlight = wanted.highlight != impl_->selection.highlight;
  impl_->selection = wanted;
  if (!frame && !highlight) return;
  impl_->refreshInput();
  impl_->mark((frame ? kOnFrame : 0u) | (highlight ? kOnHighlight : 0u));
}

void SceneView::setLayerVisible(const std::string& name, bool visible) {
  LayerState& layer = impl_->layers[layerIndex(name)];
  if (layer.visible == visible) return;
  layer.visible = visible;
  for (Drawn& drawn : layer.content.drawn) impl_->place(drawn, visible);
  impl_->annotationsStale = true;
}

bool SceneView::layerVisible(const std::string& name) const { return impl_->layers[layerIndex(name)].visible; }

void SceneView::setDarkBackground(bool dark) {
  if (dark == impl_->dark) return;
  impl_->dark = dark;
  impl_->input.dark = dark;
  impl_->applyBackground();
  impl_->mark(kOnTheme);
}

void SceneView::setModels(const std::set<std::string>& models) {
  if (models == impl_->models) return;
  impl_->models = models;
  impl_->refreshInput();
  impl_->mark(kOnModels);
}

void SceneView::setGlyphScale(double scale) {
  require(scale > 0 && std::isfinite(scale), "SceneView: glyph scale must be positive");
  if (scale == impl_->glyphScale) return;
  impl_->glyphScale = scale;
  impl_->refreshInput();
  impl_->mark(kOnGlyphs);
}

void SceneView::frameAll() { impl_->frameAll(); }

void SceneView::lookThrough(int frame) {
  require(impl_->valid() && frame >= 0 && frame < static_cast<int>(impl_->inspection->scene->frames.size()),
          "SceneView: no such frame");
  impl_->frameAllPending = false;
  const Camera& camera = impl_->inspection->scene->frames[static_cast<std::size_t>(frame)].camera;
  const Eigen::Matrix3d axes = camera.camFromWorld.linear();
  const Eigen::Vector3d eye = camera.centreInWorld(), forward = axes.row(2).transpose(), down = axes.row(1).transpose();
  const double depth =
      std::max(std::abs(forward.dot(impl_->input.scale.surfaceBox.center() - eye)), 1e-3 * impl_->input.scale.sceneSize);
  const double angle = 2 * std::atan(0.5 * camera.height / camera.pixelFromRay(1, 1)) * 180 / std::numbers::pi;
  impl_->setViewPoint({eye, eye + depth * forward, -down, angle});
}

ViewPoint SceneView::viewPoint() const {
  vtkCamera* camera = impl_->renderer->GetActiveCamera();
  return {toEigen(camera->GetPosition()), toEigen(camera->GetFocalPoint()), toEigen(camera->GetViewUp()), camera->GetViewAngle()};
}

void SceneView::setViewPoint(const ViewPoint& viewPoint) {
  impl_->frameAllPending = false;
  impl_->setViewPoint(viewPoint);
}

void SceneView::update() { impl_->update(); }

int SceneView::buildCount(const std::string& layer) const { return impl_->layers[layerIndex(layer)].builds; }

std::optional<Picked> SceneView::pick(int xDisplay, int yDisplay) const {
  if (!impl_->valid() || !impl_->renderer->GetRenderWindow()) return {};
  const auto worldAt = [&](double depth) {
    impl_->renderer->SetDisplayPoint(xDisplay, yDisplay, depth);
    impl_->renderer->DisplayToWorld();
    double w[4];
    impl_->renderer->GetWorldPoint(w);
    return Eigen::Vector3d(toEigen(w) / w[3]);
  };
  const Eigen::Vector3d eye = toEigen(impl_->renderer->GetActiveCamera()->GetPosition()), beyond = worldAt(1);
  const Ray ray{eye, (beyond - eye).normalized()};
  if (!ray.direction.allFinite()) return {};

  std::optional<Picked> result;
  double nearest = std::numeric_limits<double>::infinity();
  if (impl_->layers[layerIndex("surface")].visible && impl_->input.surface) {
    const Outcome<SurfacePoint> hit = impl_->input.surface->firstHit(ray);
    if (hit) {
      result = impl_->surfaceInfo(*hit);
      nearest = (hit->position - eye).norm();
    }
  }
  vtkNew<vtkCellPicker> picker;
  picker->SetTolerance(0.004);
  picker->PickFromListOn();
  for (const LayerState& layer : impl_->layers) {
    if (!layer.visible) continue;
    for (const Drawn& drawn : layer.content.drawn) {
      if (drawn.pickable) picker->AddPickList(drawn.prop);
    }
  }
  if (!picker->Pick(xDisplay, yDisplay, 0, impl_->renderer)) return result;
  const Eigen::Vector3d at = toEigen(picker->GetPickPosition());
  // What lies on the surface is picked before the surface itself.
  if ((at - eye).norm() > nearest + 10 * impl_->input.scale.lift) return result;
  for (const LayerState& layer : impl_->layers) {
    for (const Drawn& drawn : layer.content.drawn) {
      if (drawn.prop.Get() != picker->GetProp3D()) continue;
      result = drawn.info;
      result->position = at;
      return result;
    }
  }
  return result;
}

}  // namespace glint::viz

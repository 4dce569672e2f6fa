// SPDX-License-Identifier: BSD-3-Clause
#include "viz/scene_view.h"

#include <GL/gl.h>
#include <vtkActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkImageData.h>
#include <vtkLightKit.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/draw/frame_overlay.h"
#include "core/geometry/light.h"
#include "core/surface/mesh_policy.h"
#include "viz/annotations.h"
#include "viz/layer_state.h"
#include "viz/layers.h"
#include "viz/lit_parts.h"
#include "viz/photograph_stand.h"
#include "viz/scene_legend.h"
#include "viz/scene_questions.h"
#include "viz/style.h"
#include "viz/view_camera.h"

namespace glint::viz {
namespace {

constexpr unsigned kEverything = ~0u;

}  // namespace

struct SceneView::Impl {
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkLightKit> lights;
  vtkNew<vtkCallbackCommand> onFrame;
  std::unique_ptr<PhotographStand> photograph;  // below the annotations
  std::unique_ptr<Annotations> annotations;
  std::shared_ptr<const Inspection> inspection, shown;  // shown: in the scene's coordinates of the selected frame
  Selection selection;
  std::set<std::string> models;
  std::vector<LayerState> layers{sceneLayers().size()};
  std::shared_ptr<LayerCache> cache;
  std::shared_ptr<const std::vector<LampAnswer>> lamps;
  std::shared_ptr<const std::vector<DrawnRuns>> runs;
  LayerInput input;
  std::vector<int> allFrames;  // input.frames, solo or not
  CameraColours colours;
  bool solo = false;
  HiddenObjects hidden;
  // Through a camera
  Eye eye = Eye::Outside;
  std::string eyeProblem;  // why it is not in effect
  ViewPoint outside;       // what the view goes back to
  bool moving = false, border = false, active = false;
  std::string name;
  double glyphScale = 1, lineScale = 1;
  bool dark = true;
  bool annotationsStale = true;
  bool frameAllPending = false;

  explicit Impl(std::shared_ptr<LayerCache> shared) : cache(shared ? std::move(shared) : std::make_shared<LayerCache>()) {
    renderer->SetUseDepthPeeling(1);
    renderer->SetMaximumNumberOfPeels(8);
    renderer->SetOcclusionRatio(0);
    renderer->SetUseFXAA(true);
    renderer->SetAutomaticLightCreation(0);
    lights->SetKeyLightIntensity(0.85);
    lights->AddLightsToRenderer(renderer);
    photograph = std::make_unique<PhotographStand>(renderer);
    annotations = std::make_unique<Annotations>(renderer);
    for (std::size_t i = 0; i < layers.size(); ++i) layers[i].visible = sceneLayers()[i].onByDefault;
    onFrame->SetClientData(this);
    onFrame->SetCallback([](vtkObject*, unsigned long event, void* self, void*) {
      if (event == vtkCommand::StartEvent)
        static_cast<Impl*>(self)->beforeFrame();
      else
        static_cast<Impl*>(self)->afterFrame();
    });
    renderer->AddObserver(vtkCommand::StartEvent, onFrame);
    renderer->AddObserver(vtkCommand::EndEvent, onFrame);
    applyBackground();
  }
  ~Impl() { renderer->RemoveObserver(onFrame); }

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
    const std::vector<int> framesBefore = allFrames;
    input.inspection = (shown = inSceneAt(inspection, selection.frame)).get();
    input.selection = selection;
    input.models = modelsInOrder(*inspection, models);
    input.dark = dark;
    input.solo = solo;
    input.hidden = hidden;
    input.colours = colours;
    input.cache = cache.get();
    input.lamps = lamps;
    input.runs = runs;
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
    // Sizes come from all frames, so that hiding some changes none of them.
    allFrames = framesToDraw(*inspection, input.surfaceKey, selection.frame);
    input.scale = sceneScale(*inspection, input.surface.get(), allFrames, glyphScale);
    input.frames =
        hidden.frames.empty() ? allFrames : framesToDraw(*inspection, input.surfaceKey, selection.frame, hidden.frames);
    if (solo) input.frames = input.shows(selection.frame) ? std::vector<int>{selection.frame} : std::vector<int>{};
    if (input.surface != before || (!input.surface && allFrames != framesBefore)) mark(kOnSurface);
    refreshEye();
  }
  /// Whether the wanted eye can be had, and the mirror that it looks through.
  void refreshEye() {
    const Eye before = input.eye;
    const std::optional<Plane> mirrorBefore = input.eyeMirror;
    input.eye = eye;
    input.eyeMirror.reset();
    eyeProblem.clear();
    if (eye == Eye::VirtualCamera) {
      for (const LayerInput::Mirror& mirror : input.mirrors(selection.frame)) {
        const bool wanted = selection.highlight == mirror.highlight;
        if (!input.eyeMirror || wanted) input.eyeMirror = mirror.plane;
        if (wanted) break;
      }
      if (!input.eyeMirror) {
        input.eye = Eye::Outside;
        eyeProblem = "camera " + input.frame(selection.frame).id + " has no virtual camera: no highlight on the surface";
      }
    }
    if (before == Eye::Outside && input.eye != Eye::Outside) outside = viewPointOf(renderer->GetActiveCamera());
    if (before != Eye::Outside && input.eye == Eye::Outside) glint::viz::setViewPoint(renderer->GetActiveCamera(), outside);
    const bool sameMirror =
        mirrorBefore.has_value() == input.eyeMirror.has_value() &&
        (!mirrorBefore || (mirrorBefore->normal == input.eyeMirror->normal && mirrorBefore->offset == input.eyeMirror->offset));
    if (before != input.eye || !sameMirror) mark(kOnEye);
  }
  std::string eyeText() const {
    if (!valid() || eye == Eye::Outside) return {};
    if (!eyeProblem.empty()) return eyeProblem;
    const std::string& id = input.frame(selection.frame).id;
    return eye == Eye::Camera ? "through camera " + id : "through virtual camera " + id + " (mirrored)";
  }
  /// Camera and photograph for the size of this frame.
  void stand() {
    photograph->keepArea();
    vtkCamera* camera = renderer->GetActiveCamera();
    if (!valid() || input.eye == Eye::Outside) {
      standFree(camera, photograph->area());
      photograph->hide();
      return;
    }
    const Camera& real = input.frame(selection.frame).camera;
    const double depth = std::max(std::abs(real.depth(input.scale.surfaceBox.center())), 1e-3 * input.scale.sceneSize);
    standAt(camera, real, input.eyeMirror, photograph->placement(real), photograph->area(), depth);
    photograph->show(selection.frame, real);
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
    bool reorder = false;  // a layer was built anew: those after it are drawn after it, whichever came first
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
          nameLayer(drawn.prop, recipe.layer.name);
          renderer->AddViewProp(drawn.prop);
        }
        annotationsStale = true;
        reorder = true;
      } else if (reorder) {
        layer.content.drawLast(*renderer);
      }
    }
    styleSurface();
    if (annotationsStale) updateAnnotations();
  }
  void styleSurface() {
    const LayerState &mirrored = layers[layerIndex("virtual-cameras")], &ellipsoids = layers[layerIndex("ellipsoids")];
    Behind behind = mirrored.visible && !mirrored.content.drawn.empty() ? Behind::VirtualCameras : Behind::Nothing;
    if (ellipsoids.visible && ellipsoids.content.behindSurface) behind = Behind::Ellipsoids;
    glint::viz::styleSurface(layers[layerIndex("surface")].content, input, behind, moving);
  }
  bool surfaceShown() const { return layers[layerIndex("surface")].visible && !input.hidden.hidesSurface(input.surfaceKey); }
  /// What lies under a pixel among the visible layers first..last.
  std::optional<Picked> pickAmong(std::size_t first, std::size_t last, int xDisplay, int yDisplay) {
    if (!valid() || !renderer->GetRenderWindow()) return {};
    update();
    std::vector<const Drawn*> drawn;
    for (std::size_t i = first; i < last; ++i)
      if (layers[i].visible)
        for (const Drawn& d : layers[i].content.drawn) drawn.push_back(&d);
    return drawn.empty() ? std::nullopt : pickIn(renderer, input, drawn, surfaceShown(), xDisplay, yDisplay);
  }
  void updateAnnotations() {
    annotationsStale = false;
    annotations->setBadge(eyeText());
    annotations->setOnPicture(valid() && input.eye != Eye::Outside);
    annotations->setBorder(!border                      ? Border::None
                           : photograph->partOfWindow() ? Border::Wipe
                           : active                     ? Border::Active
                                                        : Border::Around,
                           name);
    if (!valid()) {
      annotations->setLegend({}, {}, {}, "");
      annotations->setLabels({});
      annotations->setColourBar({});
      return;
    }
    std::vector<ShownLayer> shown;
    std::vector<DrawnLabel> labels;
    std::vector<Points> glyphs;
    for (const LayerState& layer : layers) {
      shown.push_back({layer.visible, &layer.content});
      if (!layer.visible) continue;
      labels.insert(labels.end(), layer.content.labels.begin(), layer.content.labels.end());
      glyphs.insert(glyphs.end(), layer.content.glyphs.begin(), layer.content.glyphs.end());
    }
    const SceneLegend legend = legendOf(input, shown);
    annotations->setLegend(legend.entries, legend.notes, legend.remarks, legend.title);
    annotations->setLabels(labels);
    annotations->setGlyphs(std::move(glyphs));
    annotations->setColourBar(legend.bar);
  }
  void beforeFrame() {
    const int* size = renderer->GetSize();
    const double wanted = std::clamp(size[1] / 900.0, 1.0, 4.0);
    const bool rescaled = wanted != lineScale;
    lineScale = wanted;
    update();
    if (rescaled)
      for (LayerState& layer : layers)
        for (Drawn& drawn : layer.content.drawn) place(drawn, layer.visible);
    if (frameAllPending && size[0] > 0) frameAll();
    stand();
    for (const LayerState& layer : layers)
      if (layer.visible) layer.content.bringNearer(renderer->GetActiveCamera(), size[1]);
    renderer->ResetCameraClippingRange();
    // A mirrored picture turns front faces into back faces, and VTK lights the two sides differently.
    if (input.eyeMirror) glFrontFace(GL_CW);
    annotations->place(valid() ? input.scale.surfaceBox.center() : Eigen::Vector3d::Zero().eval());
  }
  void afterFrame() {
    if (input.eyeMirror) glFrontFace(GL_CCW);
  }

  /// What "frame all" holds, as points.
  std::vector<Eigen::Vector3d> extent() const {
    std::vector<Eigen::Vector3d> points;
    const Eigen::AlignedBox3d& box = input.scale.surfaceBox;
    for (int i = 0; i < 8; ++i) points.push_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
    if (layers[layerIndex("cameras")].visible || layers[layerIndex("photographs")].visible) {
      for (const int frame : input.frames) addFrustum(input, points, frame);
    }
    for (const LayerState& layer : layers) {
      if (!layer.visible) continue;
      for (const Eigen::Vector3d& p : layer.content.extent) {
        if ((p - input.scale.sceneBox.center()).norm() < 2.5 * input.scale.sceneSize) points.push_back(p);
      }
    }
    return points;
  }
  /// The closest view in that direction that holds the points and keeps them off the legend.
  void fit(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& back, const Eigen::Vector3d& up,
           const Eigen::Vector3d& reference, double leastDepth) {
    update();
    const PictureArea whole = photograph->area();
    const Margins margins = marginsBeside(annotations->legendSize(), annotations->colourBarHeight(), whole);
    const double aspect = whole.width > 1 && whole.height > 1 ? static_cast<double>(whole.width) / whole.height : 4.0 / 3.0;
    place(fitted(points, back, up, aspect, margins, parallel(), reference, leastDepth));
  }
  bool parallel() const {
    return input.eye != Eye::Outside ? outside.parallel : renderer->GetActiveCamera()->GetParallelProjection() != 0;
  }
  /// The view from outside; the eye at a camera keeps it for later.
  void place(const ViewPoint& view) {
    if (valid() && input.eye != Eye::Outside) {
      outside = view;
      return;
    }
    glint::viz::setViewPoint(renderer->GetActiveCamera(), view);
    renderer->ResetCameraClippingRange();
  }
  void frameAll() {
    frameAllPending = false;
    if (!valid()) return;
    update();
    const Eigen::Vector3d up = upwards(input, allFrames), back = overviewDirection(input, allFrames, up);
    const Eigen::Vector3d upInPicture = back.cross(up.cross(back).normalized());
    frame(Framing{extent(), back, upInPicture, input.scale.surfaceBox.center(), 0.1 * input.scale.surfaceSize});
  }
  void frameSelection() {
    if (!valid()) return;
    const std::vector<Eigen::Vector3d> points = selectedExtent(input);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : points) box.extend(p);
    const ViewPoint now = input.eye != Eye::Outside ? outside : viewPointOf(renderer->GetActiveCamera());
    const Eigen::Vector3d back = (now.position - now.focalPoint).normalized();
    const Eigen::Vector3d up = (now.up - now.up.dot(back) * back).normalized();
    frame(Framing{points, back, up, box.center(), std::max(0.5 * box.diagonal().norm(), 1e-3 * input.scale.sceneSize)});
  }
  bool frame(const std::optional<Framing>& f) {
    if (!f) return false;
    frameAllPending = false;
    fit(f->points, f->back, f->up, f->reference, f->leastDepth);
    return true;
  }
  void lookAlong(AxisView view) {
    if (!valid()) return;
    update();
    const AxisDirections axis = axisDirections(view, upwards(input, allFrames));
    frame(Framing{extent(), axis.back, axis.up, input.scale.surfaceBox.center(), 0.1 * input.scale.surfaceSize});
  }
};

SceneView::SceneView(std::shared_ptr<LayerCache> cache) : impl_(std::make_unique<Impl>(std::move(cache))) {}
SceneView::~SceneView() = default;
vtkRenderer* SceneView::renderer() const { return impl_->renderer; }

void SceneView::setInspection(std::shared_ptr<const Inspection> inspection) {
  const bool newScene =
      !impl_->inspection || !inspection || inspection->given != impl_->inspection->given;  // not that of a what-if
  if (newScene) {
    impl_->cache->follow(inspection ? inspection->given : nullptr);
    if (impl_->input.eye != Eye::Outside) viz::setViewPoint(impl_->renderer->GetActiveCamera(), impl_->outside);
    impl_->input = {};
    impl_->photograph->setPhotograph(-1, nullptr);
  }
  const bool moved = newScene || inspection->scene != impl_->inspection->scene;
  const bool otherCoordinates = newScene || inspection->lightFrame.frame != impl_->inspection->lightFrame.frame;
  impl_->inspection = std::move(inspection);
  impl_->refreshInput();
  impl_->mark(newScene ? kEverything : kOnInspection | (moved ? kOnScene : 0u));
  if (otherCoordinates) impl_->frameAllPending = true;  // the window's shape is known at the first frame
}

void SceneView::setSelection(const Selection& selection) {
  Selection wanted = selection;
  if (impl_->valid()) wanted.frame = std::clamp(wanted.frame, 0, static_cast<int>(impl_->inspection->scene->frames.size()) - 1);
  const Selection& now = impl_->selection;
  const bool frame = wanted.frame != now.frame,
             highlight = wanted.highlight != now.highlight || wanted.predicted != now.predicted;
  const bool picked = wanted.model != now.model || wanted.light != now.light || wanted.direction != now.direction;
  impl_->selection = wanted;
  if (!frame && !highlight && !picked) return;
  impl_->refreshInput();
  const bool lightsMove = impl_->valid() && !impl_->inspection->lightFrame.elsewhere.empty();
  impl_->mark((frame ? kOnFrame | (lightsMove ? kOnInspection : 0u) : 0u) | (highlight ? kOnHighlight : 0u) |
              (picked ? kOnPicked : 0u));
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

void SceneView::setSolo(bool solo) {
  if (solo == impl_->solo) return;
  impl_->solo = solo;
  impl_->refreshInput();
  impl_->mark(kOnSolo);
}

void SceneView::setHidden(const HiddenObjects& hidden) {
  if (hidden == impl_->hidden) return;
  impl_->hidden = hidden;
  impl_->refreshInput();
  impl_->mark(kOnHidden);
}

void SceneView::setCameraColours(const CameraColours& colours) {
  if (colours == impl_->colours) return;
  impl_->colours = colours;
  impl_->refreshInput();
  impl_->mark(kOnColours);
}

void SceneView::setWalk(std::shared_ptr<const WalkStory> walk, int step) {
  impl_->input.walk = std::move(walk);
  impl_->input.walkStep = step;
  impl_->mark(kOnWalk);
}

void SceneView::setLamps(std::shared_ptr<const std::vector<LampAnswer>> lamps) {
  if (lamps == impl_->lamps) return;
  impl_->lamps = std::move(lamps);
  impl_->refreshInput();
  impl_->mark(kOnLamps);
}

void SceneView::setRuns(std::shared_ptr<const std::vector<DrawnRuns>> runs) {
  if (runs == impl_->runs) return;
  impl_->runs = std::move(runs);
  impl_->refreshInput();
  impl_->mark(kOnRuns);
}

void SceneView::frameAll() { impl_->frameAll(); }
void SceneView::frameSelection() { impl_->frameSelection(); }
bool SceneView::frameHighlight(int highlight, HighlightLook look) {
  return impl_->valid() && impl_->frame(highlightFraming(impl_->input, highlight, look, drawnParts(*this)));
}
void SceneView::frameEllipsoids(const std::string& model) {
  if (!impl_->valid() || !impl_->frame(ellipsoidFraming(impl_->input, impl_->allFrames, model))) impl_->frameAll();
}
void SceneView::lookAlong(AxisView view) { impl_->lookAlong(view); }

void SceneView::setParallel(bool parallel) {
  if (parallel == impl_->parallel()) return;
  ViewPoint view = viewPoint();
  view.parallel = parallel;
  impl_->place(view);
}

bool SceneView::parallel() const { return impl_->parallel(); }

void SceneView::setEye(Eye eye) {
  if (eye == impl_->eye) return;
  if (impl_->frameAllPending && impl_->valid()) impl_->frameAll();  // the view to come back to
  impl_->eye = eye;
  impl_->photograph->resetZoom();
  if (impl_->valid()) impl_->refreshEye();
  impl_->annotationsStale = true;
}

Eye SceneView::eye() const { return impl_->eye; }
bool SceneView::looksThrough() const { return impl_->valid() && impl_->input.eye != Eye::Outside; }
std::string SceneView::eyeText() const { return impl_->eyeText(); }

void SceneView::setPhotograph(int frame, vtkSmartPointer<vtkImageData> photograph) {
  impl_->photograph->setPhotograph(frame, std::move(photograph));
}

void SceneView::setPhotographOpacity(double opacity) { impl_->photograph->setOpacity(opacity); }

void SceneView::zoomPhotograph(double factor, double x, double y) {
  if (looksThrough()) impl_->photograph->zoom(factor, {x, y});
}

void SceneView::movePhotograph(double dx, double dy) {
  if (looksThrough()) impl_->photograph->move({dx, dy});
}

std::optional<Eigen::Vector2d> SceneView::displayOf(double idealX, double idealY) const {
  if (!looksThrough()) return {};
  return impl_->photograph->displayOf(impl_->input.frame(impl_->selection.frame).camera, {idealX, idealY});
}

void SceneView::setPartOfWindow(bool part) {
  impl_->photograph->setPartOfWindow(part);
  impl_->annotationsStale = true;
}

void SceneView::setFrame(bool border, bool active, const std::string& name) {
  impl_->border = border;
  impl_->active = active;
  impl_->name = name;
  impl_->annotationsStale = true;
}

void SceneView::setLegendVisible(bool visible, bool title) { impl_->annotations->setLegendVisible(visible, title); }

void SceneView::setTextScale(double scale) { impl_->annotations->setTextScale(scale); }
void SceneView::setMoving(bool moving) {
  impl_->moving = moving;
  impl_->renderer->SetUseDepthPeeling(!moving);  // many passes; without them what shines through is only not sorted
}

bool SceneView::hasCoarseSurface() const {
  return impl_->valid() && impl_->input.surface && impl_->layers[layerIndex("surface")].built &&
         impl_->cache->tessellation(impl_->input.surface, impl_->input.scale.surfaceBox).coarseIfReady() != nullptr;
}

void SceneView::photographsArrived() { impl_->mark(kOnPhotographs); }
ViewPoint SceneView::viewPoint() const {
  return impl_->input.eye != Eye::Outside ? impl_->outside : viewPointOf(impl_->renderer->GetActiveCamera());
}

void SceneView::setViewPoint(const ViewPoint& viewPoint) {
  impl_->frameAllPending = false;
  impl_->place(viewPoint);
}

void SceneView::update() { impl_->update(); }
int SceneView::buildCount(const std::string& layer) const { return impl_->layers[layerIndex(layer)].builds; }

std::optional<Picked> SceneView::pick(int xDisplay, int yDisplay) const {
  std::optional<Picked> picked = impl_->pickAmong(0, impl_->layers.size(), xDisplay, yDisplay);
  return picked ? picked : pickCamera(xDisplay, yDisplay);
}

std::optional<Picked> SceneView::pickLamp(int xDisplay, int yDisplay) const {
  const std::size_t lamps = layerIndex("true-light");
  std::optional<Picked> picked = impl_->pickAmong(lamps, lamps + 1, xDisplay, yDisplay);
  return picked && picked->layer == "true-light" ? picked : std::nullopt;
}

std::optional<Picked> SceneView::pickCamera(int xDisplay, int yDisplay) const {
  if (!impl_->valid() || !impl_->renderer->GetRenderWindow()) return {};
  impl_->update();
  // One that is looked through has its frustum around the eye.
  if (!impl_->layers[layerIndex("cameras")].visible || impl_->input.eye != Eye::Outside) return {};
  return cameraUnder(impl_->renderer, impl_->input, xDisplay, yDisplay);
}

}  // namespace glint::viz

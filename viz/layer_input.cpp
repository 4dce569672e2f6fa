// SPDX-License-Identifier: BSD-3-Clause
// What all layers share: sizes, the choice of frames, casting pixels onto the surface, caches.
#include <vtkMatrix4x4.h>
#include <vtkPropCollection.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/number_text.h"
#include "core/base/words.h"
#include "core/draw/on_surface.h"
#include "core/pipeline/photograph.h"
#include "core/pipeline/training.h"
#include "viz/glyphs.h"
#include "viz/layers.h"
#include "viz/view_camera.h"

namespace glint::viz {
namespace {

constexpr int kTessellation = 128;     ///< cells a side of an analytic surface
constexpr int kCoarseDivisions = 120;  ///< cells along the longest side: some 50,000 triangles

}  // namespace

bool LayerInput::onSurface(int frame) const {
  const auto& surfaces = inspection->surfaces;
  if (!surfaces) return true;
  const auto place = [&](int f) { return surfaces->placedKeyOf(f).substr(surfaces->keyOf(f).size()); };
  return surfaces->keyOf(frame) == surfaceKey && place(frame) == place(selection.frame);
}

std::vector<const TrainingView*> LayerInput::views() const {
  std::vector<const TrainingView*> result;
  for (const TrainingView& view : inspection->views) {
    if (view.seen && view.frame >= 0 && onSurface(view.frame) && shows(view.frame)) result.push_back(&view);
  }
  return result;
}

std::vector<TrainingView> LayerInput::ownViews(bool walked) const {
  const bool looked = static_cast<std::size_t>(selection.frame) < inspection->evidence.size();
  if (!surface || !looked || inspection->isTraining(selection.frame) || !shows(selection.frame)) return {};
  std::vector<TrainingView> own = observedViews(*inspection, selection.frame, surface, walked);
  if (walked) std::erase_if(own, [](const TrainingView& view) { return !view.canonical; });
  return own;
}

std::vector<const TrainingView*> LayerInput::viewsOf(const ModelFit& fit) const {
  std::vector<const TrainingView*> result;
  for (const TrainingView& view : inspection->views) {
    if (!view.seen || view.frame < 0 || view.highlight.light != fit.light) continue;
    if (!fit.frames.empty() && std::find(fit.frames.begin(), fit.frames.end(), view.frame) == fit.frames.end()) continue;
    if (fit.surface && inspection->surfaces && inspection->surfaces->keyOf(view.frame) != *fit.surface) continue;
    if (shows(view.frame)) result.push_back(&view);
  }
  return result;
}

std::vector<const ModelFit*> LayerInput::fits(const std::string& model) const {
  std::vector<const ModelFit*> result;
  const auto found = inspection->models.find(model);
  if (found == inspection->models.end()) return result;
  for (const ModelResult::Fit& fit : found->second.fits) {
    if (fit.fit && (!fit.surface || *fit.surface == surfaceKey) && !hidden.ellipsoids.count({model, fit.fit->light}))
      result.push_back(&*fit.fit);
  }
  return result;
}

std::vector<const FrameComparison*> LayerInput::comparisons(const std::string& model) const {
  std::vector<const FrameComparison*> result;
  const auto found = inspection->models.find(model);
  if (found == inspection->models.end() || !shows(selection.frame)) return result;
  for (const FrameComparison& comparison : found->second.frames) {
    if (comparison.frame == selection.frame && !hidden.ellipsoids.count({model, comparison.light})) result.push_back(&comparison);
  }
  return result;
}

std::vector<LayerInput::Mirror> LayerInput::mirrors(int frame) const {
  std::vector<Mirror> result;
  const auto add = [&](const TrainingView& view) {
    result.push_back({view.seen->tangentPlane, highlightOf(view), view.highlight.light});
  };
  for (const TrainingView* view : views())
    if (view->frame == frame) add(*view);
  if (!result.empty() || !surface || static_cast<std::size_t>(frame) >= inspection->evidence.size()) return result;
  // A held-out frame has no training view: its mirrors are the tangent planes at the observed peaks.
  for (const TrainingView& view : observedViews(*inspection, frame, surface, false)) add(view);
  return result;
}

std::vector<int> framesToDraw(const Inspection& inspection, const std::string& surfaceKey, int selected,
                              const std::set<int>& hidden) {
  const Scene& scene = *inspection.scene;
  const int n = static_cast<int>(scene.frames.size());
  const auto fitness = [&](int frame) {
    if (frame == selected) return 2;
    return inspection.surfaces && inspection.surfaces->keyOf(frame) == surfaceKey ? 1 : 0;
  };
  // Sequences of a moving object repeat their camera poses: equal centres and axes are one camera on screen.
  std::map<std::vector<double>, int> byPose;
  for (int i = 0; i < n; ++i) {
    if (hidden.count(i)) continue;
    const Eigen::Matrix<double, 3, 4> pose = scene.frames[static_cast<std::size_t>(i)].camera.camFromWorld.matrix().topRows<3>();
    const std::vector<double> key(pose.data(), pose.data() + pose.size());
    const auto [at, isNew] = byPose.emplace(key, i);
    if (!isNew && fitness(i) > fitness(at->second)) at->second = i;
  }
  std::vector<int> frames;
  for (const auto& [pose, frame] : byPose) frames.push_back(frame);
  std::sort(frames.begin(), frames.end());
  return frames;
}

std::vector<Points> castContour(const Camera& camera, const Surface& surface, const Polyline& contour, const SceneScale& scale,
                                double lift) {
  return draw::castContour(camera, surface, contour, scale.surfaceSize, lift);
}

double planeRadius(const Camera& camera, const Plane& plane, const Eigen::Vector3d& at, const std::vector<Pixel>& contour,
                   const SceneScale& scale, double times) {
  return draw::planeRadius(camera, plane, at, contour, scale.surfaceSize, times);
}

namespace {
/// What directions are measured from, photograph px.
Pixel middleOf(const Camera& camera, const Highlight& observed) {
  Polyline contour = observed.contour;
  for (Pixel& p : contour.points) p = camera.distorted(p);
  return contour.points.empty() ? camera.distorted(observed.peak) : centroid(contour);
}
double angleFrom(const Pixel& middle, const Pixel& measured) {
  const Pixel by = measured - middle;
  return std::atan2(by.y(), by.x());
}
}  // namespace

double directionOf(const Camera& camera, const Highlight& observed, const Pixel& ideal) {
  return angleFrom(middleOf(camera, observed), camera.distorted(ideal));
}

std::optional<Pixel> vertexInDirection(const Camera& camera, const Highlight& observed, const Polyline& contour,
                                       double direction) {
  const Pixel middle = middleOf(camera, observed);
  std::optional<Pixel> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Pixel& p : contour.points) {
    if (!p.allFinite()) continue;
    const double off = std::abs(std::remainder(angleFrom(middle, camera.distorted(p)) - direction, 2 * std::numbers::pi));
    if (!(off < least)) continue;
    least = off;
    best = p;
  }
  return best;
}

void LayerContent::bringNearer(vtkCamera* camera, int heightPx) const {
  constexpr int kAsHigh = 900;  // px: beyond, lines grow with the picture
  for (const Drawn& d : drawn)
    if (d.nearerPx > 0) d.prop->SetUserMatrix(toVtk(nearer(camera, d.nearerPx, std::clamp(heightPx, 1, kAsHigh)).matrix()));
}

void LayerContent::drawLast(vtkRenderer& renderer) const {
  vtkPropCollection* props = renderer.GetViewProps();
  for (const Drawn& d : drawn) {
    props->RemoveItem(d.prop);
    props->AddItem(d.prop);
  }
}

LayerCache::Photograph LayerCache::photograph(const Inspection& inspection, int frame, int maxWidth) {
  if (source_) return source_(frame, maxWidth);
  constexpr std::size_t kKept = 64;
  const std::pair<int, int> key(frame, maxWidth);
  if (std::string pictures = pictureKey(inspection); pictures != photographsKey_) {
    photographs_.clear();
    photographsKey_ = std::move(pictures);
  }
  for (const auto& [known, texture] : photographs_) {
    if (known == key) return {texture};
  }
  const Outcome<Image> image = photographOf(inspection, frame);
  if (photographs_.size() >= kKept) photographs_.erase(photographs_.begin());
  photographs_.emplace_back(key, image ? toTexture(*image, maxWidth) : vtkSmartPointer<vtkImageData>{});
  return {photographs_.back().second};
}

vtkSmartPointer<vtkTexture> LayerCache::textureOf(const vtkSmartPointer<vtkImageData>& picture) {
  constexpr std::size_t kTexturesKept = 64;
  const auto found = std::find_if(textures_.begin(), textures_.end(), [&](const auto& known) { return known.first == picture; });
  if (found != textures_.end()) {
    std::rotate(found, found + 1, textures_.end());
    return textures_.back().second;
  }
  vtkNew<vtkTexture> texture;
  texture->SetInputData(picture);
  texture->InterpolateOn();
  texture->MipmapOn();
  if (textures_.size() >= kTexturesKept) textures_.erase(textures_.begin());
  textures_.emplace_back(picture, texture);
  return textures_.back().second;
}

vtkSmartPointer<vtkPolyData> LayerCache::Triangles::coarseIfReady() const {
  if (!coarse.valid() || coarse.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return {};
  return coarse.get();
}

LayerCache::Triangles LayerCache::tessellation(const std::shared_ptr<const Surface>& surface, const Eigen::AlignedBox3d& region) {
  constexpr std::size_t kKept = 16;  // a sequence of a bending sheet steps through a few of them
  for (const auto& [known, data] : tessellations_) {
    if (known == surface) return data;
  }
  if (tessellations_.size() >= kKept) tessellations_.erase(tessellations_.begin());
  Triangles triangles;
  triangles.fine = withNormals(toPolyData(surface->tessellate(region, kTessellation)));
  if (triangles.fine->GetNumberOfPolys() > kLargeSurface) {
    vtkSmartPointer<vtkPolyData> copy = vtkSmartPointer<vtkPolyData>::New();
    copy->ShallowCopy(triangles.fine);
    copy->GetBounds();  // computed here: the thread only reads
    triangles.coarse = std::async(std::launch::async, [copy] { return coarsened(copy, kCoarseDivisions); }).share();
  }
  tessellations_.emplace_back(surface, triangles);
  return triangles;
}

void LayerCache::follow(const std::shared_ptr<const Scene>& scene) {
  if (scene == scene_) return;
  scene_ = scene;
  photographs_.clear();
  tessellations_.clear();
}

std::string line(const std::string& name, double value, const std::string& unit) {
  constexpr double kLeastAngle = 1e-6;  // degrees: below is round-off
  if (unit == "deg" && std::abs(value) < kLeastAngle) value = 0;
  return name + " = " + formatted("%.7g", value) + unitAfterNumber(unit) + "\n";
}

std::string line(const std::string& name, const Eigen::Vector3d& v, const std::string& unit) {
  return name + " = " + formatted("%.7g, %.7g, %.7g", v.x(), v.y(), v.z()) + (unit.empty() ? "" : " " + unit) + "\n";
}

std::string line(const std::string& name, const std::string& value) { return name + " = " + value + "\n"; }

}  // namespace glint::viz

// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/what_if.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/number_text.h"
#include "core/base/progress.h"
#include "core/geometry/polyline.h"
#include "core/surface/analytic.h"
#include "core/surface/posed_surface.h"
#include "core/synth/exact_highlight.h"

namespace glint {

namespace {
const char* const kPlace = "what-if";
constexpr double kEdgeShare =
    0.3;  // of the image: how far beyond its border synthetic contours are followed, so that few are cut
constexpr double kSagittaPx = 1e-2;    // a tenth of what overlays are drawn to; finer costs time while a slider moves
constexpr double kLeastSpread = 1e-9;  // of the squared sines between optical axes: below, they are parallel and meet nowhere

std::string exact(double v) { return formatted("%.17g,", v); }

std::string exact(const Eigen::Vector3d& v) { return exact(v.x()) + exact(v.y()) + exact(v.z()); }

[[noreturn]] void refuse(const Scene& scene, const std::string& reason) { throw InputError(scene.file.string(), kPlace, reason); }

Camera moved(Camera camera, const PoseChange& change) {
  // The camera's new axes and centre in its old frame.
  Eigen::Isometry3d oldFromNew = Eigen::Isometry3d::Identity();
  const double angle = change.rotation.norm();
  if (angle > 0) oldFromNew.linear() = Eigen::AngleAxisd(angle, change.rotation / angle).toRotationMatrix();
  oldFromNew.translation() = change.translation;
  camera.camFromWorld = oldFromNew.inverse() * camera.camFromWorld;
  return camera;
}

}  // namespace

namespace {
bool isOnAsCaptured(const Frame& frame, const std::string& light) {
  return frame.lightsOn.empty() || std::count(frame.lightsOn.begin(), frame.lightsOn.end(), light) > 0;
}
}  // namespace

bool isSwitchedOff(const WhatIf& w, int frame, const std::string& light) {
  const auto found = w.lightsSwitched.find({frame, light});
  return found != w.lightsSwitched.end() && !found->second;
}

bool isOn(const Scene& scene, const WhatIf& w, int frame, const std::string& light) {
  const auto found = w.lightsSwitched.find({frame, light});
  if (found != w.lightsSwitched.end() && (!found->second || w.synthesise)) return found->second;
  return isOnAsCaptured(scene.frames[std::size_t(frame)], light);
}

WhatIf withoutSwitchingOff(WhatIf w) {
  std::erase_if(w.lightsSwitched, [](const auto& entry) { return !entry.second; });
  return w;
}

WhatIf switched(WhatIf w, const Scene& scene, int frame, const std::string& light, bool on) {
  require(frame >= 0 && frame < int(scene.frames.size()), "switched: no such frame");
  if (on == isOnAsCaptured(scene.frames[std::size_t(frame)], light))
    w.lightsSwitched.erase({frame, light});
  else
    w.lightsSwitched[{frame, light}] = on;
  return w;
}

std::vector<TrueLight> lightsOn(const Scene& scene, const WhatIf& w, int frame) {
  std::vector<TrueLight> on;
  for (const TrueLight& light : scene.lights)
    if (isOn(scene, w, frame, light.id)) on.push_back(inWorld(light, scene.frames[std::size_t(frame)]));
  return on;
}

std::optional<ShapeParameter> shapeOf(const AnalyticSpec& s) {
  const auto factor = [](const char* name, double value) { return ShapeParameter{name, "m", value, 0.2 * value, 5 * value}; };
  if (s.type == "sheet") {
    const double most = std::max(2.0, 4 * std::abs(s.curvature));
    return ShapeParameter{"curvature", "1/m", s.curvature, -most, most};
  }
  if (s.type == "sphere" || s.type == "cylinder") return factor("radius", s.radius);
  if (s.type == "ellipsoid") return factor("longest semi-axis", s.semiAxes.maxCoeff());
  if (s.type == "torus") return ShapeParameter{"minor radius", "m", s.minorRadius, 0.2 * s.minorRadius, s.majorRadius};
  return std::nullopt;
}

AnalyticSpec withShape(AnalyticSpec s, double value) {
  if (s.type == "sheet")
    s.curvature = value;
  else if (s.type == "sphere" || s.type == "cylinder")
    s.radius = value;
  else if (s.type == "torus")
    s.minorRadius = value;
  else if (s.type == "ellipsoid") {
    Eigen::Index longest = 0;
    s.semiAxes.maxCoeff(&longest);
    s.semiAxes(longest) = value;
  }
  return s;
}

std::optional<Failure> whyNotSynthesised(const Scene& scene) {
  if (scene.lights.empty()) return Failure{Reason::NotSupported, "the scene does not say where its lights are"};
  for (const Frame& f : scene.frames)
    if (!scene.formulaOf(f.surface)) return Failure{Reason::NotSupported, "frame " + f.id + " sees no analytic surface"};
  return std::nullopt;
}

double workingDistance(const Scene& scene) {
  // Point nearest to all optical axes: sum of (I - d d^T) x = sum of (I - d d^T) c.
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero(), mean = Eigen::Vector3d::Zero();
  for (const Frame& f : scene.frames) {
    const Eigen::Vector3d axis = f.camera.camFromWorld.linear().row(2).transpose(), centre = f.camera.centreInWorld();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
    a += across;
    b += across * centre;
    mean += centre;
  }
  const double n = double(scene.frames.size());
  if (n == 0) return 1;
  const Eigen::FullPivLU<Eigen::Matrix3d> solver(a / n);
  if (std::abs(solver.determinant()) < kLeastSpread) return 1;
  const Eigen::Vector3d target = solver.solve(b / n);
  double sum = 0;
  for (const Frame& f : scene.frames) sum += (f.camera.centreInWorld() - target).norm();
  return sum > 0 && std::isfinite(sum) ? sum / n : 1;
}

namespace {
using AnalyticSurfaces = std::map<std::string, std::shared_ptr<const Surface>>;

/// The contours of these frames, in their `highlights`.
void synthesise(Scene& scene, const AnalyticSurfaces& surfaces, const WhatIf& whatIf, double level,
                const std::vector<int>& frames, const ProgressFn& progress) {
  Material material;
  material.lobe = whatIf.lobe;
  material.roughness = whatIf.roughness;
  // What is switched off is synthesised too and dropped with the evidence: switching makes no contour again.
  const WhatIf lit = withoutSwitchingOff(whatIf);
  parallelFor(
      int(frames.size()),
      [&](int n) {
        const int index = frames[std::size_t(n)];
        Frame& f = scene.frames[std::size_t(index)];
        f.highlights.clear();
        ExactOptions options;
        options.level = level;
        options.sagittaPx = kSagittaPx;
        options.marginPx = kEdgeShare * std::max(f.camera.width, f.camera.height);
        for (const TrueLight& light : lightsOn(scene, lit, index)) {
          const Outcome<std::vector<Highlight>> found =
              exactHighlights(*movedTo(f.worldFromObject, surfaces.at(f.surface)), f.camera, light, material, options);
          if (!found) continue;  // not lit, or not visible from here
          for (Highlight h : *found) {
            h.light = light.id;
            h.level = level;
            h.fromScene = true;
            f.highlights.push_back(std::move(h));
          }
        }
      },
      progress, "synthesise");
}
}  // namespace

std::shared_ptr<const Scene> changedScene(const Scene& given, const WhatIf& whatIf, double level, const ProgressFn& progress,
                                          const std::vector<int>* frames) {
  auto scene = std::make_shared<Scene>(given);
  for (const auto& [frame, change] : whatIf.poses) {
    if (frame < 0 || frame >= int(scene->frames.size())) refuse(given, "frame " + std::to_string(frame) + " does not exist");
    if (!change.rotation.allFinite() || !change.translation.allFinite()) refuse(given, "a pose is not finite");
    scene->frames[std::size_t(frame)].camera = moved(scene->frames[std::size_t(frame)].camera, change);
  }
  if (!whatIf.synthesise) return scene;

  if (const std::optional<Failure> why = whyNotSynthesised(given))
    refuse(given, why->detail + ", so its contours cannot be synthesised");
  if (!(whatIf.roughness > 0) || !std::isfinite(whatIf.roughness)) refuse(given, "the roughness must be positive");
  for (const auto& [id, by] : whatIf.lightsBy) {
    const auto light =
        std::find_if(scene->lights.begin(), scene->lights.end(), [&, name = id](const TrueLight& l) { return l.id == name; });
    if (light == scene->lights.end()) refuse(given, "light '" + id + "' does not exist");
    light->lamp = moved(light->lamp, by);
  }
  AnalyticSurfaces surfaces;
  for (auto& [id, source] : scene->surfaces) {
    AnalyticSpec* const formula = source.analytic();
    if (!formula) continue;
    if (const auto wanted = whatIf.surfaces.find(id); wanted != whatIf.surfaces.end())
      *formula = withShape(*formula, wanted->second);
    try {
      surfaces[id] = makeAnalytic(*formula);
    } catch (const std::invalid_argument& e) {
      refuse(given, "surface '" + id + "': " + e.what());
    }
  }
  for (const auto& [id, value] : whatIf.surfaces)
    if (!surfaces.count(id) || !shapeOf(*scene->formulaOf(id))) refuse(given, "surface '" + id + "' has no adjustable shape");

  for (Frame& f : scene->frames) {
    f.image.clear();  // it shows what was captured
    f.radiance.clear();
    f.mask.clear();
    f.highlights.clear();
  }
  std::vector<int> all(scene->frames.size());
  std::iota(all.begin(), all.end(), 0);
  synthesise(*scene, surfaces, whatIf, level, frames ? *frames : all, progress);
  return scene;
}

std::shared_ptr<const Scene> withContours(const Scene& changed, const WhatIf& whatIf, double level,
                                          const std::vector<int>& frames, const ProgressFn& progress) {
  auto scene = std::make_shared<Scene>(changed);
  AnalyticSurfaces surfaces;
  for (const auto& [id, source] : scene->surfaces)
    if (const AnalyticSpec* const formula = source.analytic()) surfaces[id] = makeAnalytic(*formula);
  synthesise(*scene, surfaces, whatIf, level, frames, progress);
  return scene;
}

Highlight changed(Highlight h, const HighlightChange& change) {
  const Pixel centre = centroid(h.contour);
  for (Pixel& p : h.contour.points) p = centre + change.contourScale * (p - centre) + change.contourBy;
  h.peak += change.peakBy;
  h.areaPx2 = std::abs(signedArea(h.contour));
  h.ellipse.reset();
  if (const Outcome<Ellipse> e = fitEllipse(h.contour.points)) h.ellipse = *e;
  return h;
}

const char* nameOf(HighlightEdit::Kind kind) {
  switch (kind) {
    case HighlightEdit::Kind::Ignore: return "ignore";
    case HighlightEdit::Kind::Merge: return "merge";
    case HighlightEdit::Kind::Split: return "split";
    case HighlightEdit::Kind::Seed: break;
  }
  return "seed";
}

std::size_t placesOf(HighlightEdit::Kind kind) {
  return kind == HighlightEdit::Kind::Merge ? 2 : kind == HighlightEdit::Kind::Split ? 3 : 1;
}

WhatIf synthesisOf(const WhatIf& w) {
  WhatIf part;
  if (!w.synthesise) return part;
  part = w;
  part.highlights.clear();
  part.edits.clear();
  std::erase_if(part.lightsSwitched, [](const auto& light) { return !light.second; });
  return part;
}

std::map<std::pair<int, std::string>, bool> lightsOff(const WhatIf& w) {
  auto off = w.lightsSwitched;
  std::erase_if(off, [](const auto& light) { return light.second; });
  return off;
}

std::string lightsOffKey(const WhatIf& w) {
  std::string key;
  for (const auto& [at, on] : w.lightsSwitched)
    if (!on) key += std::to_string(at.first) + "/" + at.second + ",";
  return key;
}

std::string synthesisKey(const WhatIf& w) {
  if (!w.synthesise) return "";
  std::string key = std::string(nameOf(w.lobe)) + "," + exact(w.roughness);
  for (const auto& [id, by] : w.lightsBy) key += id + ":" + exact(by);
  for (const auto& [id, value] : w.surfaces) key += id + ":" + exact(value);
  for (const auto& [at, on] : w.lightsSwitched)
    if (on) key += std::to_string(at.first) + "/" + at.second + " on,";
  for (const auto& [frame, change] : w.poses)  // synthetic contours follow their cameras
    key += std::to_string(frame) + ":" + exact(change.rotation) + exact(change.translation);
  return key;
}

namespace {
constexpr double kSmallest = 0.05, kLargest = 20;  // of a contour: beyond, it is a point or fills the picture

/// Rotation vector of the camera's new axes in those it has now, so that what was seen at `from` is seen at `to`.
Eigen::Matrix3d turn(const Camera& camera, const Pixel& from, const Pixel& to) {
  const Eigen::Matrix3d rayFromPixel = camera.pixelFromRay.inverse();
  const Eigen::Vector3d was = rayFromPixel * from.homogeneous(), is = rayFromPixel * to.homogeneous();
  return Eigen::Quaterniond::FromTwoVectors(is, was).toRotationMatrix();
}

Eigen::Matrix3d matrixOf(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  if (!(angle > 0)) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
}
}  // namespace

WhatIf dragged(const WhatIf& start, Held held, int frame, const Camera& camera, int highlight, const Highlight& now,
               const Pixel& from, const Pixel& to) {
  WhatIf w = start;
  if (!from.allFinite() || !to.allFinite() || from == to) return w;
  if (held == Held::Camera) {
    PoseChange& change = w.poses[frame];
    const Eigen::AngleAxisd angle(matrixOf(change.rotation) * turn(camera, from, to));
    change.rotation = angle.angle() * angle.axis();
    return w;
  }
  HighlightChange& change = w.highlights[{frame, highlight}];
  if (held == Held::Peak) change.peakBy += to - from;
  if (held == Held::Contour) change.contourBy += to - from;
  if (held == Held::ContourSize) {
    const Pixel centre = centroid(now.contour);
    const double factor = (to - centre).norm() / (from - centre).norm();
    if (!std::isfinite(factor)) return start;
    change.contourScale = std::clamp(change.contourScale * factor, kSmallest, kLargest);
  }
  return w;
}

WhatIf draggedLight(const WhatIf& start, const TrueLight& light, const Eigen::Vector3d& by) {
  WhatIf w = start;
  if (light.lamp.atInfinity() || !by.allFinite() || by.isZero(0)) return w;
  w.lightsBy.try_emplace(light.id, Eigen::Vector3d::Zero()).first->second += by;
  return w;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/light_frame_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "core/base/evenly.h"
#include "core/base/number_text.h"
#include "core/light/shared_lamp.h"
#include "core/pipeline/carried.h"
#include "core/pipeline/known_lamps.h"
#include "core/surface/brightest_point.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

constexpr std::size_t kMostViews = 12;      // more do not make the answer surer
constexpr std::size_t kMostDepthMaps = 4;   // of frames that have their own: they are read here and again with the views
constexpr std::size_t kMostHighlights = 6;  // of a frame: more are texture, and the lamp's is among the largest
constexpr double kPeaksExplained = 0.25;    // of the contours' radius: what a lamp with a size and grazing views leave of peaks
constexpr double kLessThanWorld = 1.0 / 3;  // of what the world leaves: a wrong frame leaves tens of percent of the radius
constexpr double kAlike = 1.5;              // residuals of one frame over those of the other that cannot be told apart
constexpr double kLeastPx = 0.1;            // peaks are known no better

struct PeakView {
  int frame = -1;
  const Camera* camera = nullptr;
  std::shared_ptr<const Surface> surface;
  std::vector<Pixel> peaks;
  std::vector<SurfacePoint> places;  ///< of the peaks, on the surface
  std::vector<ReflectedRay> rays;    ///< mirrored there, world
  double radiusPx = 0;               ///< mean of its highlights
};

ReflectedRay turned(const Eigen::Isometry3d& to, const ReflectedRay& ray) {
  return {to * ray.origin, to.linear() * ray.direction, to.linear() * ray.normal};
}

/// The largest highlights of one light in a frame.
PeakView peakViewOf(const Scene& scene, const FrameEvidence& evidence, const std::string& light,
                    const std::shared_ptr<const Surface>& surface) {
  PeakView view{evidence.frame, &scene.frames[static_cast<std::size_t>(evidence.frame)].camera, surface, {}, {}, {}, 0};
  std::vector<const Highlight*> list;
  for (const Highlight& h : evidence.highlights)
    if (h.light == light && h.areaPx2 > 0 && !h.peakCut) list.push_back(&h);
  std::stable_sort(list.begin(), list.end(), [](const Highlight* a, const Highlight* b) { return a->areaPx2 > b->areaPx2; });
  if (list.size() > kMostHighlights) list.resize(kMostHighlights);
  for (const Highlight* h : list) {
    const Outcome<BrightestPoint> seen = observedBrightestPoint(*surface, *view.camera, h->peak);
    if (!seen) continue;
    view.peaks.push_back(h->peak);
    view.places.push_back(seen->point);
    view.rays.push_back(reflectedRay(*seen, *view.camera));
    view.radiusPx += std::sqrt(h->areaPx2 / EIGEN_PI);
  }
  if (!view.peaks.empty()) view.radiusPx /= double(view.peaks.size());
  return view;
}

/// By how far the lamp's brightest point misses the nearest peak of a view, px; nothing without one.
std::optional<double> missedPx(const PeakView& view, const Light& inWorld) {
  BrightestPointOptions options;
  options.hintsOnly = true;
  for (const SurfacePoint& p : view.places) options.hints.push_back(p.position);
  const Outcome<std::vector<BrightestPoint>> found = predictedBrightestPoints(*view.surface, *view.camera, inWorld, options);
  if (!found) return std::nullopt;
  double least = std::numeric_limits<double>::infinity();
  for (const BrightestPoint& b : *found)
    for (const Pixel& peak : view.peaks) least = std::min(least, (b.pixel - peak).norm());
  return std::isfinite(least) ? std::optional(least) : std::nullopt;
}

/// What the lamp that stands still in a frame of coordinates leaves of the peaks. Three quarters of the views count: a single one
/// may show something else.
std::optional<double> residualPx(const std::vector<PeakView>& views, LightFrame frame) {
  const auto fromWorld = [&](const PeakView& v) {
    return frame == LightFrame::Camera ? v.camera->camFromWorld : Eigen::Isometry3d::Identity();
  };
  std::vector<std::vector<ReflectedRay>> rays;
  for (const PeakView& v : views) {
    rays.emplace_back();
    for (const ReflectedRay& ray : v.rays) rays.back().push_back(turned(fromWorld(v), ray));
  }
  const std::optional<SharedLamp> lamp = sharedLamp(rays);
  if (!lamp) return std::nullopt;
  std::vector<double> missed;
  for (const PeakView& v : views)
    missed.push_back(missedPx(v, carried(lamp->light, fromWorld(v).inverse())).value_or(std::numeric_limits<double>::infinity()));
  std::sort(missed.begin(), missed.end());
  const std::size_t counted = std::max<std::size_t>(2, (3 * missed.size() + 3) / 4);
  double sum = 0;
  for (std::size_t i = 0; i < std::min(counted, missed.size()); ++i) sum += missed[i] * missed[i];
  const double rms = std::sqrt(sum / double(std::min(counted, missed.size())));
  return std::isfinite(rms) ? std::optional(rms) : std::nullopt;
}

std::string pxText(const std::optional<double>& px) {
  if (!px) return "no such lamp";
  return *px < 1e-3 ? std::string("less than 0.001 px") : formatted("%.2g px", *px);  // of a made scene: rounding errors
}

/// What the highlights of one light say.
struct Verdict {
  enum class Told { Nothing, Either, Both, Yes };  ///< none explains the peaks, both may, both are one, one does
  LightFrame frame = LightFrame::World;
  Told told = Told::Nothing;
  std::string reason;
};
/// @param still  the camera never moves: a lamp on it stands still in the world, too
Verdict verdictOf(const LightFrameChoice::Residuals& r, double radiusPx, bool still) {
  const double none = std::numeric_limits<double>::infinity();
  const double world = r.world.value_or(none), camera = r.camera.value_or(none),
               bound = std::max(kLeastPx, kPeaksExplained * radiusPx);
  const std::string both =
      "standing still it misses the peaks by " + pxText(r.world) + ", moving with the camera by " + pxText(r.camera);
  if (camera <= bound && world > kLeastPx && camera < kLessThanWorld * world)
    return {LightFrame::Camera, Verdict::Told::Yes, "the lamp moves with the camera: " + both};
  if (world <= bound && still)
    return {LightFrame::World, Verdict::Told::Both,
            "the camera stands still, and so does the lamp: it misses the peaks by " + pxText(r.world)};
  if (world <= bound && !(camera <= kAlike * std::max(world, kLeastPx)))
    return {LightFrame::World, Verdict::Told::Yes, "the lamp stands still: " + both};
  if (world <= bound)
    return {LightFrame::World, Verdict::Told::Either,
            "the views do not tell whether the lamp stands still or moves with the camera: " + both};
  return {LightFrame::World, Verdict::Told::Nothing,
          "no lamp explains the peaks, neither one that stands still nor one that moves with the camera: " + both};
}

std::string listed(const std::set<std::string>& lights) {
  std::string text;
  for (const std::string& light : lights) text += (text.empty() ? "" : ", ") + light;
  return text;
}

/// @param wanted      light.frame
/// @param known       where lamps stand that the scene states: they stay there. @param knownBoth  they are of both kinds
void decide(LightFrameChoice& choice, const std::string& wanted, const std::set<std::string>& still,
            const std::set<std::string>& moving, std::optional<LightFrame> known, bool knownBoth) {
  const bool most = !moving.empty() && moving.size() >= still.size();
  const LightFrame best = known && !knownBoth ? *known : most ? LightFrame::Camera : LightFrame::World;
  choice.frame = wanted == "auto" ? best : wanted == "camera" ? LightFrame::Camera : LightFrame::World;
  const bool inCamera = choice.frame == LightFrame::Camera;
  const std::set<std::string>& others = inCamera ? still : moving;
  const bool both = !moving.empty() && !still.empty();
  if (wanted == "auto" && both && !knownBoth) {
    choice.elsewhere = others;
    choice.reason = "Lamps of both kinds are on: " + listed(moving) + " with the camera, " + listed(still) + " in the world";
  } else if (both) {
    choice.doubt = formatted(
        "some lamps stand still (%zu) and others move with the camera (%zu): one light is fitted to those that %s (light.frame)",
        still.size(), moving.size(), inCamera ? "move with the camera" : "stand still");
  } else if (wanted != "auto" && !others.empty()) {
    choice.doubt = "light.frame=" + wanted + ", but " + choice.reason;
  }
}

/// By label, of lights that are not known.
std::map<std::string, std::vector<PeakView>> peakViews(const Scene& scene, const SurfaceCache& surfaces,
                                                       const std::vector<int>& training,
                                                       const std::vector<FrameEvidence>& evidence, const Settings& settings) {
  const auto hasOwnDepth = [&](int frame) { return scene.frames[static_cast<std::size_t>(frame)].surface.empty(); };
  const bool depthAlone = std::all_of(training.begin(), training.end(), hasOwnDepth);
  std::map<std::string, std::vector<PeakView>> views;
  const auto stays = [&](int frame) {
    return scene.frames[static_cast<std::size_t>(frame)].camera.camFromWorld.isApprox(
        scene.frames[static_cast<std::size_t>(training.front())].camera.camFromWorld);
  };
  if (depthAlone && (settings.text("light.frame") != "auto" || std::all_of(training.begin(), training.end(), stays)))
    return views;  // nothing would be told that is worth reading maps
  for (const int frame : evenly(training, depthAlone ? kMostDepthMaps : kMostViews)) {
    const FrameEvidence& e = evidence[static_cast<std::size_t>(frame)];
    if (e.frame < 0 || e.highlights.empty() || (!depthAlone && hasOwnDepth(frame))) continue;
    const Outcome<std::shared_ptr<const Surface>> surface = surfaces.surfaceOf(frame, meshPolicy(settings));
    if (!surface) continue;
    std::set<std::string> labels;
    for (const Highlight& h : e.highlights) labels.insert(h.light);
    for (const std::string& label : labels)
      if (PeakView view = peakViewOf(scene, e, label, *surface); !view.peaks.empty() && !knownLamp(scene, label))
        views[label].push_back(std::move(view));
  }
  return views;
}

}  // namespace

LightFrame LightFrameChoice::frameOf(const std::string& light) const {
  if (!elsewhere.count(light)) return frame;
  return frame == LightFrame::World ? LightFrame::Camera : LightFrame::World;
}

LightFrameChoice chooseLightFrame(const Scene& scene, const SurfaceCache& surfaces, const std::vector<int>& training,
                                  const std::vector<FrameEvidence>& evidence, const Settings& settings) {
  LightFrameChoice choice;
  const std::map<std::string, std::vector<PeakView>> views = peakViews(scene, surfaces, training, evidence, settings);
  std::set<std::string> still, moving;  // lights of which it is told
  for (const TrueLight& light : scene.lights)
    if (light.known) (light.frame == LightFrame::Camera ? moving : still).insert(light.id);
  const bool stated = !moving.empty() || !still.empty(), statedBoth = !moving.empty() && !still.empty();
  if (stated)
    choice.reason = std::string("the scene states its lamps: they ") + (moving.empty() ? "stand still" : "move with the camera");
  const bool statedMove = stated && !moving.empty();
  for (const auto& [label, list] : views) {
    double radius = 0;
    for (const PeakView& v : list) radius += v.radiusPx / double(list.size());
    const LightFrameChoice::Residuals& r =
        choice.byLight[label] = {residualPx(list, LightFrame::World), residualPx(list, LightFrame::Camera)};
    const bool stays = std::all_of(list.begin(), list.end(), [&, &first = list.front()](const PeakView& v) {
      return v.camera->camFromWorld.isApprox(first.camera->camFromWorld);
    });
    const Verdict verdict = verdictOf(r, radius, stays);
    if (verdict.told == Verdict::Told::Yes) (verdict.frame == LightFrame::Camera ? moving : still).insert(label);
    if (choice.reason.empty() || verdict.frame == LightFrame::Camera) choice.reason = verdict.reason;
    if (verdict.told == Verdict::Told::Either && choice.doubt.empty()) choice.doubt = verdict.reason;
  }
  // The setting says where unknown lights stand.
  decide(choice, stated && views.empty() ? "auto" : settings.text("light.frame"), still, moving,
         stated ? std::optional(statedMove ? LightFrame::Camera : LightFrame::World) : std::nullopt, statedBoth);
  return choice;
}

}  // namespace glint

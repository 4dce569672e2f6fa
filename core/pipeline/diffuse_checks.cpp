// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/diffuse_checks.h"

#include <algorithm>
#include <set>
#include <utility>

#include "core/base/evenly.h"
#include "core/geometry/transforms.h"
#include "core/model/models.h"
#include "core/pipeline/second_lobe_check.h"
#include "core/pipeline/vignetting_check.h"
#include "core/reflectance/pixel_fit.h"
#include "core/scene/light_frame.h"
#include "core/surface/posed_surface.h"

namespace glint {
namespace {

constexpr std::size_t kMostSighting = 6, kFewestSighting = 4;  // more tell no more; of three, each point has hardly two more
constexpr int kAnglePoints = 36;                               // of a contour, for the half angle that it reaches

bool isPhotograph(const Frame& frame, FrameSource source) {
  return !frame.image.empty() && (source == FrameSource::Image || frame.radiance.empty());
}

/// The lights whose highlights the frames of a surface show.
std::set<FitKey> keysOf(const Inspection& r, const SightedSurface& sighted) {
  std::set<FitKey> keys;
  for (const int f : sighted.frames)
    for (const Highlight& h : r.evidence[static_cast<std::size_t>(f)].highlights) keys.insert(r.keyFor(f, h.light));
  return keys;
}

}  // namespace

void addDoubt(Inspection& r, const FitKey& key, const std::string& doubt) {
  if (doubt.empty()) return;
  std::string& all = r.pixelDoubts[key];
  all += (all.empty() ? "" : "; ") + doubt;
}

std::vector<SightedSurface> sightedSurfaces(const Inspection& r, const std::vector<int>& frames,
                                            const SurfaceOfFrame& surfaceOf) {
  const EvidenceInputs& asked = r.inputs.lobes->evidence;
  // The same points of the object are asked, wherever it stands.
  const Scene around = standsStill(*r.scene) ? Scene() : inObject(*r.scene);
  const Scene& scene = around.frames.empty() ? *r.scene : around;
  std::map<std::string, std::vector<int>> bySurface;
  for (const int f : frames) {
    const Frame& frame = r.scene->frames[static_cast<std::size_t>(f)];
    if (!frame.surface.empty() && frame.lightsOn == r.scene->frames[static_cast<std::size_t>(frames.front())].lightsOn)
      bySurface[r.surfaces->keyOf(f)].push_back(f);
  }
  std::vector<SightedSurface> all;
  for (const auto& [key, own] : bySurface) {
    std::shared_ptr<const Surface> surface = surfaceOf(own.front());
    if (!surface || own.size() < kFewestSighting) continue;
    surface = movedTo(Eigen::Isometry3d::Identity(), std::move(surface));
    std::vector<TextureView> views;
    bool photographs = true;
    for (const int f : evenly(own, kMostSighting)) {
      Outcome<TextureView> view = textureView(scene, f, asked.source, asked.detect, *surface);
      if (!view) continue;
      view->spots = lobeSpots(r.evidence[static_cast<std::size_t>(f)].highlights);
      photographs = photographs && isPhotograph(scene.frames[static_cast<std::size_t>(f)], asked.source);
      views.push_back(*std::move(view));
    }
    if (views.size() < kFewestSighting) continue;
    SightedSurface sighted{own, TexturePanel(std::move(views), surface), {}, photographs};
    sighted.points = brightSightings(sighted.panel);
    all.push_back(std::move(sighted));
  }
  return all;
}

void addVignetting(Inspection& r, const std::vector<SightedSurface>& all) {
  for (const SightedSurface& s : all) {
    if (!s.photographs) continue;
    const std::string remark = vignettingRemark(vignettingOf(s.panel, s.points), s.panel.views().size(),
                                                r.scene->frames[static_cast<std::size_t>(s.frames.front())].response);
    for (const FitKey& key : keysOf(r, s)) addDoubt(r, key, remark);
  }
}

void addSecondLobes(Inspection& r, const std::vector<SightedSurface>& all,
                    const std::map<FitKey, std::vector<TrainingView>>& groups) {
  if (!standsStill(*r.scene)) return;
  for (const SightedSurface& s : all) {
    const std::set<FitKey> keys = keysOf(r, s);
    if (keys.size() != 1) continue;
    const FitKey& key = *keys.begin();
    const auto views = groups.find(key);
    const auto fit = r.pixelFits.find(key);
    if (views == groups.end() || fit == r.pixelFits.end() || !fit->second) continue;
    if (!isIdentity(r.lightFromScene(s.frames.front(), key.light))) continue;
    const Light light = lightOf((*fit->second)->model.lamp);
    const double halfAngle = medianContourAngle(views->second, light, kAnglePoints);
    addDoubt(r, key, secondLobeRemark(secondLobeOf(s.panel, s.points, light, halfAngle)));
  }
}

}  // namespace glint

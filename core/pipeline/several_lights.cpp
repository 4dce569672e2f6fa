// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <set>

#include "core/base/progress.h"
#include "core/light/track.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/known_lamps.h"

namespace glint {
namespace {

bool statesNoLight(const Frame& f) {
  return f.lightsOn.empty() &&
         std::all_of(f.highlights.begin(), f.highlights.end(), [](const Highlight& h) { return h.light.empty(); });
}

/// Brings the highlights of every light of a frame to the level of its strongest one. What then contains a peak of another light
/// is of both: its light is cleared.
void levelOfEachLight(FrameEvidence& e, bool detected, const std::function<FrameEvidence(const SeparateLights&)>& detectAgain) {
  std::map<std::string, std::vector<const Highlight*>> byLight;
  for (const Highlight& h : e.highlights)
    if (!h.light.empty()) byLight[h.light].push_back(&h);
  const auto several = [](const auto& entry) { return entry.second.size() > 1; };
  if (!detected || byLight.size() < 2 || std::none_of(byLight.begin(), byLight.end(), several)) return;
  SeparateLights lights;
  lights.separate = true;
  for (const auto& [light, highlights] : byLight) {
    double strongest = 0;
    for (const Highlight* h : highlights) strongest = std::max(strongest, h->peakValue);
    for (const Highlight* h : highlights)
      if (strongest > 0) lights.references.push_back({h->peak, strongest});
  }
  FrameEvidence again = detectAgain(lights);
  if (again.failure) return;
  const std::vector<Highlight> before = e.highlights;
  e.highlights.clear();
  for (Highlight& h : again.highlights) {
    std::set<std::string> inside;
    for (const Highlight& b : before)
      if (!b.light.empty() && contains(h.contour, b.peak)) inside.insert(b.light);
    h.light = inside.size() == 1 ? *inside.begin() : "";
    e.highlights.push_back(std::move(h));
  }
}

std::vector<TrackedFrame> trackedFrames(const Scene& scene, const std::vector<FrameEvidence>& evidence,
                                        const std::vector<Eigen::Isometry3d>& elsewhereFromScene) {
  std::vector<TrackedFrame> tracked(scene.frames.size());
  for (std::size_t i = 0; i < tracked.size(); ++i) {
    tracked[i] = {scene.frames[i].camera, scene.frames[i].lightsOn, evidence[i].highlights, std::nullopt};
    if (!elsewhereFromScene.empty()) tracked[i].elsewhereFromHere = elsewhereFromScene[i];
  }
  return tracked;
}

/// A truth file names no light: its contours are of the light whose detected highlight they overlap.
void nameTruth(FrameEvidence& e) {
  std::set<std::string> lights;
  for (const Highlight& h : e.highlights)
    if (!h.light.empty()) lights.insert(h.light);
  if (lights.size() < 2) return;
  for (Highlight& t : e.truth) {
    t.light.clear();
    for (const Highlight& h : e.highlights)
      if (!h.light.empty() && (contains(h.contour, t.peak) || contains(t.contour, h.peak))) t.light = h.light;
  }
}

}  // namespace

bool lightsNeedAllFrames(const Scene& scene) {
  const auto unnamed = [](const Highlight& h) { return h.light.empty(); };
  return std::any_of(scene.frames.begin(), scene.frames.end(), [&](const Frame& f) {
    return f.lightsOn.size() > 1 || statesNoLight(f) ||
           (f.lightsOn.empty() && std::any_of(f.highlights.begin(), f.highlights.end(), unnamed));
  });
}

void assignSeveralLights(const Scene& scene, std::vector<FrameEvidence>& evidence,
                         const std::function<std::shared_ptr<const Surface>(int frame)>& surfaceOf,
                         const std::function<FrameEvidence(int frame, const SeparateLights&)>& detectAgain,
                         const std::vector<Eigen::Isometry3d>& elsewhereFromScene, const ProgressFn& progress) {
  const std::size_t n = scene.frames.size();
  const auto open = [](const FrameEvidence& e) {
    return std::any_of(e.highlights.begin(), e.highlights.end(), [](const Highlight& h) { return h.light.empty(); });
  };
  // What a frame states nothing about is "light" to itself; together the frames may prove that there are more.
  for (std::size_t i = 0; i < n; ++i)
    if (statesNoLight(scene.frames[i]))
      for (Highlight& h : evidence[i].highlights) h.light.clear();
  const bool named = assignKnownLamps(scene, evidence, surfaceOf);
  if (std::none_of(evidence.begin(), evidence.end(), open)) {
    if (named)
      for (FrameEvidence& e : evidence) nameTruth(e);
    return;
  }
  const auto assign = [&] {
    std::vector<TrackedFrame> tracked = trackedFrames(scene, evidence, elsewhereFromScene);
    if (!report(progress, {"assign lights", 0, 0})) throw Stopped{};
    const int groups = assignLights(tracked, [&](std::size_t i) { return surfaceOf(static_cast<int>(i)); });
    for (std::size_t i = 0; i < n; ++i) evidence[i].highlights = std::move(tracked[i].highlights);
    return groups;
  };
  const auto detected = [&](std::size_t i) {
    const std::vector<Highlight>& h = evidence[i].highlights;
    return !h.empty() && !h.front().fromScene;
  };
  const bool unstated = std::all_of(scene.frames.begin(), scene.frames.end(), [](const Frame& f) { return f.lightsOn.empty(); });
  if (assign() > 1 && unstated) {
    // Only now it is known that there are several: their levels are not those of one.
    bool again = false;
    for (std::size_t i = 0; i < n; ++i) again = again || detected(i);
    if (again) {
      parallelFor(
          static_cast<int>(n),
          [&](int i) {
            if (!detected(i)) return;
            FrameEvidence e = detectAgain(i, {true, {}});
            if (e.failure) return;
            for (Highlight& h : e.highlights) h.light.clear();
            evidence[i].highlights = std::move(e.highlights);
          },
          progress, "detect");
      assign();
    }
  }
  // A light with several highlights in a frame has one level there: that of its strongest.
  parallelFor(
      static_cast<int>(n),
      [&](int i) {
        levelOfEachLight(evidence[i], detected(i), [&](const SeparateLights& l) { return detectAgain(static_cast<int>(i), l); });
      },
      progress, "detect");
  for (FrameEvidence& e : evidence) nameTruth(e);
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/shard.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>

namespace glint {
namespace {

int frameCount(const Inspection& inspection) { return static_cast<int>(inspection.scene->frames.size()); }

/// What a frame may be found to show: the lights that its scene file names, or the only one that is on.
std::set<std::string> possibleLights(const Frame& frame) {
  std::set<std::string> lights;
  for (const Highlight& h : frame.highlights)
    if (!h.light.empty()) lights.insert(h.light);
  lights.insert(frame.lightsOn.empty() ? "light" : frame.lightsOn.front());
  return lights;
}

}  // namespace

std::vector<int> framesOfShard(const Shard& shard, const Inspection& inspection) {
  const int n = frameCount(inspection);
  std::vector<int> frames;
  if (!inspection.train.perSurface) {
    const auto [first, end] = rangeOf(shard, n);
    for (int i = first; i < end; ++i) frames.push_back(i);
    return frames;
  }
  std::map<std::string, int> numbers;  // of surfaces, by their first frame
  for (int i = 0; i < n; ++i) numbers.emplace(inspection.surfaces->keyOf(i), static_cast<int>(numbers.size()));
  const auto [first, end] = rangeOf(shard, static_cast<int>(numbers.size()));
  for (int i = 0; i < n; ++i)
    if (const int number = numbers.at(inspection.surfaces->keyOf(i)); first <= number && number < end) frames.push_back(i);
  return frames;
}

bool lightsKnownFrom(const Inspection& inspection, const std::vector<int>& frames) {
  if (inspection.request.whatIf.synthesise) return false;  // lights are then those of what is synthesised
  std::set<std::string> shown;
  for (const FrameEvidence& e : inspection.evidence) {
    if (e.frame < 0 || !inspection.isTraining(e.frame)) continue;
    for (const Highlight& h : e.highlights)
      if (!isSwitchedOff(inspection.request.whatIf, e.frame, h.light)) shown.insert(h.light);
  }
  const auto known = [&](int frame) {
    const Frame& f = inspection.scene->frames[static_cast<std::size_t>(frame)];
    const std::set<std::string> lights = possibleLights(f);
    return f.lightsOn.size() <= 1 && std::includes(shown.begin(), shown.end(), lights.begin(), lights.end());
  };
  if (inspection.train.perSurface) return std::all_of(frames.begin(), frames.end(), known);
  for (int i = 0; i < frameCount(inspection); ++i)
    if (!known(i)) return false;
  return true;
}

void keepOwnSurfaces(Inspection& r, const std::vector<int>& frames) {
  if (!r.train.perSurface) return;
  std::set<std::string> surfaces;
  for (const int f : frames) surfaces.insert(r.surfaces->keyOf(f));
  for (int i = 0; i < frameCount(r); ++i)
    if (!surfaces.count(r.surfaces->keyOf(i))) r.evidence[static_cast<std::size_t>(i)] = {};
  for (auto& [name, result] : r.models) {
    std::vector<ModelResult::Fit> kept;
    std::vector<int> now(result.fits.size(), -1);
    for (std::size_t f = 0; f < result.fits.size(); ++f) {
      if (!surfaces.count(result.fits[f].surface.value_or(""))) continue;
      now[f] = static_cast<int>(kept.size());
      kept.push_back(std::move(result.fits[f]));
    }
    result.fits = std::move(kept);
    for (FrameComparison& c : result.frames) c.fit = now[static_cast<std::size_t>(c.fit)];
  }
}

}  // namespace glint

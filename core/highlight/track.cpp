// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/track.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <set>

#include "core/light/estimate.h"

namespace glint {
namespace {

/// A highlight that waits for its light.
struct Item {
  std::size_t frame, highlight;
  ReflectedRay ray;
  double radiansPerPixel;  ///< how fast the reflected direction turns when the peak moves
};

std::optional<Item> itemOf(const TrackedFrame& frame, std::size_t f, std::size_t i) {
  if (!frame.surface) return std::nullopt;
  const auto rayAt = [&](const Pixel& pixel) -> std::optional<ReflectedRay> {
    const Outcome<BrightestPoint> point = observedBrightestPoint(*frame.surface, frame.camera, pixel);
    if (!point) return std::nullopt;
    return reflectedRay(*point, frame.camera);
  };
  const Pixel peak = frame.highlights[i].peak;
  const std::optional<ReflectedRay> ray = rayAt(peak);
  if (!ray) return std::nullopt;
  double turn = 1 / frame.camera.pixelFromRay(0, 0);  // a plane's, where the surface ends beside the peak
  for (const Pixel& step : {Pixel(1, 0), Pixel(0, 1)})
    if (const std::optional<ReflectedRay> other = rayAt(peak + step))
      turn = std::max(turn, (other->direction - ray->direction).norm());
  return Item{f, i, *ray, turn};
}

double missPx(const Item& item, const Light& light) {
  const Eigen::Vector3d to = light.directionFrom(item.ray.origin);
  const double angle = std::atan2(item.ray.direction.cross(to).norm(), item.ray.direction.dot(to));
  return angle / item.radiansPerPixel;
}

/// The best item of every frame that agrees with the light, at most one a frame.
std::vector<std::size_t> followers(const std::vector<Item>& items, const std::vector<char>& taken, const Light& light,
                                   double inlierPx) {
  std::map<std::size_t, std::pair<double, std::size_t>> best;
  for (std::size_t k = 0; k < items.size(); ++k) {
    if (taken[k]) continue;
    const double miss = missPx(items[k], light);
    if (!(miss <= inlierPx)) continue;
    const auto found = best.find(items[k].frame);
    if (found == best.end() || miss < found->second.first) best[items[k].frame] = {miss, k};
  }
  std::vector<std::size_t> result;
  for (const auto& entry : best) result.push_back(entry.second.second);
  return result;
}

std::optional<Light> lightOf(const std::vector<Item>& items, const std::vector<std::size_t>& members) {
  std::vector<ReflectedRay> rays;
  for (const std::size_t k : members) rays.push_back(items[k].ray);
  const Outcome<Triangulation> found = triangulateLight(rays);
  if (!found) return std::nullopt;
  return found->light;
}

/// Pairs of different frames, all of them or a seeded choice.
std::vector<std::pair<std::size_t, std::size_t>> seedPairs(const std::vector<Item>& items, const std::vector<char>& taken,
                                                           const TrackOptions& options) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < items.size(); ++a)
    for (std::size_t b = a + 1; b < items.size(); ++b)
      if (!taken[a] && !taken[b] && items[a].frame != items[b].frame) pairs.emplace_back(a, b);
  if (pairs.size() > static_cast<std::size_t>(options.maxPairs)) {
    std::mt19937 random(options.seed);
    std::shuffle(pairs.begin(), pairs.end(), random);
    pairs.resize(static_cast<std::size_t>(options.maxPairs));
  }
  return pairs;
}

/// The id that is on in most of the group's frames and least elsewhere; "" when all are used.
std::string nameFor(const std::vector<TrackedFrame>& frames, const std::set<std::size_t>& members,
                    const std::set<std::string>& used) {
  std::map<std::string, int> votes;
  for (std::size_t f = 0; f < frames.size(); ++f)
    for (const std::string& id : frames[f].lightsOn)
      if (!used.count(id)) votes[id] += members.count(f) ? static_cast<int>(frames.size()) : -1;
  std::string best;
  for (const auto& [id, vote] : votes)
    if (best.empty() || vote > votes.at(best)) best = id;
  return best;
}

}  // namespace

int assignLights(std::vector<TrackedFrame>& frames, const TrackOptions& options) {
  const bool stated = std::any_of(frames.begin(), frames.end(), [](const TrackedFrame& f) { return !f.lightsOn.empty(); });
  std::vector<Item> items;
  bool several = false;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    TrackedFrame& frame = frames[f];
    const std::string only = !stated ? "light" : (frame.lightsOn.size() == 1 ? frame.lightsOn.front() : "");
    several = several || (stated && frame.lightsOn.size() != 1);
    for (std::size_t i = 0; i < frame.highlights.size(); ++i) {
      frame.highlights[i].light = only;
      if (stated)
        if (std::optional<Item> item = itemOf(frame, f, i)) items.push_back(*item);
    }
  }
  if (!several) return 0;

  // Frames with one light vote too: they give the others their names.
  std::vector<char> taken(items.size(), 0);
  std::set<std::string> used;
  int groups = 0;
  for (;;) {
    std::vector<std::size_t> best;
    double bestMiss = 0;
    for (const auto& [a, b] : seedPairs(items, taken, options)) {
      const std::optional<Light> light = lightOf(items, {a, b});
      if (!light) continue;
      const std::vector<std::size_t> group = followers(items, taken, *light, options.inlierPx);
      double miss = 0;
      for (const std::size_t k : group) miss += missPx(items[k], *light);
      if (group.size() > best.size() || (group.size() == best.size() && miss < bestMiss)) {
        best = group;
        bestMiss = miss;
      }
    }
    // Any two rays nearly meet: three frames are the least that confirm a light, unless there are only two.
    if (best.size() < std::min<std::size_t>(3, frames.size()) || best.size() < 2) break;
    for (int round = 0; round < 3; ++round) {
      const std::optional<Light> light = lightOf(items, best);
      if (!light) break;
      const std::vector<std::size_t> group = followers(items, taken, *light, options.inlierPx);
      if (group.size() < best.size()) break;
      best = group;
    }
    std::set<std::size_t> members;
    for (const std::size_t k : best) {
      members.insert(items[k].frame);
      taken[k] = 1;
    }
    const std::string name = nameFor(frames, members, used);
    if (name.empty()) break;
    used.insert(name);
    ++groups;
    for (const std::size_t k : best)
      if (frames[items[k].frame].lightsOn.size() != 1) frames[items[k].frame].highlights[items[k].highlight].light = name;
  }
  return groups;
}

}  // namespace glint

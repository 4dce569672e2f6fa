// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/track.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include "core/base/evenly.h"
#include "core/geometry/plane.h"
#include "core/light/estimate.h"

namespace glint {
namespace {

constexpr double kTightShare = 0.2;      // of the highlight's size: slanted lobes have their peak off the mirror point
constexpr double kLooseShare = 1.0;      // the mirror point lies inside the contour
constexpr double kStepShare = 0.1;       // of the highlight's size, for the derivative: a mesh's normals are noisy over a pixel
constexpr double kLeastSlope = 0.02;     // of the squared size of a Jacobian: below, its determinant says nothing
constexpr std::size_t kVoters = 160;     // highlights that vote on a candidate; more would not change which one wins
constexpr std::size_t kLeastFrames = 3;  // any two rays nearly meet
constexpr int kVoteRounds = 10;

/// A reflected ray at a pixel.
struct RaySample {
  Eigen::Vector3d origin, direction;
};

/// A highlight that waits for its light.
struct Item {
  std::size_t frame, highlight;
  ReflectedRay ray;
  Eigen::Matrix<double, 3, 2> across;  ///< basis across the ray
  RaySample next[2];                   ///< at `step` pixels along x and y
  Pixel step;
  Eigen::Matrix2d tight, loose;  ///< metrics: d^T M d <= 1 is an inlier, d in pixels
};

/// Squared semi-axes of the contour about its peak; zero without a contour.
Eigen::Matrix2d shapeOf(const Highlight& h) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  if (h.contour.points.size() < 3) return sum;
  constexpr int kPoints = 36;
  for (const Pixel& p : resample(h.contour, kPoints)) sum += (p - h.peak) * (p - h.peak).transpose() / kPoints;
  return 2 * sum;  // points of an ellipse have half of its squared semi-axes as moments
}

std::optional<Item> itemOf(const TrackedFrame& frame, const Surface& surface, std::size_t f, std::size_t i, double inlierPx) {
  const auto rayAt = [&](const Pixel& pixel) -> std::optional<ReflectedRay> {
    const Outcome<BrightestPoint> point = observedBrightestPoint(surface, frame.camera, pixel);
    if (!point) return std::nullopt;
    return reflectedRay(*point, frame.camera);
  };
  const Highlight& h = frame.highlights[i];
  const std::optional<ReflectedRay> ray = rayAt(h.peak);
  if (!ray) return std::nullopt;
  Item item;
  item.frame = f;
  item.highlight = i;
  item.ray = *ray;
  item.across = tangentBasis(ray->direction);
  const Eigen::Matrix2d shape = shapeOf(h), noise = inlierPx * inlierPx * Eigen::Matrix2d::Identity();
  if (!shape.allFinite()) return std::nullopt;
  item.tight = (noise + kTightShare * kTightShare * shape).inverse();
  item.loose = (noise + kLooseShare * kLooseShare * shape).inverse();
  const double size = std::max(1.0, kStepShare * std::sqrt(0.5 * shape.trace()));
  for (int k = 0; k < 2; ++k) {
    std::optional<ReflectedRay> other;
    for (const double sign : {1.0, -1.0}) {
      if (other) continue;
      item.step(k) = sign * size;
      other = rayAt(h.peak + item.step(k) * Pixel::Unit(k));
    }
    if (!other) return std::nullopt;
    item.next[k] = {other->origin, other->direction};
  }
  return item;
}

/// The way from the peak to the light's mirror point, px: one Newton step of "the reflected ray points at the light". Nothing
/// behind the surface.
std::optional<Pixel> toMirrorPoint(const Item& item, const Light& light) {
  const Eigen::Vector3d to = light.directionFrom(item.ray.origin);
  if (!(to.dot(item.ray.direction) > 0) || !(to.dot(item.ray.normal) > 0)) return std::nullopt;
  const Eigen::Vector3d here = item.ray.direction - to;
  Eigen::Matrix2d slope;
  for (int k = 0; k < 2; ++k)
    slope.col(k) =
        item.across.transpose() * (item.next[k].direction - light.directionFrom(item.next[k].origin) - here) / item.step(k);
  const double least = kLeastSlope * slope.squaredNorm();
  if (!(least > 0)) return std::nullopt;
  double determinant = slope.determinant();
  if (std::abs(determinant) < least) determinant = determinant < 0 ? -least : least;
  Eigen::Matrix2d adjugate;
  adjugate << slope(1, 1), -slope(0, 1), -slope(1, 0), slope(0, 0);
  const Pixel by = -adjugate * (item.across.transpose() * here) / determinant;
  if (!by.allFinite()) return std::nullopt;
  return by;
}

/// Squared distance in units of the metric; infinite where the light cannot be seen.
double missSquared(const Item& item, const Light& light, const Eigen::Matrix2d Item::*metric) {
  const std::optional<Pixel> by = toMirrorPoint(item, light);
  return by ? by->dot(item.*metric * *by) : std::numeric_limits<double>::infinity();
}

using Members = std::vector<std::size_t>;

std::optional<Light> lightOf(const std::vector<Item>& items, const Members& members) {
  std::vector<ReflectedRay> rays;
  for (const std::size_t k : members) rays.push_back(items[k].ray);
  const Outcome<Triangulation> found = triangulateLight(rays);
  if (found) return found->light;
  if (found.failure().reason != Reason::LightBehindSurface) return std::nullopt;
  // Nearly parallel rays may meet behind the surface: their mean direction explains them as well.
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const ReflectedRay& r : rays) mean += r.direction;
  if (!(mean.norm() > 0.5 * double(rays.size()))) return std::nullopt;
  return Light::towards(mean);
}

Members inliers(const std::vector<Item>& items, const Members& among, const Light& light, const Eigen::Matrix2d Item::*metric) {
  Members result;
  for (const std::size_t k : among)
    if (missSquared(items[k], light, metric) <= 1) result.push_back(k);
  return result;
}

std::size_t framesOf(const std::vector<Item>& items, const Members& members) {
  std::set<std::size_t> frames;
  for (const std::size_t k : members) frames.insert(items[k].frame);
  return frames.size();
}

/// Pairs of different frames, all of them or a seeded choice.
std::vector<std::pair<std::size_t, std::size_t>> seedPairs(const std::vector<Item>& items, const Members& among,
                                                           const TrackOptions& options) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < among.size(); ++a)
    for (std::size_t b = a + 1; b < among.size(); ++b)
      if (items[among[a]].frame != items[among[b]].frame) pairs.emplace_back(among[a], among[b]);
  if (pairs.size() > static_cast<std::size_t>(options.maxPairs)) {
    std::mt19937 random(options.seed);
    std::shuffle(pairs.begin(), pairs.end(), random);
    pairs.resize(static_cast<std::size_t>(options.maxPairs));
  }
  return pairs;
}

struct Group {
  Light light;
  Members members;         ///< that contain its mirror point and no nearer one of another light
  bool elsewhere = false;  ///< it stands still in the other coordinates
};

/// All highlights, in both coordinates; `there` is empty where frames have no others.
struct Items {
  std::vector<Item> here, there;

  const std::vector<Item>& of(const Group& g) const { return g.elsewhere ? there : here; }
};

Item carriedItem(Item item, const Eigen::Isometry3d& by) {
  item.ray = {by * item.ray.origin, by.linear() * item.ray.direction, by.linear() * item.ray.normal};
  item.across = by.linear() * item.across;
  for (RaySample& next : item.next) next = {by * next.origin, by.linear() * next.direction};
  return item;
}

/// The light that most of `free` confirm, refined on its own inliers. Nothing when too few frames do.
std::optional<Group> bestGroup(const std::vector<Item>& items, const Members& free, std::size_t leastFrames,
                               const TrackOptions& options) {
  const Members voters = evenly(free, kVoters);
  std::optional<Light> best;
  double most = 0;
  for (const auto& [a, b] : seedPairs(items, voters, options)) {
    const std::optional<Light> light = lightOf(items, {a, b});
    if (!light) continue;
    double votes = 0;
    for (const std::size_t k : voters) votes += std::max(0.0, 1 - missSquared(items[k], *light, &Item::tight));
    if (votes > most) most = votes, best = light;
  }
  if (!best) return std::nullopt;
  Members members = inliers(items, free, *best, &Item::tight);
  for (int round = 0; round < kVoteRounds; ++round) {
    const std::optional<Light> light = lightOf(items, members);
    if (!light) break;
    Members next = inliers(items, free, *light, &Item::tight);
    if (framesOf(items, next) < framesOf(items, members)) break;
    best = light;
    const bool same = next == members;
    members = std::move(next);
    if (same) break;
  }
  if (framesOf(items, members) < leastFrames) return std::nullopt;
  return Group{*best, std::move(members)};
}

/// The same where a light may stand still in other coordinates, too.
std::optional<Group> bestGroup(const Items& items, const Members& free, std::size_t leastFrames, const TrackOptions& options) {
  std::optional<Group> here = bestGroup(items.here, free, leastFrames, options);
  if (items.there.empty()) return here;
  std::optional<Group> there = bestGroup(items.there, free, leastFrames, options);
  if (!there || (here && there->members.size() <= here->members.size())) return here;
  there->elsewhere = true;
  return there;
}

/// Squared distance of every item from a light's mirror point in units of its own size; infinite where it does not contain the
/// mirror point, or where a highlight of the same frame sits on that very mirror point: one point shows one highlight.
std::vector<double> containing(const std::vector<Item>& items, const std::vector<TrackedFrame>& frames, const Light& light) {
  constexpr double kSamePoint = 0.5;  // of the distance to it: two Newton steps that end this close together mean one point
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> miss(items.size(), infinity);
  std::vector<std::optional<Pixel>> by(items.size());
  std::map<std::size_t, std::vector<std::size_t>> confirming;  // by frame
  for (std::size_t k = 0; k < items.size(); ++k) {
    by[k] = toMirrorPoint(items[k], light);
    if (!by[k]) continue;
    const double loose = by[k]->dot(items[k].loose * *by[k]);
    if (loose <= 1) miss[k] = loose;
    if (by[k]->dot(items[k].tight * *by[k]) <= 1) confirming[items[k].frame].push_back(k);
  }
  const auto mirrorPoint = [&](std::size_t k) -> Pixel {
    return frames[items[k].frame].highlights[items[k].highlight].peak + *by[k];
  };
  for (std::size_t k = 0; k < items.size(); ++k) {
    if (!(miss[k] <= 1)) continue;
    const auto found = confirming.find(items[k].frame);
    if (found == confirming.end()) continue;
    for (const std::size_t o : found->second)
      if (o != k && by[o]->norm() < by[k]->norm() && (mirrorPoint(o) - mirrorPoint(k)).norm() < kSamePoint * by[k]->norm())
        miss[k] = infinity;
  }
  return miss;
}

/// Gives every item to the nearest light whose mirror point it contains, and triangulates lights again from those that confirm
/// them.
void settle(const Items& items, const std::vector<TrackedFrame>& frames, std::vector<Group>& groups) {
  for (int round = 0; round < kVoteRounds; ++round) {
    std::vector<std::vector<double>> miss;
    for (const Group& g : groups) miss.push_back(containing(items.of(g), frames, g.light));
    std::vector<Members> next(groups.size());
    for (std::size_t k = 0; k < items.here.size(); ++k) {
      double least = 1;
      std::optional<std::size_t> nearest;
      for (std::size_t g = 0; g < groups.size(); ++g)
        if (miss[g][k] <= least) least = miss[g][k], nearest = g;
      if (nearest) next[*nearest].push_back(k);
    }
    bool same = true;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      same = same && next[g] == groups[g].members;
      groups[g].members = std::move(next[g]);
      const std::vector<Item>& own = items.of(groups[g]);
      const Members confirming = inliers(own, groups[g].members, groups[g].light, &Item::tight);
      if (framesOf(own, confirming) < 2) continue;
      if (const std::optional<Light> light = lightOf(own, confirming)) groups[g].light = *light;
    }
    if (same) return;
  }
}

/// A light that nobody has stated must appear beside others in most of its frames: frames in disagreement (a bad pose, a bad
/// normal) look like lights that are never on together.
bool provenBySight(const std::vector<Item>& items, const Group& group, const std::vector<Group>& others) {
  std::set<std::size_t> elsewhere, own;
  for (const Group& g : others)
    for (const std::size_t k : g.members) elsewhere.insert(items[k].frame);
  for (const std::size_t k : group.members) own.insert(items[k].frame);
  const auto shared = std::count_if(own.begin(), own.end(), [&](std::size_t f) { return elsewhere.count(f) > 0; });
  return shared >= 2 && 2 * static_cast<std::size_t>(shared) >= own.size();
}

Members unexplained(const Items& items, const std::vector<TrackedFrame>& frames, const std::vector<Group>& groups) {
  std::vector<char> explained(items.here.size(), 0);
  for (const Group& g : groups) {
    const std::vector<double> miss = containing(items.of(g), frames, g.light);
    for (std::size_t k = 0; k < explained.size(); ++k) explained[k] = explained[k] || miss[k] <= 1;
  }
  Members result;
  for (std::size_t k = 0; k < explained.size(); ++k)
    if (!explained[k]) result.push_back(k);
  return result;
}

/// Whether lights that nobody has stated are: each has enough frames, and those after the first `known` appear beside others.
bool proven(const std::vector<Item>& items, const std::vector<Group>& groups, std::size_t known) {
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (framesOf(items, groups[g].members) < kLeastFrames) return false;
    std::vector<Group> others = groups;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(g));
    if (g >= known && !provenBySight(items, groups[g], others)) return false;
  }
  return true;
}

/// Forms as many groups as there are lights; with `lights` 0 as many as the highlights prove. Lamps that are switched prove each
/// other: up to three are taken together.
std::vector<Group> findGroups(const Items& items, const std::vector<TrackedFrame>& frames, std::size_t lights,
                              const TrackOptions& options) {
  constexpr std::size_t kMostWaiting = 2;  // groups that wait for another one to prove them
  std::vector<Group> groups, all;          // all: with those that wait
  while (lights == 0 || groups.size() < lights) {
    const Members free = unexplained(items, frames, all);
    std::size_t least = std::max<std::size_t>(2, std::min(kLeastFrames, frames.size()));
    if (lights == 0 && !groups.empty()) least = std::max(kLeastFrames, (framesOf(items.here, free) + 1) / 2);
    const std::optional<Group> group = bestGroup(items, free, least, options);
    if (!group) break;
    all.push_back(*group);
    settle(items, frames, all);
    if (lights > 0 || groups.empty() || proven(items.here, all, groups.size()))
      groups = all;
    else if (all.size() - groups.size() > kMostWaiting)
      break;
  }
  return groups;
}

bool isStatedOn(const TrackedFrame& frame, const std::string& name) {
  return std::find(frame.lightsOn.begin(), frame.lightsOn.end(), name) != frame.lightsOn.end();
}

/// How well a name goes with a group: frames where it is on and seen, against frames where it is seen but off.
double agreement(const std::vector<TrackedFrame>& frames, const std::vector<Item>& items, const Group& group,
                 const std::string& name) {
  std::set<std::size_t> seen;
  double sum = 0;
  for (const std::size_t k : group.members) {
    seen.insert(items[k].frame);
    const std::string& given = frames[items[k].frame].highlights[items[k].highlight].light;
    if (!given.empty()) sum += given == name ? 2.0 : -2.0;
  }
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::vector<std::string>& on = frames[f].lightsOn;
    if (on.empty()) continue;
    const bool stated = isStatedOn(frames[f], name);
    if (seen.count(f))
      sum += stated ? 1 : -1;
    else if (stated)
      sum -= 1e-3;  // it may be hidden there
  }
  return sum;
}

/// Gives every group a different name, with the best agreement over all groups (greedily where there are too many orders to try).
std::vector<std::string> namesFor(const std::vector<TrackedFrame>& frames, const std::vector<Item>& items,
                                  const std::vector<Group>& groups, const std::set<std::string>& ids) {
  const std::vector<std::string> names(ids.begin(), ids.end());
  std::vector<std::vector<double>> score;
  for (const Group& g : groups) {
    score.emplace_back();
    for (const std::string& name : names) score.back().push_back(agreement(frames, items, g, name));
  }
  std::vector<std::size_t> order(names.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<std::string> result(groups.size());
  constexpr std::size_t kTryAll = 6;
  if (names.size() <= kTryAll) {
    std::vector<std::size_t> best = order;
    double most = -std::numeric_limits<double>::infinity();
    do {
      double sum = 0;
      for (std::size_t g = 0; g < groups.size(); ++g) sum += score[g][order[g]];
      if (sum > most) most = sum, best = order;
    } while (std::next_permutation(order.begin(), order.end()));
    for (std::size_t g = 0; g < groups.size(); ++g) result[g] = names[best[g]];
    return result;
  }
  std::vector<char> used(names.size(), 0);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::size_t best = names.size();
    for (std::size_t n = 0; n < names.size(); ++n)
      if (!used[n] && (best == names.size() || score[g][n] > score[g][best])) best = n;
    used[best] = 1;
    result[g] = names[best];
  }
  return result;
}

/// Whether a frame may show more than one light: as the frames state, or where they state nothing, as the highlights look.
bool mayBeSeveral(const std::vector<TrackedFrame>& frames, const std::set<std::string>& stated) {
  if (stated.empty())
    return std::count_if(frames.begin(), frames.end(), [](const TrackedFrame& f) { return f.highlights.size() > 1; }) >=
           static_cast<std::ptrdiff_t>(kLeastFrames);
  return std::any_of(frames.begin(), frames.end(),
                     [&](const TrackedFrame& f) { return f.lightsOn.size() > 1 || (f.lightsOn.empty() && stated.size() > 1); });
}

void nameAllOf(TrackedFrame& frame, const std::string& name) {
  for (Highlight& h : frame.highlights)
    if (h.light.empty()) h.light = name;
}

/// Names of lights that nobody stated.
std::vector<std::string> numberedNames(std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t g = 0; g < count; ++g) names.push_back(g == 0 ? "light" : "light-" + std::to_string(g + 1));
  return names;
}

/// Gives every highlight the name of its group, unless it also contains the mirror point of another light that has no
/// highlight of its own in that frame: it then shows both.
void nameMembers(std::vector<TrackedFrame>& frames, const Items& all, const std::vector<Group>& groups,
                 const std::vector<std::string>& names) {
  const std::vector<Item>& items = all.here;
  std::map<std::size_t, std::set<std::size_t>> shown;  // groups that have a highlight of their own in a frame
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const std::size_t k : groups[g].members) shown[items[k].frame].insert(g);
  const auto mayBeOn = [&](const TrackedFrame& frame, const std::string& name) {
    return frame.lightsOn.empty() || isStatedOn(frame, name);
  };
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const std::size_t k : groups[g].members) {
      TrackedFrame& frame = frames[items[k].frame];
      Highlight& h = frame.highlights[items[k].highlight];
      if (frame.lightsOn.size() == 1 || !h.light.empty() || !mayBeOn(frame, names[g])) continue;
      bool merged = false;
      for (std::size_t o = 0; o < groups.size() && !merged; ++o) {
        if (o == g || shown[items[k].frame].count(o) || !mayBeOn(frame, names[o])) continue;
        const std::optional<Pixel> by = toMirrorPoint(all.of(groups[o])[k], groups[o].light);
        merged = by && h.contour.points.size() >= 3 && contains(h.contour, h.peak + *by);
      }
      if (!merged) h.light = names[g];
    }
}

}  // namespace
int assignLights(std::vector<TrackedFrame>& frames, const std::function<std::shared_ptr<const Surface>(std::size_t)>& surfaceOf,
                 const TrackOptions& options) {
  require(options.inlierPx > 0 && options.maxPairs > 0, "assignLights: options");
  std::set<std::string> ids;
  for (const TrackedFrame& frame : frames) ids.insert(frame.lightsOn.begin(), frame.lightsOn.end());
  const bool stated = !ids.empty();
  if (!mayBeSeveral(frames, ids)) {
    for (TrackedFrame& frame : frames)
      nameAllOf(frame, !stated                      ? std::string("light")
                       : frame.lightsOn.size() == 1 ? frame.lightsOn.front()
                       : ids.size() == 1            ? *ids.begin()
                                                    : std::string());
    return 0;
  }

  // Frames with one light vote too: they give the others their names.
  Items items;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::shared_ptr<const Surface> surface = frames[f].highlights.empty() ? nullptr : surfaceOf(f);
    for (std::size_t i = 0; surface && i < frames[f].highlights.size(); ++i)
      if (const std::optional<Item> item = itemOf(frames[f], *surface, f, i, options.inlierPx)) {
        items.here.push_back(*item);
        if (frames[f].elsewhereFromHere) items.there.push_back(carriedItem(*item, *frames[f].elsewhereFromHere));
      }
  }
  const std::vector<Group> groups = findGroups(items, frames, ids.size(), options);
  if (!stated && groups.size() < 2) {
    for (TrackedFrame& frame : frames) nameAllOf(frame, "light");
    return 0;
  }
  nameMembers(frames, items, groups, stated ? namesFor(frames, items.here, groups, ids) : numberedNames(groups.size()));
  for (TrackedFrame& frame : frames)
    if (frame.lightsOn.size() == 1) nameAllOf(frame, frame.lightsOn.front());
  return static_cast<int>(groups.size());
}

}  // namespace glint

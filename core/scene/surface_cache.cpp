// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <future>
#include <list>
#include <map>
#include <mutex>

#include "core/base/number_text.h"
#include "core/scene/scene.h"
#include "core/surface/depth_filter.h"
#include "core/surface/depth_fusion.h"
#include "core/surface/depth_map.h"
#include "core/surface/posed_surface.h"

namespace glint {

namespace {

using SharedSurface = std::shared_ptr<const Surface>;

/// A text that is equal only for equal policies.
std::string textOf(const DepthPolicy& p) {
  return formatted("|%d %d %.17g %d %d %.17g %d", static_cast<int>(p.smoothing), static_cast<int>(p.normals), p.radius,
                   p.largestHolePx, p.fusedFrames, p.noise, p.seed);
}

}  // namespace

struct SurfaceCache::Impl {
  std::vector<Frame> frames;
  std::vector<int> firstThere;  // of each frame: the first one that shows the same surface in the same place
  std::map<std::string, SurfaceSource> sources;
  mutable std::mutex mutex;
  mutable std::map<std::string, std::shared_future<SurfaceTriangles>> triangles;       // by surface id, shared by the policies
  mutable std::map<std::string, std::shared_future<Outcome<SharedSurface>>> surfaces;  // by key and policy
  mutable std::map<std::string, SharedSurface> placed;  // of objects that move, by place and policy
  mutable std::list<std::string> recentDepthMaps;       // keys, the last used one first
  mutable std::map<std::string, FusedDepth> fused;      // by frame id, without the depth itself
  mutable Statistics statistics;

  const Frame& frame(int index) const {
    require(index >= 0 && index < static_cast<int>(frames.size()), "SurfaceCache: no such frame");
    return frames[static_cast<std::size_t>(index)];
  }

  /// The first caller loads, outside the lock; the others wait for its result (or its exception).
  template <class T, class Load>
  T once(std::map<std::string, std::shared_future<T>>& cache, const std::string& key, const Load& load) const {
    std::promise<T> promise;
    std::shared_future<T> future;
    bool mine = false;
    {
      const std::lock_guard<std::mutex> lock(mutex);
      const auto it = cache.find(key);
      mine = it == cache.end();
      future = mine ? cache.emplace(key, promise.get_future().share()).first->second : it->second;
    }
    if (mine) {
      try {
        promise.set_value(load());
      } catch (...) {
        promise.set_exception(std::current_exception());
      }
    }
    return future.get();
  }

  /// Marks a depth map as used and drops those used longest ago. A surface in use stays alive.
  void touch(const std::string& key) const {
    const std::lock_guard<std::mutex> lock(mutex);
    recentDepthMaps.remove(key);
    recentDepthMaps.push_front(key);
    while (static_cast<int>(recentDepthMaps.size()) > kDepthMapsKept) {
      surfaces.erase(recentDepthMaps.back());
      recentDepthMaps.pop_back();
    }
    statistics.depthMaps = static_cast<int>(recentDepthMaps.size());
    statistics.mostDepthMaps = std::max(statistics.mostDepthMaps, statistics.depthMaps);
  }

  /// The depth of a frame with that of the nearest other frames averaged in; frames whose depth cannot be read do not count.
  Image fusedWithOthers(const Frame& frame, const Image& depth, const DepthMapOptions& options) const {
    std::vector<std::pair<double, const Frame*>> near;
    for (const Frame& other : frames)
      if (other.id != frame.id && other.surface.empty() && !other.depth.empty())
        near.emplace_back((other.camera.centreInWorld() - frame.camera.centreInWorld()).norm(), &other);
    std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<DepthView> others;
    for (const auto& [distance, other] : near) {
      if (static_cast<int>(others.size()) == options.mesh.depth.fusedFrames) break;
      if (Outcome<std::optional<Image>> read = readDepth(*other, options.mesh.depth); read && *read) {
        Camera camera = other->camera;  // as it sees the object where this frame has it
        if (!standsStill(frame) || !standsStill(*other))
          camera.camFromWorld = camera.camFromWorld * other->worldFromObject * frame.worldFromObject.inverse();
        others.push_back({other->id, *std::move(*read), std::move(camera)});
      }
    }
    const double radius = options.mesh.depth.radius > 0 ? options.mesh.depth.radius : options.normalRadius * medianDepth(depth);
    FusedDepth result = fusedDepth(depth, frame.camera, others, radius);
    Image image = std::move(result.depth);
    result.depth = {};
    const std::lock_guard<std::mutex> lock(mutex);
    fused.insert_or_assign(frame.id, std::move(result));
    return image;
  }

  Outcome<SharedSurface> load(const Frame& frame, MeshPolicy policy) const {
    if (frame.surface.empty()) {
      Outcome<std::optional<Image>> depth = readDepth(frame, policy.depth);
      if (!depth) return depth.failure();
      if (!*depth) return Failure{Reason::NoSurface, "frame " + frame.id + " has neither a surface nor depth"};
      DepthMapOptions options;
      options.mesh = policy;
      if (policy.depth.fusedFrames > 0) **depth = fusedWithOthers(frame, **depth, options);
      return makeDepthMap(**depth, frame.camera, options);
    }
    const auto it = sources.find(frame.surface);
    if (it == sources.end()) return Failure{Reason::NoSurface, "surface '" + frame.surface + "' does not exist"};
    return it->second.load(
        policy, [&](const SurfaceSource& source) { return once(triangles, frame.surface, [&] { return source.triangles(); }); });
  }
};

SurfaceCache::SurfaceCache(const Scene& scene) : impl_(std::make_unique<Impl>()) {
  impl_->frames = scene.frames;
  impl_->sources = scene.surfaces;
  std::map<std::pair<std::string, std::vector<double>>, int> first;
  for (int f = 0; f < static_cast<int>(scene.frames.size()); ++f) {
    const Frame& frame = scene.frames[static_cast<std::size_t>(f)];
    const double* const pose = frame.worldFromObject.matrix().data();
    impl_->firstThere.push_back(first.try_emplace({frame.surface, {pose, pose + 16}}, f).first->second);
  }
}
SurfaceCache::SurfaceCache(const Scene& scene, const SurfaceCache& other) : SurfaceCache(scene) {
  const std::lock_guard<std::mutex> lock(other.impl_->mutex);
  const auto isSame = [&](const std::string& id) {
    const auto mine = impl_->sources.find(id), theirs = other.impl_->sources.find(id);
    return mine != impl_->sources.end() && theirs != other.impl_->sources.end() && mine->second.hasTrianglesOf(theirs->second);
  };
  for (const auto& [id, read] : other.impl_->triangles)
    if (isSame(id)) impl_->triangles.emplace(id, read);
  for (const auto& [key, surface] : other.impl_->surfaces)
    if (isSame(key.substr(0, key.rfind('|')))) impl_->surfaces.emplace(key, surface);
}
SurfaceCache::~SurfaceCache() = default;

std::string SurfaceCache::keyOf(int index) const {
  const Frame& frame = impl_->frame(index);
  return frame.surface.empty() ? "depth:" + frame.id : frame.surface;
}

std::string SurfaceCache::placedKeyOf(int index) const {
  const Frame& frame = impl_->frame(index);
  if (frame.surface.empty() || standsStill(frame)) return keyOf(index);
  return keyOf(index) + "@" + std::to_string(impl_->firstThere[static_cast<std::size_t>(index)]);
}

Outcome<std::shared_ptr<const Surface>> SurfaceCache::surfaceOf(int index, MeshPolicy policy) const {
  const Frame& frame = impl_->frame(index);
  std::string key =
      keyOf(index) + "|" + std::to_string(static_cast<int>(policy.normals)) + std::to_string(static_cast<int>(policy.rays));
  if (frame.surface.empty()) key += textOf(policy.depth);
  if (frame.surface.empty()) impl_->touch(key);
  Outcome<SharedSurface> surface = impl_->once(impl_->surfaces, key, [&] {
    {
      const std::lock_guard<std::mutex> lock(impl_->mutex);
      ++impl_->statistics.loads;
    }
    return impl_->load(frame, policy);
  });
  if (!surface || frame.surface.empty() || standsStill(frame)) return surface;
  // One object for each place: who remembers things by surface finds it again.
  const std::string place = placedKeyOf(index) + key.substr(key.find('|'));
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  SharedSurface& placed = impl_->placed[place];
  if (!placed) placed = movedTo(frame.worldFromObject, *std::move(surface));
  return placed;
}

std::string SurfaceCache::fusionRemark(const std::vector<int>& asked) const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  std::string names;
  int count = 0, alone = 0;
  double most = 0;
  for (const int index : asked) {
    const auto found = impl_->fused.find(impl_->frame(index).id);
    if (found == impl_->fused.end() || found->second.refused.empty()) continue;
    constexpr int kNamed = 6;  // as many as a person reads
    if (count++ < kNamed) names += (names.empty() ? "" : ", ") + found->first;
    alone += found->second.used.empty();
    most = std::max(most, found->second.disagreementM);
  }
  if (count == 0) return "";
  constexpr double kMillimetres = 1000;
  return formatted(
      "the depth of %d of %zu frames differs from that of frames nearby by up to %.3g mm (%s%s): the object moved or bent "
      "between them, or "
      "poses are wrong; such frames were left out of the fusion, and %d frames kept their own depth alone",
      count, asked.size(), kMillimetres * most, names.c_str(), count > 6 ? ", ..." : "", alone);
}

SurfaceCache::Statistics SurfaceCache::statistics() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->statistics;
}

}  // namespace glint

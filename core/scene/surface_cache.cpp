// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <future>
#include <list>
#include <map>
#include <mutex>

#include "core/scene/mesh_file.h"
#include "core/scene/scene.h"
#include "core/surface/analytic.h"
#include "core/surface/depth_map.h"
#include "core/surface/mesh.h"

namespace glint {

namespace {
using SharedSurface = std::shared_ptr<const Surface>;
}

struct SurfaceCache::Impl {
  std::vector<Frame> frames;
  std::map<std::string, SurfaceSource> sources;
  mutable std::mutex mutex;
  mutable std::map<std::string, std::shared_future<TriangleMesh>> meshes;              // by surface id, shared by the policies
  mutable std::map<std::string, std::shared_future<Outcome<SharedSurface>>> surfaces;  // by key and policy
  mutable std::list<std::string> recentDepthMaps;                                      // keys, the last used one first
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

  /// Marks a depth map as used and drops those used longest ago. Whoever holds a surface keeps it alive.
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

  Outcome<SharedSurface> load(const Frame& frame, MeshPolicy policy) const {
    if (frame.surface.empty()) {
      const Outcome<std::optional<Image>> depth = readDepth(frame);
      if (!depth) return depth.failure();
      if (!*depth) return Failure{Reason::NoSurface, "frame " + frame.id + " has neither a surface nor depth"};
      DepthMapOptions options;
      options.mesh = policy;
      return makeDepthMap(**depth, frame.camera, options);
    }
    const auto it = sources.find(frame.surface);
    if (it == sources.end()) return Failure{Reason::NoSurface, "surface '" + frame.surface + "' does not exist"};
    if (it->second.analytic) return makeAnalytic(*it->second.analytic);
    if (!it->second.mesh) return Failure{Reason::NoSurface, "surface '" + frame.surface + "' is neither a mesh nor analytic"};
    if (it->second.isCloud || it->second.points) {
      Outcome<PointSurface> made = readPointSurface(it->second);
      if (!made) return made.failure();
      return makeMesh(std::move(made->mesh), policy);
    }
    TriangleMesh mesh = once(meshes, frame.surface, [&] { return readMesh(it->second); });
    try {
      return makeMesh(std::move(mesh), policy);
    } catch (const std::invalid_argument& e) {
      throw InputError(it->second.mesh->string(), "", e.what());
    }
  }
};

SurfaceCache::SurfaceCache(const Scene& scene) : impl_(std::make_unique<Impl>()) {
  impl_->frames = scene.frames;
  impl_->sources = scene.surfaces;
}
SurfaceCache::SurfaceCache(const Scene& scene, const SurfaceCache& other) : SurfaceCache(scene) {
  const std::lock_guard<std::mutex> lock(other.impl_->mutex);
  const auto sameMesh = [&](const std::string& id) {
    const auto mine = impl_->sources.find(id), theirs = other.impl_->sources.find(id);
    return mine != impl_->sources.end() && theirs != other.impl_->sources.end() && mine->second.mesh &&
           mine->second.mesh == theirs->second.mesh && mine->second.metresPerUnit == theirs->second.metresPerUnit &&
           mine->second.isCloud == theirs->second.isCloud && mine->second.points == theirs->second.points;
  };
  for (const auto& [id, mesh] : other.impl_->meshes)
    if (sameMesh(id)) impl_->meshes.emplace(id, mesh);
  for (const auto& [key, surface] : other.impl_->surfaces)
    if (sameMesh(key.substr(0, key.rfind('|')))) impl_->surfaces.emplace(key, surface);
}
SurfaceCache::~SurfaceCache() = default;

std::string SurfaceCache::keyOf(int index) const {
  const Frame& frame = impl_->frame(index);
  return frame.surface.empty() ? "depth:" + frame.id : frame.surface;
}

Outcome<std::shared_ptr<const Surface>> SurfaceCache::surfaceOf(int index, MeshPolicy policy) const {
  const Frame& frame = impl_->frame(index);
  const std::string key =
      keyOf(index) + "|" + std::to_string(static_cast<int>(policy.normals)) + std::to_string(static_cast<int>(policy.rays));
  if (frame.surface.empty()) impl_->touch(key);
  return impl_->once(impl_->surfaces, key, [&] {
    {
      const std::lock_guard<std::mutex> lock(impl_->mutex);
      ++impl_->statistics.loads;
    }
    return impl_->load(frame, policy);
  });
}

SurfaceCache::Statistics SurfaceCache::statistics() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->statistics;
}

}  // namespace glint

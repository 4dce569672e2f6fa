// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "core/light/refine_depth.h"
#include "core/pipeline/training.h"
#include "core/scene/scene.h"

namespace glint {

/// A frame's own depth map with corrected depth. NoSurface if the frame has another surface or no depth; FrameUnreadable.
Outcome<std::shared_ptr<const Surface>> correctedDepthMap(const Frame& frame, MeshPolicy policy,
                                                          const DepthCorrection& correction);

/// The last few corrected surfaces. Thread-safe.
class CorrectedDepthMaps {
 public:
  /// @param key  of the correction.
  Outcome<std::shared_ptr<const Surface>> surfaceOf(const Frame& frame, MeshPolicy policy, const FitKey& key,
                                                    const DepthCorrection& correction);

 private:
  static constexpr std::size_t kKept = 2;  // as SurfaceCache::kDepthMapsKept
  std::mutex mutex_;
  std::list<std::pair<std::pair<FitKey, std::string>, std::shared_ptr<const Surface>>> recent_;  ///< by correction and frame
};

}  // namespace glint

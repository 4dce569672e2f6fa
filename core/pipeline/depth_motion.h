// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/pipeline/highlight_motion.h"

namespace glint {

/// Depth maps of frames that answer about each other's bright spots. Reads them when needed, keeps the last sixteen. Thread-safe.
class PanelDepths {
 public:
  PanelDepths(const Scene& scene, const Settings& settings);
  /// @param ideal  pixel
  /// @return  m along the axis, the median of 3 x 3 pixels; nothing if most of them have no depth, or the file is unreadable
  std::optional<double> at(int frame, const Pixel& ideal) const;
  /// The depth map of a frame has a point of the world: on the image, in front, and as far away to a fiftieth.
  bool has(int frame, const Eigen::Vector3d& point) const;

 private:
  std::shared_ptr<const Image> image(int frame) const;

  const Scene& scene_;
  DepthPolicy policy_;
  mutable std::mutex mutex_;
  mutable std::list<std::pair<int, std::shared_ptr<const Image>>> recent_;  // newest first; null = none or unreadable
};

/// motionVerdicts() of one frame; loads its surface only if it can matter. If that is the frame's own depth map, a view answers
/// about a spot only if its own depth map has the same point: then poses and depth agree that this part of the object did not
/// move. Names spots that no other depth map has (MotionVerdict::apart): the object bends or moves, or poses and depth disagree.
/// @param surface  of the frame; null = no verdicts
std::vector<MotionVerdict> judgedByMotion(const Scene& scene, int frame, const std::vector<int>& panel,
                                          const std::vector<FrameEvidence>& evidence,
                                          const std::function<std::shared_ptr<const Surface>()>& surface,
                                          const PanelDepths& depths, const Settings& settings);

}  // namespace glint

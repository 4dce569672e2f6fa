// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>

#include "core/pipeline/inspection.h"
#include "viz/layers.h"
#include "viz/walk_story.h"

namespace glint::test {

/// A hand-built inspection in closed form: a sphere at the origin, six cameras on an arc that look at it, one light. The
/// contours are circles of 14 px about the mirror point's pixel, model "canonical" predicts them 1 px larger, "dual"
/// refuses. It is consistent enough to be drawn; nothing was estimated.
/// @param scale   all lengths are multiplied by it (sphere radius 0.4 at 1).
/// @param folder  receives one photograph for all frames: red top left, green top right, blue bottom left, white bottom right.
std::shared_ptr<Inspection> smallInspection(const std::filesystem::path& folder, double scale = 1);

/// A folder that is removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// What layers show of it with frame 5 selected, which does not train.
viz::LayerInput heldOutInput(const Inspection& inspection);

/// A walk of three places on S and on T, in frame 0, above the ball.
viz::WalkStory shortWalk(const Inspection& inspection);

}  // namespace glint::test

// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/scene_scale.h"

#include <algorithm>
#include <limits>

#include "core/draw/on_surface.h"

namespace glint::draw {
namespace {

bool isFiniteRegion(const Eigen::AlignedBox3d& box) { return !box.isEmpty() && box.min().allFinite() && box.max().allFinite(); }

constexpr double kRoundOff = 1e-12;  ///< relative
constexpr double kLift = 7e-4;       ///< of the surface: less than a line is wide on a screen

/// Median distance from a camera to its nearest neighbour; infinity for one camera.
double typicalSpacing(const Inspection& inspection, const std::vector<int>& frames) {
  std::vector<double> nearest;
  const std::size_t step = std::max<std::size_t>(1, frames.size() / 200);  // quadratic: a sample is enough for a size
  for (std::size_t i = 0; i < frames.size(); i += step) {
    const Eigen::Vector3d a = inspection.scene->frames[static_cast<std::size_t>(frames[i])].camera.centreInWorld();
    double best = std::numeric_limits<double>::infinity();
    for (const int other : frames) {
      const double d = (inspection.scene->frames[static_cast<std::size_t>(other)].camera.centreInWorld() - a).norm();
      if (other != frames[i] && d > 0) best = std::min(best, d);
    }
    nearest.push_back(best);
  }
  if (nearest.empty()) return std::numeric_limits<double>::infinity();
  std::nth_element(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2), nearest.end());
  return nearest[nearest.size() / 2];
}

}  // namespace

SceneScale sceneScale(const Inspection& inspection, const Eigen::AlignedBox3d& surfaceBox, const std::vector<int>& frames,
                      double glyphScale) {
  SceneScale scale;
  scale.surfaceBox = surfaceBox;
  for (const int frame : frames)
    scale.sceneBox.extend(inspection.scene->frames[static_cast<std::size_t>(frame)].camera.centreInWorld());
  if (!isFiniteRegion(scale.surfaceBox)) {  // nothing seen: the cameras alone must do
    scale.surfaceBox = scale.sceneBox;
    for (const int frame : frames)
      scale.surfaceBox.extend(inspection.scene->frames[static_cast<std::size_t>(frame)].camera.ray({0, 0}).at(1));
  }
  if (!isFiniteRegion(scale.surfaceBox)) scale.surfaceBox = {Eigen::Vector3d::Constant(-0.5), Eigen::Vector3d::Constant(0.5)};
  scale.sceneBox.extend(scale.surfaceBox);
  // Relative to where the scene lies, so that its size is never lost in round-off.
  const double tiny =
      kRoundOff * std::max(kRoundOff, scale.sceneBox.min().cwiseAbs().cwiseMax(scale.sceneBox.max().cwiseAbs()).maxCoeff());
  scale.surfaceSize = std::max(scale.surfaceBox.diagonal().norm(), tiny);
  scale.sceneSize = std::max(scale.sceneBox.diagonal().norm(), scale.surfaceSize);
  const double spacing = typicalSpacing(inspection, frames);
  scale.cameraDepth = glyphScale * std::clamp(0.8 * spacing, 0.03 * scale.sceneSize, 0.10 * scale.sceneSize);
  scale.lift = kLift * scale.surfaceSize;
  scale.point = glyphScale * 0.006 * scale.surfaceSize;
  scale.arrow = glyphScale * 0.09 * scale.surfaceSize;
  return scale;
}

SceneScale sceneScale(const Inspection& inspection, const Surface* surface, const std::vector<int>& frames, double glyphScale) {
  return sceneScale(inspection, surface ? shownRegion(inspection, *surface, frames) : Eigen::AlignedBox3d(), frames, glyphScale);
}

}  // namespace glint::draw

// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/smoothed_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/number_text.h"
#include "core/pipeline/refined_normals.h"
#include "core/pipeline/training.h"
#include "core/surface/mesh.h"
#include "core/surface/mesh_policy.h"
#include "core/surface/posed_surface.h"
#include "core/surface/smooth_mesh.h"

namespace glint {
namespace {

constexpr double kExplainedPx = 0.1;        // contours on exact meshes leave 0.01 to 0.05 px
constexpr double kClearlyBetter = 0.7;      // what is left, over what the given mesh leaves: less gain may be chance
constexpr double kFirstEdges = 2.5;         // radius in edges: holds the dozen vertices that a quadric needs
constexpr double kLargestShare = 0.25;      // of the mesh's size: a quadric does not describe more of any object
constexpr double kLeastNormalNoise = 2e-4;  // rad, of a mesh that is worth smoothing: exact ones have 1e-5, scans some 1e-3
constexpr int kWorseInRow = 2;              // radii after which no better one is to be expected

/// What a light leaves of its contours, RMS over the views; infinite without a light.
double leftPx(const Outcome<LightEstimate>& light) {
  double sum = 0, count = 0;
  if (light)
    for (const double r : light->residualPx)
      if (std::isfinite(r)) sum += r * r, ++count;
  return count > 0 ? std::sqrt(sum / count) : std::numeric_limits<double>::infinity();
}

}  // namespace

std::string SmoothedMesh::remark() const {
  return formatted(
             "the mesh has noise of %.2g m (light.smooth_mesh): vertices and normals come from quadrics over %.2g m, which "
             "leaves noise of %.2g mrad in the normals; the light then explains the training contours to %.2g px",
             noise, radius, 1e3 * normalNoise, smoothPx) +
         (plainPx ? formatted(" instead of %.2g px", *plainPx) : std::string(", and not at all on the mesh as given"));
}

std::optional<SmoothedMesh> smoothedMesh(const std::vector<TrainingView>& views, const Outcome<LightEstimate>& plain,
                                         const std::string& surface, const Settings& settings) {
  if (settings.text("light.smooth_mesh") == "off" || meshPolicy(settings).normals == NormalPolicy::Facet) return std::nullopt;
  const double plainPx = leftPx(plain);
  if (plainPx < kExplainedPx || (!plain && plain.failure().reason == Reason::TooFewViews)) return std::nullopt;
  const auto one = std::find_if(views.begin(), views.end(), [](const TrainingView& v) { return v.seen && v.surface; });
  if (one == views.end()) return std::nullopt;
  const MeshSmoother smoother(objectOf(*one->surface).tessellate(Eigen::AlignedBox3d(), 0));
  if (!(smoother.spacing() > 0)) return std::nullopt;
  std::optional<SmoothedMesh> best;
  double least = std::numeric_limits<double>::infinity();
  int worse = 0;
  for (double radius = kFirstEdges * smoother.spacing(); radius < kLargestShare * smoother.size() && worse < kWorseInRow;
       radius *= std::sqrt(2)) {
    SmoothMesh smooth = smoother.at(radius);
    if (smooth.normalNoise < kLeastNormalNoise && !best) return std::nullopt;  // something else is wrong
    SmoothedMesh tried;
    tried.surface = surface;
    tried.radius = radius;
    tried.noise = smooth.noise;
    tried.normalNoise = smooth.normalNoise;
    tried.mesh = makeMesh(std::move(smooth.mesh), meshPolicy(settings));
    std::vector<TrainingView> there;
    for (const TrainingView& v : views)
      if (v.seen) there.push_back(seenAgain(v, v.camera, movedTo(poseOf(*v.surface), tried.mesh)));
    tried.smoothPx = leftPx(estimateLight(there, settings));
    if (tried.smoothPx < least) {
      least = tried.smoothPx;
      best = std::move(tried);
      worse = 0;
    } else if (std::isfinite(tried.smoothPx)) {
      ++worse;
    }
  }
  if (!best || !(best->smoothPx < kClearlyBetter * plainPx)) return std::nullopt;
  if (std::isfinite(plainPx)) best->plainPx = plainPx;
  return best;
}

}  // namespace glint

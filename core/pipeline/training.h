// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <optional>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/light/refine_depth.h"
#include "core/model/model.h"
#include "core/pipeline/frame_evidence.h"
#include "core/surface/surface.h"

namespace glint {

/// Whose estimate, fit or correction it is: that of a light, on one surface alone where every surface has its own models
/// (TrainSpec::perSurface).
struct FitKey {
  std::string light;                        ///< id
  std::optional<std::string> surface = {};  ///< SurfaceCache::keyOf(); none: of all surfaces together
  friend auto operator<=>(const FitKey&, const FitKey&) = default;
};

/// "lamp", or "lamp@g03": for people, and in the names of key results.
inline std::string textOf(const FitKey& key) { return key.surface ? key.light + "@" + *key.surface : key.light; }

/// Evidence of one training highlight with what the geometry adds: observed brightest point, tangent plane, virtual
/// camera (method.md sections 3 and 5). `failure` is set where the peak misses the surface or the frame has none.
TrainingView trainingView(const FrameEvidence& evidence, int highlight, const Camera& camera,
                          std::shared_ptr<const Surface> surface, CutUse cut = CutUse::None);

/// The highlight of a view as another camera or surface would have it. Pixels and contours at other levels are not carried over.
TrainingView seenAgain(const TrainingView& view, const Camera& camera, std::shared_ptr<const Surface> surface);

/// The light of some views of one light (method.md section 4): the known one, where all views have the same; else triangulated,
/// then bundled when `light.solver` says so.
/// TooFewViews; LightBehindSurface; what the bundle reports. A bundle that fails falls back to nothing: its reason is returned.
Outcome<LightEstimate> estimateLight(const std::vector<TrainingView>& views, const Settings& settings);

/// What the bundle takes of a view that was seen: its contour, or about that many points of what the image's border leaves of it.
BundleView bundleView(const TrainingView& view, int points);

/// Depth correction of some views of one light whose surfaces are their own frames' depth maps (light.refine_depth). The bundle's
/// failures; NotSupported unless `light.solver` is bundle.
Outcome<DepthRefinement> refineDepth(const std::vector<TrainingView>& views, const Light& start, const Settings& settings);

/// Fills `canonical` of a view (method.md section 6). Views with `failure` stay as they are, and so do those of cut highlights.
void addCanonicalContour(TrainingView& view, const Light& light, const Settings& settings);

}  // namespace glint

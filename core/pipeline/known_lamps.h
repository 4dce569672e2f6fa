// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/model/model.h"
#include "core/pipeline/frame_evidence.h"
#include "core/scene/scene.h"

namespace glint {

// Lamps that the scene states as known (lights[].known; method.md section 16). Fits keep them, and all known lamps of one kind
// share one material. Each view is carried into coordinates in which its lamp stands where another one does: there, photographs
// under many known lamps are photographs under one lamp of a camera and an object that move together.

/// The lamp that the scene states as known under this id; nothing where it states none.
std::optional<KnownLamp> knownLamp(const Scene& scene, const std::string& light);
/// Whether the scene states all lamps that may be on in a frame.
bool knowsAllLamps(const Scene& scene, const Frame& frame);

/// Lamps of one shape that are both at a place, or both at infinity: only these can be carried into each other.
bool shareMaterial(const KnownLamp& a, const KnownLamp& b);

/// By how much a highlight's peak lies off the place where a lamp mirrors, as the angle between its normal and the half vector,
/// rad. @param point  of the peak, normal on the camera's side
double halfAngleAt(const SurfacePoint& point, const Camera& camera, const Lamp& lamp);

/// A view of a known lamp as a view of another one: camera and surface are carried along with the lamp, by a shift for a lamp at
/// a place, by a turn about `pivot` for one at infinity.
/// @param pivot  a point near the surface, world, m
TrainingView carriedTo(const TrainingView& view, const KnownLamp& lamp, const Eigen::Vector3d& pivot);
/// Those of the views whose lamps share the material of a known one, as views of that one, in order of frames and lights. Where
/// there are more than two, those that contradict their lamp by more than the contours reach get a failure.
std::vector<TrainingView> pooledViews(const std::vector<TrainingView>& views, const KnownLamp& lamp);

/// A fit to pooled views as that of one of their lamps: frames and residuals are those of its own views, which it must explain.
/// @param pooled     what was fitted to
/// @param mostShare  fit.most_residual
Outcome<ModelFit> fitOfKnownLamp(ModelFit fit, const std::string& light, const KnownLamp& lamp,
                                 const std::vector<TrainingView>& pooled, double mostShare);
/// The same fit with the lamp's stated uncertainty in place of its own; nothing where none is stated.
std::optional<ModelFit> movedAsStated(const ModelFit& fit, const KnownLamp& lamp);

/// Highlights that lie further from where a known lamp mirrors than the contours reach: the lamp, its name or its place may be
/// wrong. "" without such highlights.
/// @param views  of that lamp
std::string knownLampDoubt(const std::vector<TrainingView>& views, const LightEstimate& light);

/// Names highlights by the known lamp whose mirror direction at their peak is nearest, in frames where every lamp is known and
/// several may be on. Those that no lamp mirrors keep no light. @return whether there is such a frame
bool assignKnownLamps(const Scene& scene, std::vector<FrameEvidence>& evidence,
                      const std::function<std::shared_ptr<const Surface>(int frame)>& surfaceOf);

}  // namespace glint

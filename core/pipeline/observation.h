// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/pipeline/inspection.h"

namespace glint {

/// What one frame shows under a request, without any consequences: known long before lights and models, so that
/// the contour follows while the user drags a threshold or a lamp.
struct Observation {
  std::shared_ptr<const Scene> scene;  ///< with the request's what-if; of synthesised contours only this frame's
  std::shared_ptr<const Scene> given;  ///< as it was read
  InspectionRequest request;
  int frame = -1;
  FrameEvidence evidence;
  StageInputs inputs;  ///< of the evidence alone
};

/// Nothing if `known` holds this frame's evidence already, or if lights can only be told from all frames. InputError for
/// wrong requests, as inspect(); Stopped.
std::optional<Observation> observeFrame(std::shared_ptr<const Scene> scene, const InspectionRequest& request, int frame,
                                        const ProgressFn& progress = {}, const Inspection* known = nullptr);

/// What earlier results say about the frame, beside a newer observation of it: their fits and predictions, and the new evidence.
/// The two are not compared (no rows): an error between them would belong to a state that never existed. Only this
/// frame's, as ModelResult says (`oneFrame`).
/// @param earlier  of the same scene as read
Inspection besideObservation(const Inspection& earlier, const Observation& observation);

}  // namespace glint

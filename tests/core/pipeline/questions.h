// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/pipeline/lobe_stage.h"
#include "core/pipeline/pipeline.h"

namespace glint::testing_support {

inline std::vector<const Inspection*> knownOf(const Inspection* previous) {
  return previous ? std::vector<const Inspection*>{previous} : std::vector<const Inspection*>{};
}

/// Question::Part::Frame, with one earlier answer.
inline Inspection inspectOneFrame(const std::shared_ptr<const Scene>& scene, const InspectionRequest& request, int frame,
                                  const ProgressFn& progress = {}, const Inspection* previous = nullptr) {
  return answer(scene, {request, Question::Part::Frame, frame}, progress, knownOf(previous));
}

/// Question::Part::FirstLook, with one earlier answer; nothing where it is not worth a step.
inline std::optional<Inspection> firstLook(const std::shared_ptr<const Scene>& scene, const InspectionRequest& request, int frame,
                                           const ProgressFn& progress = {}, const Inspection* previous = nullptr) {
  if (!worthALook(*scene, request, knownOf(previous))) return std::nullopt;
  return answer(scene, {request, Question::Part::FirstLook, frame}, progress, knownOf(previous));
}

}  // namespace glint::testing_support

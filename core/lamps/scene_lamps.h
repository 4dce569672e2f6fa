// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/inspect/inspection.h"
#include "core/lamps/lamp_answer.h"

namespace glint {

/// Where the lights of a scene are, from the highlights of its frames. The true lights that the scene may hold are not read.
///
/// For each light: drops by name views whose mirrored rays contradict others (least median of the angles over pairs of rays). The
/// rest goes through the fit of `evaluate`, the reflectance model of pixels or contours, which knows that a rough surface is not
/// brightest where it mirrors the light. If that fails, through the contours' bundle; else the mean of the mirrored rays gives a
/// direction. A position is given if the inverse distance is five standard deviations from 0, seen from the middle of the object.
/// @param inspection  of inspect() without models: evidence and views of all frames that count
/// @return  one answer for each light that a frame names or shows, in the order of the frames; `id` is the light's. World, m.
///          Failures of single lamps: NoHighlight, PeakOffSurface and what else became of its views. Throws Stopped.
std::vector<LampAnswer> lampsOfScene(const Inspection& inspection, const ProgressFn& progress = {});

}  // namespace glint

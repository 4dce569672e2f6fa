// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/progress.h"
#include "core/scene/convention_report.h"
#include "core/scene/scene.h"

namespace glint {

/// Where the sparse points put a mesh through which most of them do not pass: adds to their finding, or makes one where another place explains
/// them. Not where a correction of the unit or place of the mesh is known already. InputError, Stopped.
void placeMesh(const Scene& scene, const ProgressFn& progress, ConventionReport& report);

}  // namespace glint

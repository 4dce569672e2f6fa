// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/progress.h"
#include "core/scene/convention_report.h"
#include "core/scene/scene.h"

namespace glint {

/// Checks up to eight frames with whole, unclipped highlights against the surface: whether their mirrored rays share a lamp
/// (sharedLamp), and whether a light explains the contours (`reflectance`). If not, undoes likely mistakes one by one, and tries
/// those that make the rays meet on the contours. Names a mistake if undoing it explains the contours several times better; no
/// such mistake is a finding, too. Names a principal point or focal length if both halves of the frames ask for the same change.
/// Never names what highlights cannot tell (a shift that another light explains). Stopped; InputError (unreadable surface).
CameraCheck checkCameras(const Scene& scene, const ProgressFn& progress = {});

/// The convention report. Adds this check if most cameras see their surface or it finds why not, and a misplaced mesh's place.
ConventionReport fullReport(const Scene& scene, const ProgressFn& progress = {});

}  // namespace glint

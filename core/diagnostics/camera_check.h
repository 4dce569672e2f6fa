// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/progress.h"
#include "core/scene/convention_report.h"
#include "core/scene/scene.h"

namespace glint {

/// Fits the light of up to eight frames that show one whole, unclipped highlight on a surface that the scene names, under each
/// hypothesis, by their contours (`reflectance`), and compares residuals. Says something only where one hypothesis explains the
/// contours several times better than the scene as given, the two halves of the frames ask for the same change, and that change
/// is the one of the hypothesis. What the highlights cannot tell (a shift that another place of the light explains as well) stays
/// unsaid. Takes a second or two. Throws Stopped, and InputError where a surface cannot be read.
CameraCheck checkCameras(const Scene& scene, const ProgressFn& progress = {});

/// The convention report, and this check in it where every camera sees its surface: no other scene has highlights that can be asked
/// about the cameras.
ConventionReport fullReport(const Scene& scene, const ProgressFn& progress = {});

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/progress.h"
#include "core/scene/convention_report.h"
#include "core/scene/scene.h"

namespace glint {

/// Holds up to eight frames with whole, unclipped highlights against the surface that the scene names: whether their mirrored rays share a lamp
/// (sharedLamp), and whether a light explains the contours (`reflectance`). Where that is not so, likely mistakes are undone one by one; those after
/// which mirrored rays meet are tried on the contours. A mistake is named where its undoing explains them several times better than the scene as
/// given; that nothing does is a finding, too. A principal point or focal length is named where the two halves of the frames ask for the same
/// change. What the highlights cannot tell (a shift that another place of the light explains as well) stays unsaid. Throws Stopped, and InputError where a surface cannot be read.
CameraCheck checkCameras(const Scene& scene, const ProgressFn& progress = {});

/// The convention report, with this check where most cameras see their surface or where it finds why they do not, and the place of a mesh that misses the sparse points.
ConventionReport fullReport(const Scene& scene, const ProgressFn& progress = {});

}  // namespace glint

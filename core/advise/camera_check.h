// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/light/estimate.h"
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

/// Walks down a smooth function of three numbers, even in a narrow oblique valley: the minimum of the quadric through ten
/// values, up to four times. At most 60 values. Avoids places without a `cost`. @param step  between values, in units of `at`
/// @return the place of the least value that was met; `at` where it has none
Eigen::Vector3d lowestPlace(const Eigen::Vector3d& at, double step,
                            const std::function<std::optional<double>(const Eigen::Vector3d&)>& cost);

}  // namespace glint

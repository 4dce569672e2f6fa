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

/// A lamp that most views have in common, by the mirrored rays of their highlights alone: no shape of a highlight has a say.
struct SharedLamp {
  Light light;
  std::vector<int> chosen;     ///< of each view, the ray that passes the lamp best; -1 if the view has none
  std::vector<double> misses;  ///< of each view, rad: by which that ray passes the lamp; pi without a ray
  double miss = 0;             ///< largest one of the best three quarters of the views
};

/// The lamp that rays pass most closely, sought among the places where two rays of different views come nearest to each other,
/// and the directions of single rays. A view may show other lamps, too, or a highlight twice.
/// @param views  the mirrored rays of each view's highlights; a view may have none
/// @return nothing if fewer than two views have a ray
std::optional<SharedLamp> sharedLamp(const std::vector<std::vector<ReflectedRay>>& views);

/// Walks down a smooth function of three numbers, even in a narrow oblique valley: the minimum of the quadric through ten
/// values, up to four times. At most 60 values. Avoids places without a `cost`. @param step  between values, in units of `at`
/// @return the place of the least value that was met; `at` where it has none
Eigen::Vector3d lowestPlace(const Eigen::Vector3d& at, double step,
                            const std::function<std::optional<double>(const Eigen::Vector3d&)>& cost);

}  // namespace glint

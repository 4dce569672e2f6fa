// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace glint {

/// Walks down a smooth function of three numbers, even in a narrow oblique valley: the minimum of the quadric through ten
/// values, up to four times. At most 60 values. Avoids places without a `cost`. @param step  between values, in units of `at`
/// @return the place of the least value that was met; `at` where it has none
Eigen::Vector3d lowestPlace(const Eigen::Vector3d& at, double step,
                            const std::function<std::optional<double>(const Eigen::Vector3d&)>& cost);

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "core/surface/surface.h"

namespace glint {

/// The same surface at another place (method.md section 16): the object is held as it is, and every question is carried to it. A
/// mesh is not copied, and its trees, normals and rays are those of the unmoved one. The object itself at the identity.
/// @param surface          at any place: it may be what movedTo() returned
/// @param worldFromObject  rigid. std::invalid_argument unless it is finite.
std::shared_ptr<const Surface> movedTo(const Eigen::Isometry3d& worldFromObject, std::shared_ptr<const Surface> surface);

/// The unmoved surface, and where it is now. A surface that nobody moved is itself, at the identity.
const Surface& objectOf(const Surface& surface);
Eigen::Isometry3d poseOf(const Surface& surface);

}  // namespace glint

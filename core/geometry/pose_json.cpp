// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/pose_json.h"

#include "core/base/bounded_json.h"
#include "core/geometry/typed_pose.h"

namespace glint {

Eigen::Isometry3d readPoseJson(const JsonNode& node, std::string* warning) {
  const Eigen::Matrix4d m = node.matrix4();
  for (std::size_t i = 0; i < 3; ++i) bounded(node.at(i).at(3), kFarthest);
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) node.fail("must be rigid: the last row must be 0 0 0 1");
  const TypedPose typed = typedPose(m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>());
  if (typed.rotation == TypedRotation::NotARotation) node.fail("must be rigid: the 3x3 block is not a rotation");
  if (typed.rotation == TypedRotation::Mirrored) node.fail("must be rigid: the 3x3 block is mirrored (determinant -1)");
  if (warning && typed.rotation == TypedRotation::Repaired)
    *warning = node.place() + ": not exactly a rotation, replaced by the nearest one";
  return typed.pose;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "viz/view_motion.h"

#include <Eigen/Geometry>

namespace glint::viz {

ViewPoint zoomedAbout(const ViewPoint& view, const Eigen::Vector3d& point, double factor) {
  ViewPoint moved = view;
  moved.position = point + (view.position - point) / factor;
  moved.focalPoint = point + (view.focalPoint - point) / factor;
  return moved;
}

ViewPoint turnedAbout(const ViewPoint& view, const Eigen::Vector3d& point, double sideways, double upwards) {
  const Eigen::Vector3d back = (view.position - view.focalPoint).normalized();
  const Eigen::Vector3d right = view.up.cross(back).normalized(), up = back.cross(right);
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(-sideways, up) * Eigen::AngleAxisd(upwards, right)).toRotationMatrix();
  ViewPoint turned = view;
  turned.position = point + turn * (view.position - point);
  turned.focalPoint = point + turn * (view.focalPoint - point);
  turned.up = turn * up;
  return turned;
}

}  // namespace glint::viz

// SPDX-License-Identifier: BSD-3-Clause
#include "viz/view_camera.h"

#include <vtkCamera.h>
#include <vtkMatrixToHomogeneousTransform.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "viz/convert.h"

namespace glint::viz {
namespace {

/// A transform of the camera's clip coordinates. VTK applies it after its projection.
void setUserTransform(vtkCamera* vtk, const Eigen::Matrix4d& clip) {
  vtkNew<vtkMatrixToHomogeneousTransform> transform;
  transform->SetInput(toVtk(clip));
  vtk->SetUserTransform(transform);
}

/// Clip coordinates of the part from those of the whole picture.
Eigen::Matrix4d partFromWhole(const PictureArea& area) {
  const double share = static_cast<double>(area.right - area.left) / area.width;
  const double centre = static_cast<double>(area.right + area.left) / area.width - 1;
  Eigen::Matrix4d clip = Eigen::Matrix4d::Identity();
  clip(0, 0) = 1 / share;
  clip(0, 3) = -centre / share;
  return clip;
}

}  // namespace

PhotographPlacement placePhotograph(const Camera& camera, const PictureArea& area, double zoom, const Eigen::Vector2d& shift) {
  PhotographPlacement p;
  p.scale = zoom * std::min(static_cast<double>(area.width) / camera.width, static_cast<double>(area.height) / camera.height);
  p.topLeft = Eigen::Vector2d(0.5 * (area.width - p.scale * camera.width), 0.5 * (area.height + p.scale * camera.height)) + shift;
  return p;
}

void standAt(vtkCamera* vtk, const Camera& camera, const std::optional<Plane>& mirror, const PhotographPlacement& placement,
             const PictureArea& area, double focalDistance) {
  // P M = K R (I - 2 n n^T) [I | -C'], C' the mirrored centre. The block R (I - 2 n n^T) is left-handed: VTK gets it with x
  // negated, and the user transform negates x back.
  Eigen::Matrix3d axes = camera.camFromWorld.linear();
  Eigen::Vector3d eye = camera.centreInWorld();
  double side = 1;
  if (mirror) {
    axes = axes * (Eigen::Matrix3d::Identity() - 2 * mirror->normal * mirror->normal.transpose());
    axes.row(0) *= -1;
    eye = mirror->reflected(eye);
    side = -1;
  }
  const Eigen::Vector3d focal = eye + focalDistance * axes.row(2).transpose(), up = -axes.row(1).transpose();
  const double angle = 2 * std::atan(0.5 * camera.height / camera.pixelFromRay(1, 1));
  vtk->SetParallelProjection(0);
  vtk->SetPosition(eye.x(), eye.y(), eye.z());
  vtk->SetFocalPoint(focal.x(), focal.y(), focal.z());
  vtk->SetViewUp(up.x(), up.y(), up.z());
  vtk->SetViewAngle(angle * 180 / std::numbers::pi);

  // VTK's clip coordinates are (X / (t a), Y / t, ., depth) with t the tangent of half the angle and a the part's width / height.
  const double t = std::tan(angle / 2), a = static_cast<double>(area.right - area.left) / area.height;
  const Eigen::Matrix3d& k = camera.pixelFromRay;
  const double sx = 2 * placement.scale / area.width, sy = 2 * placement.scale / area.height;
  Eigen::Matrix4d whole = Eigen::Matrix4d::Identity();
  whole(0, 0) = side * sx * k(0, 0) * t * a;
  whole(0, 1) = -sx * k(0, 1) * t;  // Y is up, the camera's y is down
  whole(0, 3) = 2 * placement.topLeft.x() / area.width - 1 + sx * (k(0, 2) + 0.5);
  whole(1, 1) = sy * k(1, 1) * t;
  whole(1, 3) = 2 * placement.topLeft.y() / area.height - 1 - sy * (k(1, 2) + 0.5);
  setUserTransform(vtk, partFromWhole(area) * whole);
}

void standFree(vtkCamera* vtk, const PictureArea& area) {
  if (area.left == 0 && area.right == area.width) {
    vtk->SetUserTransform(nullptr);
    return;
  }
  // VTK's projection knows the part's shape already: only the shift is left.
  const double share = static_cast<double>(area.right - area.left) / area.width;
  Eigen::Matrix4d clip = partFromWhole(area);
  clip(0, 0) *= share;
  setUserTransform(vtk, clip);
}

void setViewPoint(vtkCamera* camera, const ViewPoint& view) {
  camera->SetUserTransform(nullptr);
  camera->SetParallelProjection(view.parallel);
  camera->SetPosition(view.position.x(), view.position.y(), view.position.z());
  camera->SetFocalPoint(view.focalPoint.x(), view.focalPoint.y(), view.focalPoint.z());
  camera->SetViewUp(view.up.x(), view.up.y(), view.up.z());
  camera->SetViewAngle(view.viewAngleDeg);
  camera->SetParallelScale((view.position - view.focalPoint).norm() * std::tan(view.viewAngleDeg * std::numbers::pi / 360));
  camera->OrthogonalizeViewUp();
}

ViewPoint viewPointOf(vtkCamera* camera) {
  ViewPoint view{toEigen(camera->GetPosition()), toEigen(camera->GetFocalPoint()), toEigen(camera->GetViewUp()),
                 camera->GetViewAngle(), camera->GetParallelProjection() != 0};
  if (view.parallel) {
    const double depth = camera->GetParallelScale() / std::tan(view.viewAngleDeg * std::numbers::pi / 360);
    view.position = view.focalPoint - depth * toEigen(camera->GetDirectionOfProjection());
  }
  return view;
}

Eigen::Affine3d nearer(vtkCamera* vtk, double px, int heightPx) {
  if (vtk->GetParallelProjection())
    return Eigen::Affine3d(
        Eigen::Translation3d(-2 * vtk->GetParallelScale() / heightPx * px * toEigen(vtk->GetDirectionOfProjection())));
  constexpr double kMost = 0.2;  // of the distance: in the smallest of pictures
  // Through a camera the picture is enlarged after VTK's own projection, see standAt().
  if (vtkHomogeneousTransform* user = vtk->GetUserTransform()) px /= std::abs(user->GetMatrix()->GetElement(1, 1));
  const double share = std::min(kMost, 2 * std::tan(vtk->GetViewAngle() * std::numbers::pi / 360) / heightPx * px);
  const Eigen::Vector3d eye = toEigen(vtk->GetPosition());
  return Eigen::Translation3d(share * eye) * Eigen::Scaling(1 - share);
}

namespace {
/// Columns right, up, back of a view's picture.
Eigen::Matrix3d axesOf(const ViewPoint& view) {
  const Eigen::Vector3d back = (view.position - view.focalPoint).normalized();
  const Eigen::Vector3d right = view.up.cross(back).normalized();
  Eigen::Matrix3d axes;
  axes << right, back.cross(right), back;
  return axes;
}
}  // namespace

ViewPoint between(const ViewPoint& from, const ViewPoint& to, double t) {
  if (!(t > 0)) return from;
  if (!(t < 1)) return to;
  const Eigen::Matrix3d a = axesOf(from), b = axesOf(to);
  const double near = (from.position - from.focalPoint).norm(), far = (to.position - to.focalPoint).norm();
  // The determinant of axes is 1; 0 where a view looks along its own upwards.
  if (!(a.determinant() > 0.5 && b.determinant() > 0.5 && near > 0 && far > 0)) return to;
  const Eigen::Matrix3d axes = Eigen::Quaterniond(a).slerp(t, Eigen::Quaterniond(b)).toRotationMatrix();
  ViewPoint view = to;
  view.focalPoint = (1 - t) * from.focalPoint + t * to.focalPoint;
  view.position = view.focalPoint + near * std::pow(far / near, t) * axes.col(2);
  view.up = axes.col(1);
  view.viewAngleDeg = (1 - t) * from.viewAngleDeg + t * to.viewAngleDeg;
  return view;
}

Margins marginsBeside(const Eigen::Vector2d& legendPx, double barPx, const PictureArea& whole) {
  Margins margins;
  const double beside = std::min(margins.left, 1 - 2 * legendPx.x() / whole.width),
               below = std::min(margins.top, 1 - 2 * legendPx.y() / whole.height);
  constexpr double kMost = -0.6;  // beside a legend that takes more, what is looked at would be a dot
  if (whole.width > 1 && whole.height > 1) (beside >= below ? margins.left : margins.top) = std::max({beside, below, kMost});
  if (barPx > 0) margins.bottom = std::clamp(1 - 2 * barPx / whole.height, 0.3, margins.bottom);
  return margins;
}

ViewPoint fitted(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& back, const Eigen::Vector3d& up,
                 double aspect, const Margins& margins, bool parallel, const Eigen::Vector3d& reference, double leastDepth) {
  constexpr double kFieldOfView = 30 * std::numbers::pi / 180;
  const Eigen::Vector3d right = up.cross(back);
  const double half = std::tan(kFieldOfView / 2);
  const double l = margins.left * half * aspect, r = margins.right * half * aspect, t = margins.top * half,
               b = margins.bottom * half;
  double x = 0, y = 0, z = 0;
  if (parallel) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : points) box.extend(Eigen::Vector3d(right.dot(p), up.dot(p), back.dot(p)));
    const double depth = std::max({box.sizes().x() / (l + r), box.sizes().y() / (t + b), leastDepth});
    x = box.center().x() - 0.5 * depth * (r - l);
    y = box.center().y() - 0.5 * depth * (t - b);
    z = back.dot(reference) + depth;
  } else {
    // Each side of the view pyramid is a plane through the eye; the eye is fixed by the four that touch the points.
    double rightMost = -1e300, leftMost = -1e300, topMost = -1e300, bottomMost = -1e300;
    for (const Eigen::Vector3d& p : points) {
      const double px = right.dot(p), py = up.dot(p), pz = back.dot(p);
      rightMost = std::max(rightMost, px / r + pz);
      leftMost = std::max(leftMost, -px / l + pz);
      topMost = std::max(topMost, py / t + pz);
      bottomMost = std::max(bottomMost, -py / b + pz);
    }
    x = (rightMost - leftMost) / (1 / r + 1 / l);
    y = (topMost - bottomMost) / (1 / t + 1 / b);
    z = std::max(rightMost - x / r, topMost - y / t);
  }
  const Eigen::Vector3d eye = x * right + y * up + z * back;
  const double depth = std::max(back.dot(eye - reference), leastDepth);
  return {eye, eye - depth * back, up, 30, parallel};
}

Eigen::Vector3d worldAt(vtkRenderer* renderer, double xDisplay, double yDisplay, const Eigen::Vector3d& anchor) {
  renderer->SetWorldPoint(anchor.x(), anchor.y(), anchor.z(), 1);
  renderer->WorldToDisplay();
  renderer->SetDisplayPoint(xDisplay, yDisplay, renderer->GetDisplayPoint()[2]);
  renderer->DisplayToWorld();
  const Eigen::Map<const Eigen::Vector4d> h(renderer->GetWorldPoint());
  return h.hnormalized();
}

AxisDirections axisDirections(AxisView view, const Eigen::Vector3d& up) {
  const Eigen::Vector3d front = std::abs(up.z()) > 0.5 ? -Eigen::Vector3d::UnitY().eval() : Eigen::Vector3d::UnitZ().eval();
  const Eigen::Vector3d right = up.cross(front);
  switch (view) {
    case AxisView::Front: return {front, up};
    case AxisView::Back: return {-front, up};
    case AxisView::Left: return {-right, up};
    case AxisView::Right: return {right, up};
    case AxisView::Top: return {up, -front};
    case AxisView::Bottom: return {-up, front};
  }
  return {front, up};
}

}  // namespace glint::viz

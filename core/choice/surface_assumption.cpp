// SPDX-License-Identifier: BSD-3-Clause
#include "core/choice/surface_assumption.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/geometry/plane.h"

namespace glint {
namespace {

constexpr int kPoints = 16, kFewest = 6;  // of a contour

/// The surface under one highlight.
struct Patch {
  Eigen::Vector3d position, normal;      // means
  double radius = 0, psi = 0, turn = 0;  // m; rad; rad by which the normal turns from the middle to the contour
  Eigen::Vector2d curvature{0, 0};       // 1/m, ascending
  double distance = 0;                   // of the camera, m
};

bool patchOf(const HighlightOnSurface& h, Patch& patch) {
  if (!h.surface || h.contour.points.size() < 3) return false;
  const Eigen::Vector3d eye = h.camera.centreInWorld();
  std::vector<SurfacePoint> points;
  for (const Pixel& p : resample(h.contour, kPoints))
    if (const Outcome<SurfacePoint> hit = h.surface->firstHit(h.camera.ray(p))) points.push_back(facing(*hit, eye));
  if (points.size() < kFewest) return false;
  const double n = static_cast<double>(points.size());
  patch.position = patch.normal = Eigen::Vector3d::Zero();
  for (const SurfacePoint& p : points) patch.position += p.position / n, patch.normal += p.normal / n;
  patch.normal.normalize();
  patch.distance = (eye - patch.position).norm();
  const Eigen::Matrix<double, 3, 2> basis = tangentBasis(patch.normal);
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero(), cross = square;
  const Eigen::Vector3d middle = (patch.position - eye).normalized();
  for (const SurfacePoint& p : points) {
    const Eigen::Vector2d x = basis.transpose() * (p.position - patch.position);
    square += x * x.transpose();
    cross += basis.transpose() * p.normal * x.transpose();
    patch.radius += x.norm() / n;
    const Eigen::Vector3d v = (p.position - eye).normalized();
    patch.psi += std::atan2(v.cross(middle).norm(), v.dot(middle)) / n;
  }
  if (!(square.determinant() > 0) || !(patch.psi > 0)) return false;
  const Eigen::Matrix2d slope = cross * square.inverse();  // d normal / d position: the shape operator
  double turned = 0;
  for (const SurfacePoint& p : points) turned += (slope * basis.transpose() * (p.position - patch.position)).norm() / n;
  patch.turn = turned;
  patch.curvature =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>((slope + slope.transpose()) / 2, Eigen::EigenvaluesOnly).eigenvalues();
  return true;
}

}  // namespace

SurfaceShape surfaceShape(const std::vector<HighlightOnSurface>& highlights) {
  std::vector<Patch> patches;
  for (const HighlightOnSurface& h : highlights)
    if (Patch p; patchOf(h, p)) patches.push_back(p);
  SurfaceShape shape;
  shape.highlights = static_cast<int>(patches.size());
  if (patches.empty()) return shape;
  const double n = static_cast<double>(patches.size());
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), normal = position;
  Eigen::Vector2d curvature = Eigen::Vector2d::Zero();
  for (const Patch& p : patches) position += p.position / n, normal += p.normal, curvature += p.curvature / n;
  const double agree = normal.norm() / n;  // 0 where normals cancel
  normal.normalize();
  if (!(agree > 0.1)) shape.bend = 1;
  for (const Patch& p : patches) {
    const double t = std::max(p.turn, std::atan2(p.normal.cross(normal).norm(), p.normal.dot(normal)));
    const double off = std::abs((p.position - position).dot(normal));
    shape.bend = std::max({shape.bend, t / (t + p.psi / 2), std::min(1.0, off / p.radius)});
    shape.curvatureChange = std::max(shape.curvatureChange, (p.curvature - curvature).cwiseAbs().maxCoeff() /
                                                                (curvature.cwiseAbs().maxCoeff() + 0.5 / p.distance));
  }
  return shape;
}

}  // namespace glint

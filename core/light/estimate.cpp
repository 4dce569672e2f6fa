// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/estimate.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "core/base/dense_algebra.h"
#include "core/geometry/plane.h"

namespace glint {

ReflectedRay reflectedRay(const BrightestPoint& brightest, const Camera& camera) {
  const Eigen::Vector3d eye = camera.centreInWorld();
  const SurfacePoint p = facing(brightest.point, eye);
  return {p.position, reflect((eye - p.position).normalized(), p.normal), p.normal};
}

double conditionOf(const std::vector<ReflectedRay>& rays) {
  Eigen::Matrix3d across = Eigen::Matrix3d::Zero();
  for (const ReflectedRay& r : rays) across += Eigen::Matrix3d::Identity() - r.direction * r.direction.transpose();
  const Eigen::Vector3d values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(across, Eigen::EigenvaluesOnly).eigenvalues();
  return rays.size() >= 2 && values(2) > 0 ? std::max(0.0, values(0) / values(2)) : 0;
}

Outcome<Triangulation> triangulateLight(const std::vector<ReflectedRay>& rays, double minCondition) {
  if (rays.size() < 2) return Failure{Reason::TooFewViews, "need 2 rays, have " + std::to_string(rays.size())};
  const Eigen::Index n = rays.size();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), direction = Eigen::Vector3d::Zero();
  for (const ReflectedRay& r : rays) {
    if (!r.origin.allFinite() || !r.direction.allFinite() || !r.normal.allFinite())
      return Failure{Reason::NotFinite, "a reflected ray"};
    mean += r.origin / double(n);
    direction += r.direction / double(n);
  }
  // Two rows per ray span the plane across it: I - r r^T without its null direction. QR, then the SVD of R: no normal equations.
  Eigen::Matrix<double, Eigen::Dynamic, 4> rows(std::max<Eigen::Index>(2 * n, 4), 4);
  rows.setZero();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Matrix<double, 2, 3> across = tangentBasis(rays[i].direction).transpose();
    rows.block<2, 3>(2 * i, 0) = across;
    rows.block<2, 1>(2 * i, 3) = across * (rays[i].origin - mean);
  }
  const Eigen::Matrix4d r = triangularFactor(rows);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(r.topLeftCorner<3, 3>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d s = svd.singularValues();
  Triangulation result;
  result.condition = std::pow(s(2) / s(0), 2);
  result.covariance.setZero();
  if (!(result.condition >= minCondition)) {
    if (!(direction.norm() > 0.5)) return Failure{Reason::ParallelRays, "the rays are parallel but point in opposite directions"};
    result.light = Light::towards(direction);
  } else {
    const Eigen::Vector3d offset = svd.solve(r.topRightCorner<3, 1>());
    result.light = Light::at(mean + offset);
    double sum = 0, size = offset.norm();
    for (Eigen::Index i = 0; i < n; ++i) {
      sum += (rows.block<2, 3>(2 * i, 0) * offset - rows.block<2, 1>(2 * i, 3)).squaredNorm();
      size = std::max(size, (rays[i].origin - mean).norm());
    }
    result.residual = std::sqrt(sum / n);
    // Rays that meet to round-off (1e-13 of the scene) say nothing about their noise: the covariance is that of unit variance.
    const bool exact = result.residual <= 1e-13 * size;
    const double variance = exact ? 1.0 : sum / double(2 * n - 3);
    const Eigen::Matrix3d root = svd.matrixV() * s.cwiseInverse().asDiagonal();
    result.covariance = variance * (root * root.transpose());
  }
  for (const ReflectedRay& ray : rays)
    if (!(ray.normal.dot(result.light.directionFrom(ray.origin)) > 0))
      return Failure{Reason::LightBehindSurface, "the reflected rays meet behind the surface"};
  return result;
}

}  // namespace glint

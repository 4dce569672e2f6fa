// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/local_quadric.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/plane.h"

namespace glint {

using Eigen::Vector3d;

namespace {

/// Real roots of a t^2 + 2 b t + c = 0 without cancellation, for any a, also 0.
struct Roots {
  double t[2];
  int count = 0;
};
Roots solve(double a, double b, double c) {
  Roots r;
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0)) return r;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  if (q != 0) r.t[r.count++] = c / q;
  if (a != 0) r.t[r.count++] = q / a;
  return r;
}

}  // namespace

LocalQuadric::LocalQuadric(const SurfacePoint& at, const Curvature& c) : origin_(at) {
  require(at.position.allFinite() && at.normal.allFinite() && std::isfinite(c.k1 + c.k2) && c.direction1.allFinite() &&
              c.direction2.allFinite(),
          "LocalQuadric: point and curvature must be finite");
  k_ = {c.k1, c.k2, std::abs(c.k1) >= std::abs(c.k2) ? c.k1 : c.k2};
  frame_ << c.direction1, c.direction2, at.normal;
}

Outcome<LocalQuadric> LocalQuadric::of(const Surface& surface, const SurfacePoint& at) {
  const Outcome<Curvature> curvature = surface.curvatureAt(at);
  if (!curvature) return curvature.failure();
  return LocalQuadric(at, *curvature);
}

SurfacePoint LocalQuadric::pointAt(const Vector3d& local) const {
  SurfacePoint p;
  p.position = origin_.position + frame_ * local;
  // Half of the gradient; its length is 1 at P and at least 1 + c z > 0 on the sheet.
  p.normal = (frame_ * Vector3d(k_.x() * local.x(), k_.y() * local.y(), 1 + k_.z() * local.z())).normalized();
  return p;
}

Outcome<SurfacePoint> LocalQuadric::firstHit(const Ray& ray) const {
  if (!ray.origin.allFinite() || !ray.direction.allFinite()) return Failure{Reason::NotFinite, "ray"};
  const Vector3d o = frame_.transpose() * (ray.origin - origin_.position), d = frame_.transpose() * ray.direction;
  const Vector3d kd = k_.cwiseProduct(d), ko = k_.cwiseProduct(o);
  const Roots roots = solve(kd.dot(d), ko.dot(d) + d.z(), ko.dot(o) + 2 * o.z());
  double first = std::numeric_limits<double>::infinity();
  for (int i = 0; i < roots.count; ++i)
    if (roots.t[i] > 0 && roots.t[i] < first && 1 + k_.z() * (o.z() + roots.t[i] * d.z()) > 0) first = roots.t[i];
  if (!std::isfinite(first)) return Failure{Reason::NoHit, describe()};
  return pointAt(o + first * d);
}

Outcome<SurfacePoint> LocalQuadric::foot(const Vector3d& point, const Vector3d& direction, const SurfacePoint& previous) const {
  const Vector3d o = frame_.transpose() * (point - origin_.position), d = frame_.transpose() * direction;
  const Vector3d kd = k_.cwiseProduct(d), ko = k_.cwiseProduct(o);
  const Roots roots = solve(kd.dot(d), ko.dot(d) + d.z(), ko.dot(o) + 2 * o.z());
  double best = std::numeric_limits<double>::infinity();
  Vector3d foot = o;
  for (int i = 0; i < roots.count; ++i) {
    const Vector3d p = o + roots.t[i] * d;
    if (!(1 + k_.z() * p.z() > 0)) continue;
    const double distance = roots.count < 2 ? 0 : (origin_.position + frame_ * p - previous.position).squaredNorm();
    if (distance < best) {
      best = distance;
      foot = p;
    }
  }
  if (!std::isfinite(best) || !foot.allFinite()) return Failure{Reason::SurfaceEnded, "the line misses the local quadric"};
  return pointAt(foot);
}

Outcome<Curvature> LocalQuadric::curvatureAt(const SurfacePoint& p) const {
  const Vector3d local = frame_.transpose() * (p.position - origin_.position);
  const Vector3d gradient(k_.x() * local.x(), k_.y() * local.y(), 1 + k_.z() * local.z());
  const double length = gradient.norm();
  if (!(length > 0) || !std::isfinite(length)) return Failure{Reason::NotSupported, "no normal at this point"};
  const Eigen::Matrix<double, 3, 2> basis = tangentBasis(gradient / length);
  Eigen::Matrix2d s = basis.transpose() * k_.asDiagonal() * basis / length;
  if (p.normal.dot(frame_ * gradient) < 0) s = -s;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(s);
  Curvature c;
  c.k1 = eigen.eigenvalues()[1];
  c.k2 = eigen.eigenvalues()[0];
  c.direction1 = frame_ * (basis * eigen.eigenvectors().col(1));
  c.direction2 = frame_ * (basis * eigen.eigenvectors().col(0));
  return c;
}

Eigen::AlignedBox3d LocalQuadric::bounds() const {
  return {Vector3d::Constant(-std::numeric_limits<double>::infinity()),
          Vector3d::Constant(std::numeric_limits<double>::infinity())};
}

TriangleMesh LocalQuadric::tessellate(const Eigen::AlignedBox3d& region, int resolution) const {
  require(resolution >= 1, "tessellate: resolution must be at least 1");
  TriangleMesh mesh;
  const double size = region.isEmpty() || !region.sizes().allFinite() ? 0 : 0.5 * region.sizes().maxCoeff();
  std::vector<int> index((resolution + 1) * (resolution + 1), -1);
  for (int j = 0; j <= resolution; ++j)
    for (int i = 0; i <= resolution; ++i) {
      const double a = size * (2.0 * i / resolution - 1), b = size * (2.0 * j / resolution - 1);
      const Outcome<SurfacePoint> p = foot(origin_.position + a * frame_.col(0) + b * frame_.col(1), origin_.normal, origin_);
      if (!p) continue;
      index[j * (resolution + 1) + i] = static_cast<int>(mesh.vertices.size());
      mesh.vertices.push_back(p->position);
      mesh.normals.push_back(p->normal);
    }
  for (int j = 0; j < resolution; ++j)
    for (int i = 0; i < resolution; ++i) {
      const int n = j * (resolution + 1) + i, a = index[n], b = index[n + 1], c = index[n + resolution + 1],
                d = index[n + resolution + 2];
      if (a < 0 || b < 0 || c < 0 || d < 0) continue;
      mesh.triangles.emplace_back(a, b, d);
      mesh.triangles.emplace_back(a, d, c);
    }
  return mesh;
}

}  // namespace glint

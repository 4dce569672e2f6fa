// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/analytic.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/geometry/plane.h"
#include "core/surface/analytic_shape.h"

namespace glint {

using Eigen::AlignedBox3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

std::vector<std::optional<SurfacePoint>> Surface::approximateHits(const std::vector<Ray>& rays) const {
  std::vector<std::optional<SurfacePoint>> hits(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (const Outcome<SurfacePoint> hit = firstHit(rays[i])) hits[i] = *hit;
  return hits;
}

Eigen::Vector3d Surface::tangentAt(const SurfacePoint& p) const {
  constexpr double kAlongY = 1e-6;  // sine of the angle to y: below it round-off would turn the tangent
  const Eigen::Vector3d around = Eigen::Vector3d::UnitY().cross(p.normal);
  return around.norm() > kAlongY ? around.normalized() : Eigen::Vector3d::UnitX();
}

namespace {

class AnalyticSurface : public Surface {
 public:
  explicit AnalyticSurface(const AnalyticSpec& spec)
      : shape_(makeShape(spec)),
        worldFromLocal_(spec.worldFromSurface),
        localFromWorld_(worldFromLocal_.inverse()),
        bounds_(shape_->bounds(worldFromLocal_)) {
    const Matrix3d r = worldFromLocal_.linear();
    require(
        // A rotation to single precision: readPoseJson accepts nothing else (docs/formats.md, "Frames").
        worldFromLocal_.matrix().allFinite() && (r * r.transpose() - Matrix3d::Identity()).norm() < 1e-6 && r.determinant() > 0,
        "analytic surface: world_from_surface must be rigid and finite");
  }

  std::string describe() const override { return shape_->describe(); }

  Outcome<SurfacePoint> firstHit(const Ray& ray) const override {
    if (!ray.origin.allFinite() || !ray.direction.allFinite()) return Failure{Reason::NotFinite, "ray"};
    const Vector3d o = localFromWorld_ * ray.origin, d = localFromWorld_.linear() * ray.direction;
    const LineRoots roots = lineRoots(o, d);
    for (int i = 0; i < roots.count; ++i)
      if (roots.t[i] > 0) return pointAt(o + roots.t[i] * d);
    return Failure{Reason::NoHit, shape_->describe()};
  }

  Outcome<SurfacePoint> foot(const Vector3d& point, const Vector3d& direction, const SurfacePoint& previous) const override {
    if (!point.allFinite() || !direction.allFinite() || !previous.position.allFinite()) return Failure{Reason::NotFinite, "foot"};
    const Vector3d o = localFromWorld_ * point, d = (localFromWorld_.linear() * direction).normalized();
    const Vector3d near = localFromWorld_ * previous.position;
    const LineRoots roots = lineRoots(o, d);
    double best = std::numeric_limits<double>::infinity();
    Vector3d foot;
    for (int i = 0; i < roots.count; ++i) {
      const Vector3d p = o + roots.t[i] * d;
      const double distance = (p - near).squaredNorm();
      if (distance < best) {
        best = distance;
        foot = p;
      }
    }
    if (!std::isfinite(best)) return Failure{Reason::SurfaceEnded, "the line misses the " + shape_->describe()};
    return pointAt(foot);
  }

  Vector3d tangentAt(const SurfacePoint& p) const override {
    return worldFromLocal_.linear() * Surface::tangentAt({p.position, localFromWorld_.linear() * p.normal});
  }

  Outcome<Curvature> curvatureAt(const SurfacePoint& p) const override {
    const Vector3d local = localFromWorld_ * p.position;
    const Vector3d gradient = shape_->gradient(local);
    const double length = gradient.norm();
    if (!(length > 0)) return Failure{Reason::NotSupported, "no normal at this point"};
    const Vector3d normal = gradient / length;
    const Eigen::Matrix<double, 3, 2> basis = tangentBasis(normal);
    Eigen::Matrix2d s = basis.transpose() * shape_->hessian(local) * basis / length;
    if (p.normal.dot(worldFromLocal_.linear() * normal) < 0) s = -s;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
    eigen.computeDirect(s);
    if (!eigen.eigenvalues().allFinite()) return Failure{Reason::NotFinite, "curvature"};
    Curvature c;
    c.k1 = eigen.eigenvalues()[1];
    c.k2 = eigen.eigenvalues()[0];
    c.direction1 = worldFromLocal_.linear() * (basis * eigen.eigenvectors().col(1));
    c.direction2 = worldFromLocal_.linear() * (basis * eigen.eigenvectors().col(0));
    return c;
  }

  bool occluded(const SurfacePoint& from, const Vector3d& to) const override {
    if (!from.position.allFinite() || !to.allFinite()) return false;
    const Vector3d o = localFromWorld_ * from.position, offset = localFromWorld_ * to - o;
    const double length = offset.norm();
    if (!(length > 0)) return false;
    // The millionth that Surface::occluded names: the start lies on the surface, to round-off of a hit.
    const double ignored = 1e-6 * std::min(length, shape_->size());
    const LineRoots roots = lineRoots(o, offset / length);
    for (int i = 0; i < roots.count; ++i)
      if (roots.t[i] > ignored && roots.t[i] < length * (1 - 1e-12)) return true;  // the end itself does not hide itself
    return false;
  }

  AlignedBox3d bounds() const override { return bounds_; }

  TriangleMesh tessellate(const AlignedBox3d& region, int resolution) const override {
    require(resolution >= 1, "tessellate: resolution must be at least 1");
    AlignedBox3d box = region;
    if (shape_->bounded() && !(box.isEmpty() || box.sizes().allFinite())) box = bounds();
    const bool whole = box.isEmpty() || !box.sizes().allFinite();
    const Vector3d centre = whole ? Vector3d::Zero() : Vector3d(localFromWorld_ * box.center());
    const double radius = whole ? std::numeric_limits<double>::infinity() : 0.5 * box.sizes().norm();
    const int n = std::max(resolution, 3);
    const std::vector<Vector3d> grid = shape_->grid(n, n, centre, radius);
    TriangleMesh mesh;
    if (grid.empty()) {
      const double reach = std::isfinite(radius) ? radius : (shape_->bounded() ? bounds().sizes().norm() : 1.0);
      const Vector3d middle = shape_->bounded() && whole ? Vector3d(localFromWorld_ * bounds().center()) : centre;
      mesh = contourShape(*shape_, {middle - Vector3d::Constant(reach), middle + Vector3d::Constant(reach)}, n);
    } else {
      mesh.vertices = grid;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
          for (const Eigen::Vector3i& t : {Eigen::Vector3i(a, b, d), Eigen::Vector3i(a, d, c)})
            if (area(grid, t) > 0) mesh.triangles.push_back(t);
        }
    }
    finish(mesh, !shape_->bounded() && !whole ? &box : nullptr);
    return mesh;
  }

 private:
  /// Intersections inside the domain, polished on f, ascending.
  LineRoots lineRoots(const Vector3d& o, const Vector3d& d) const {
    const LineRoots raw = shape_->roots(o, d);
    LineRoots roots;
    for (int i = 0; i < raw.count; ++i) {
      double t = raw.t[i];
      for (int k = 0; k < 2; ++k) {
        const Vector3d p = o + t * d;
        const double slope = shape_->gradient(p).dot(d), step = shape_->value(p) / slope;
        // Near a tangent ray Newton's step is larger than the error of the closed form: keep that then.
        if (!(std::abs(step) <= 1e-6 * (std::abs(t) + p.norm()))) break;
        t -= step;
      }
      const Vector3d p = o + t * d;
      if (p.allFinite() && shape_->gradient(p).squaredNorm() > 0 && shape_->inDomain(p)) roots.add(t);
    }
    roots.sort();
    return roots;
  }

  SurfacePoint pointAt(const Vector3d& local) const {
    SurfacePoint p;
    p.position = worldFromLocal_ * local;
    p.normal = worldFromLocal_.linear() * shape_->gradient(local).normalized();
    return p;
  }

  static double area(const std::vector<Vector3d>& v, const Eigen::Vector3i& t) {
    return (v[t.y()] - v[t.x()]).cross(v[t.z()] - v[t.x()]).norm();
  }

  /// Normals, winding along them, world frame, and only triangles that touch `clip`.
  void finish(TriangleMesh& mesh, const AlignedBox3d* clip) const {
    mesh.normals.clear();
    for (Vector3d& v : mesh.vertices) {
      const SurfacePoint p = pointAt(v);
      mesh.normals.push_back(p.normal);
      v = p.position;
    }
    std::vector<Eigen::Vector3i> kept;
    for (Eigen::Vector3i t : mesh.triangles) {
      const Vector3d n = (mesh.vertices[t.y()] - mesh.vertices[t.x()]).cross(mesh.vertices[t.z()] - mesh.vertices[t.x()]);
      if (n.dot(mesh.normals[t.x()] + mesh.normals[t.y()] + mesh.normals[t.z()]) < 0) std::swap(t.y(), t.z());
      if (clip) {
        AlignedBox3d box;
        for (int i = 0; i < 3; ++i) box.extend(mesh.vertices[t[i]]);
        if (!clip->intersects(box)) continue;
      }
      kept.push_back(t);
    }
    mesh.triangles = std::move(kept);
  }

  std::unique_ptr<const AnalyticShape> shape_;
  Eigen::Isometry3d worldFromLocal_, localFromWorld_;
  AlignedBox3d bounds_;  ///< kept: it is asked for with every shadow ray, and a sheet samples its arc for it
};

}  // namespace

std::shared_ptr<const Surface> makeAnalytic(const AnalyticSpec& spec) { return std::make_shared<AnalyticSurface>(spec); }

}  // namespace glint

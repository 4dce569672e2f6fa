// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/analytic_shape.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/number_text.h"
#include "core/surface/added_shape.h"

namespace glint {

using Eigen::AlignedBox3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPi = std::numbers::pi;

bool positive(double x) { return std::isfinite(x) && x > 0; }

std::string shown(double x) { return formatted("%.6g", x); }

/// Box of { c + diag(e) u : |u| <= 1 } style shapes whose world half extents are known.
AlignedBox3d around(const Vector3d& centre, const Vector3d& half) { return {centre - half, centre + half}; }

/// f(p) = p^T A p + 2 b.p + c: plane, sphere, ellipsoid, cylinder, sheet and quadric.
class QuadricShape : public AnalyticShape {
 public:
  QuadricShape(const Matrix3d& a, const Vector3d& b, double c) : a_(a), b_(b), c_(c) {}

  double value(const Vector3d& p) const override { return p.dot(a_ * p) + 2 * b_.dot(p) + c_; }
  Vector3d gradient(const Vector3d& p) const override { return 2 * (a_ * p + b_); }
  Matrix3d hessian(const Vector3d&) const override { return 2 * a_; }

  LineRoots roots(const Vector3d& o, const Vector3d& d) const override {
    LineRoots found;
    const double a = d.dot(a_ * d);
    double half = d.dot(a_ * o + b_), c = value(o), shift = 0;
    // A ray that is nearly a tangent: both roots are close to the vertex -half/a, and half^2 - a c cancels. Seen from the vertex
    // the linear term is round-off and f there is computed directly, so the discriminant keeps its digits.
    if (a != 0 && std::abs(half * half - a * c) < 0.5 * half * half) {
      const double vertex = -half / a;
      if (std::isfinite(vertex)) {
        shift = vertex;
        const Vector3d at = o + shift * d;
        half = d.dot(a_ * at + b_);
        c = value(at);
      }
    }
    const double discriminant = half * half - a * c;
    if (!(discriminant >= 0)) return found;
    // Cancellation-free pair: the larger root by addition, the other from their product.
    const double q = -(half + std::copysign(std::sqrt(discriminant), half));
    if (q == 0) {
      if (a != 0) found.add(shift);  // double root at the vertex
      return found;
    }
    if (std::isfinite(c / q)) found.add(shift + c / q);
    if (a != 0 && std::isfinite(q / a) && discriminant > 0) found.add(shift + q / a);
    return found;
  }

 protected:
  Matrix3d a_;
  Vector3d b_;
  double c_;
};

class SphereOrEllipsoid : public QuadricShape {
 public:
  SphereOrEllipsoid(const Vector3d& semiAxes, std::string text)
      : QuadricShape(semiAxes.cwiseAbs2().cwiseInverse().asDiagonal(), Vector3d::Zero(), -1),
        axes_(semiAxes),
        text_(std::move(text)) {}
  std::string describe() const override { return text_; }
  double size() const override { return axes_.maxCoeff(); }
  bool bounded() const override { return true; }
  AlignedBox3d bounds(const Eigen::Isometry3d& m) const override {
    const Matrix3d scaled = m.linear() * axes_.asDiagonal();
    return around(m.translation(), scaled.rowwise().norm());
  }
  std::vector<Vector3d> grid(int nu, int nv, const Vector3d&, double) const override {
    std::vector<Vector3d> points;
    for (int j = 0; j <= nv; ++j)
      for (int i = 0; i <= nu; ++i) {
        const double phi = 2 * kPi * (i % nu) / nu, theta = kPi * j / nv;
        const double ring = j == 0 || j == nv ? 0.0 : std::sin(theta);
        points.push_back(axes_.cwiseProduct(Vector3d(ring * std::cos(phi), ring * std::sin(phi), -std::cos(theta))));
      }
    return points;
  }

 private:
  Vector3d axes_;
  std::string text_;
};

class Cylinder : public QuadricShape {
 public:
  explicit Cylinder(double radius)
      : QuadricShape(Vector3d(1 / (radius * radius), 0, 1 / (radius * radius)).asDiagonal(), Vector3d::Zero(), -1),
        radius_(radius) {}
  std::string describe() const override { return "cylinder of radius " + shown(radius_) + " m"; }
  double size() const override { return radius_; }
  bool bounded() const override { return false; }
  AlignedBox3d bounds(const Eigen::Isometry3d& m) const override {
    AlignedBox3d box = unboundedBox();
    const Vector3d axis = m.linear().col(1);
    for (int i = 0; i < 3; ++i)
      if (axis[i] == 0) {
        box.min()[i] = m.translation()[i] - radius_;
        box.max()[i] = m.translation()[i] + radius_;
      }
    return box;
  }
  std::vector<Vector3d> grid(int nu, int nv, const Vector3d& centre, double radius) const override {
    const double mid = std::isfinite(radius) ? centre.y() : 0, half = std::isfinite(radius) ? radius : 2 * radius_;
    std::vector<Vector3d> points;
    for (int j = 0; j <= nv; ++j)
      for (int i = 0; i <= nu; ++i) {
        const double phi = 2 * kPi * (i % nu) / nu;
        points.emplace_back(radius_ * std::sin(phi), mid + half * (2.0 * j / nv - 1), radius_ * std::cos(phi));
      }
    return points;
  }

 private:
  double radius_;
};

/// k (x^2 + z^2) + 2 z = 0: the plane z = 0 at k = 0, smoothly. A plane is a sheet without bounds.
class Sheet : public QuadricShape {
 public:
  Sheet(double curvature, double length, double width)
      : QuadricShape(Vector3d(curvature, 0, curvature).asDiagonal(), Vector3d(0, 0, 1), 0),
        k_(curvature),
        length_(length),
        width_(width) {}

  std::string describe() const override {
    if (k_ == 0 && !std::isfinite(length_) && !std::isfinite(width_)) return "plane";
    return "sheet of curvature " + shown(k_) + " per metre";
  }
  double size() const override {
    double s = std::min(length_, width_);
    if (k_ != 0) s = std::min(s, 1 / std::abs(k_));
    return s;
  }
  bool bounded() const override { return std::isfinite(length_) && std::isfinite(width_); }

  /// Arc length from the ruling x = 0, in (-pi/|k|, pi/|k|].
  double arc(const Vector3d& p) const {
    const double sine = k_ * p.x(), cosine = 1 + k_ * p.z();
    // Below 1e-9 the angle equals its tangent to double precision, and dividing by a denormal k is avoided.
    if (std::abs(sine) < 1e-9 && cosine > 0) return p.x() / cosine;
    return std::atan2(sine, cosine) / k_;
  }
  bool inDomain(const Vector3d& p) const override {
    constexpr double kRoundOff = 1 + 4e-15;  // points on the very edge belong to the sheet
    return std::abs(arc(p)) <= 0.5 * length_ * kRoundOff && std::abs(p.y()) <= 0.5 * width_ * kRoundOff;
  }
  AlignedBox3d bounds(const Eigen::Isometry3d& m) const override {
    AlignedBox3d local;
    const double reach = k_ == 0 ? length_ / 2 : std::min(length_ / 2, kPi / std::abs(k_));
    if (!std::isfinite(reach) || !std::isfinite(width_)) return unboundedBox();
    const int steps = 64;
    for (int i = 0; i <= steps; ++i)
      for (const double y : {-width_ / 2, width_ / 2}) local.extend(at(reach * (2.0 * i / steps - 1), y));
    // Chords between the samples cut the arc by at most its sagitta.
    const double step = 2 * reach / steps, sagitta = step * step * std::abs(k_) / 8;
    local.min() -= Vector3d(sagitta, 0, sagitta);
    local.max() += Vector3d(sagitta, 0, sagitta);
    AlignedBox3d world;
    for (int c = 0; c < 8; ++c) world.extend(m * local.corner(static_cast<AlignedBox3d::CornerType>(c)));
    return world;
  }
  std::vector<Vector3d> grid(int nu, int nv, const Vector3d& centre, double radius) const override {
    const double fallback = std::isfinite(radius) ? centre.norm() + radius : 1;
    double reach = std::min(length_ / 2, fallback);
    if (k_ != 0) reach = std::min(std::isfinite(length_) ? length_ / 2 : kInfinity, kPi / std::abs(k_));
    if (!std::isfinite(reach) || (!std::isfinite(length_) && std::abs(k_) * fallback < 1)) reach = fallback;
    const double half = std::min(width_ / 2, fallback);
    std::vector<Vector3d> points;
    for (int j = 0; j <= nv; ++j)
      for (int i = 0; i <= nu; ++i) points.push_back(at(reach * (2.0 * i / nu - 1), half * (2.0 * j / nv - 1)));
    return points;
  }

 private:
  Vector3d at(double s, double y) const {
    const double angle = k_ * s;
    if (std::abs(angle) < 1e-9) return {s, y, -0.5 * angle * s};  // the series' next terms are below round-off
    const double h = std::sin(0.5 * angle);
    return {std::sin(angle) / k_, y, -2 * h * h / k_};
  }
  double k_, length_, width_;
};

class GeneralQuadric : public QuadricShape {
 public:
  explicit GeneralQuadric(const Eigen::Matrix4d& m) : QuadricShape(m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>(), m(3, 3)) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(a_);
    const Vector3d values = eigen.eigenvalues();
    const double largest = values.cwiseAbs().maxCoeff();
    // An eigenvalue below round-off of the largest is 0: that quadric has no centre.
    if (values.minCoeff() > 1e-14 * largest || values.maxCoeff() < -1e-14 * largest) {
      centre_ = -eigen.eigenvectors() * values.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose() * b_;
      const double k = -value(*centre_);
      squared_ = eigen.eigenvectors() * (k * values.cwiseInverse()).asDiagonal() * eigen.eigenvectors().transpose();
      if (!(squared_.trace() > 0)) centre_.reset();  // no real points
    }
  }
  std::string describe() const override { return "quadric"; }
  double size() const override { return centre_ ? std::sqrt(squared_.trace()) : kInfinity; }
  bool bounded() const override { return centre_.has_value(); }
  AlignedBox3d bounds(const Eigen::Isometry3d& m) const override {
    if (!centre_) return unboundedBox();
    const Matrix3d s = m.linear() * squared_ * m.linear().transpose();
    return around(m * *centre_, s.diagonal().cwiseMax(0).cwiseSqrt());
  }
  std::vector<Vector3d> grid(int, int, const Vector3d&, double) const override { return {}; }

 private:
  std::optional<Vector3d> centre_;       ///< of an ellipsoid
  Matrix3d squared_ = Matrix3d::Zero();  ///< its shape S, eigenvalues are squared semi-axes
};

/// (rho - R)^2 + z^2 - r^2 with rho the distance from the axis.
class Torus : public AnalyticShape {
 public:
  Torus(double major, double minor) : major_(major), minor_(minor) {}
  std::string describe() const override { return "torus of radii " + shown(major_) + " and " + shown(minor_) + " m"; }

  double value(const Vector3d& p) const override {
    const double q = std::hypot(p.x(), p.y()) - major_;
    return q * q + p.z() * p.z() - minor_ * minor_;
  }
  Vector3d gradient(const Vector3d& p) const override {
    const double rho = std::hypot(p.x(), p.y());
    const double ratio = (rho - major_) / rho;
    return {2 * ratio * p.x(), 2 * ratio * p.y(), 2 * p.z()};
  }
  Matrix3d hessian(const Vector3d& p) const override {
    const double rho = std::hypot(p.x(), p.y());
    const Eigen::Vector2d e = p.head<2>() / rho;
    Matrix3d h = Matrix3d::Zero();
    h.topLeftCorner<2, 2>() = 2 * (e * e.transpose() + (rho - major_) / rho * (Eigen::Matrix2d::Identity() - e * e.transpose()));
    h(2, 2) = 2;
    return h;
  }

  LineRoots roots(const Vector3d& o, const Vector3d& d) const override {
    // From the point of the line nearest to the centre, in units of R, the quartic t^4 + p t^2 + q t + s has no cubic term.
    LineRoots found;
    const double nearest = -o.dot(d);
    const Vector3d c = (o + nearest * d) / major_;
    const double r = minor_ / major_, k = c.squaredNorm() + 1 - r * r;
    const double p = 2 * k - 4 * (d.x() * d.x() + d.y() * d.y());
    const double q = -8 * (c.x() * d.x() + c.y() * d.y());
    const double s = k * k - 4 * (c.x() * c.x() + c.y() * c.y());
    const double reach = 1 + r + 1e-9;  // no point is farther from the centre; major radius 1; the rest is round-off
    if (!(c.squaredNorm() <= reach * reach)) return found;
    const auto quartic = [&](double t) { return ((t * t + p) * t + q) * t + s; };
    const auto cubic = [&](double t) { return (4 * t * t + 2 * p) * t + q; };
    // Roots of each derivative bracket those of the function: from the parabola 12 t^2 + 2 p upwards.
    double ends[6] = {-reach, reach};
    int count = 2;
    if (p < 0) {
      const double v = std::sqrt(-p / 6);
      if (v < reach) {
        ends[1] = -v, ends[2] = v, ends[3] = reach;
        count = 4;
      }
    }
    double critical[6] = {-reach};
    int criticals = 1;
    for (int i = 0; i + 1 < count; ++i) {
      double t;
      if (bracketed(cubic, ends[i], ends[i + 1], t)) critical[criticals++] = t;
    }
    critical[criticals++] = reach;
    for (int i = 0; i + 1 < criticals; ++i) {
      double t;
      if (bracketed(quartic, critical[i], critical[i + 1], t)) found.add(nearest + t * major_);
    }
    return found;
  }
  double size() const override { return major_; }
  bool bounded() const override { return true; }
  AlignedBox3d bounds(const Eigen::Isometry3d& m) const override {
    const Eigen::Array3d axis = m.linear().col(2).array();
    return around(m.translation(), (major_ * (1 - axis.square()).max(0).sqrt() + minor_).matrix());
  }
  std::vector<Vector3d> grid(int nu, int nv, const Vector3d&, double) const override {
    std::vector<Vector3d> points;
    for (int j = 0; j <= nv; ++j)
      for (int i = 0; i <= nu; ++i) {
        const double phi = 2 * kPi * (i % nu) / nu, theta = 2 * kPi * (j % nv) / nv;
        const double ring = major_ + minor_ * std::cos(theta);
        points.emplace_back(ring * std::cos(phi), ring * std::sin(phi), minor_ * std::sin(theta));
      }
    return points;
  }

 private:
  /// Root of a function with a sign change in [a, b]: Illinois steps, halved when they are slow.
  template <class F>
  static bool bracketed(const F& f, double a, double b, double& root) {
    double fa = f(a), fb = f(b);
    if (fa == 0) return root = a, true;
    if (fb == 0) return root = b, true;
    if (!(fa * fb < 0)) return false;
    for (int i = 0; i < 100 && b - a > 1e-15; ++i) {  // in units of the major radius: round-off
      double t = i % 3 == 2 ? 0.5 * (a + b) : (a * fb - b * fa) / (fb - fa);
      if (!(t > a && t < b)) t = 0.5 * (a + b);
      const double ft = f(t);
      if (ft == 0) return root = t, true;
      if (fa * ft < 0) {
        b = t, fb = ft;
      } else {
        a = t, fa = ft;
      }
    }
    root = 0.5 * (a + b);
    return true;
  }
  double major_, minor_;
};

}  // namespace

void LineRoots::sort() { std::sort(t, t + count); }

AlignedBox3d unboundedBox() { return {Vector3d::Constant(-kInfinity), Vector3d::Constant(kInfinity)}; }

std::unique_ptr<const AnalyticShape> makeShape(const AnalyticSpec& spec) {
  if (spec.type == "plane") return std::make_unique<Sheet>(0.0, kInfinity, kInfinity);
  if (spec.type == "sphere") {
    require(positive(spec.radius), "analytic sphere: radius must be positive and finite");
    return std::make_unique<SphereOrEllipsoid>(Vector3d::Constant(spec.radius), "sphere of radius " + shown(spec.radius) + " m");
  }
  if (spec.type == "ellipsoid") {
    const Vector3d& a = spec.semiAxes;
    require(positive(a.x()) && positive(a.y()) && positive(a.z()), "analytic ellipsoid: semi_axes must be positive and finite");
    return std::make_unique<SphereOrEllipsoid>(
        a, "ellipsoid of semi-axes " + shown(a.x()) + ", " + shown(a.y()) + ", " + shown(a.z()) + " m");
  }
  if (spec.type == "cylinder") {
    require(positive(spec.radius), "analytic cylinder: radius must be positive and finite");
    return std::make_unique<Cylinder>(spec.radius);
  }
  if (spec.type == "sheet") {
    require(std::isfinite(spec.curvature), "analytic sheet: curvature must be finite");
    require(!spec.length || positive(*spec.length), "analytic sheet: length must be positive and finite");
    require(!spec.width || positive(*spec.width), "analytic sheet: width must be positive and finite");
    return std::make_unique<Sheet>(spec.curvature, spec.length.value_or(kInfinity), spec.width.value_or(kInfinity));
  }
  if (spec.type == "torus") {
    require(positive(spec.majorRadius) && positive(spec.minorRadius), "analytic torus: radii must be positive and finite");
    require(spec.minorRadius <= spec.majorRadius, "analytic torus: minor_radius must not exceed major_radius");
    return std::make_unique<Torus>(spec.majorRadius, spec.minorRadius);
  }
  if (spec.type == "quadric") {
    require(spec.matrix.allFinite(), "analytic quadric: matrix must be finite");
    const Eigen::Matrix4d symmetric = 0.5 * (spec.matrix + spec.matrix.transpose());
    const double scale = symmetric.cwiseAbs().maxCoeff();
    require(scale > 0, "analytic quadric: matrix must not be zero");
    return std::make_unique<GeneralQuadric>(symmetric / scale);
  }
  const ShapeKind* const kind = addedShapeKind(spec.type);
  require(kind != nullptr, "analytic surface: unknown type '" + spec.type + "'");
  for (const ShapeNumber& n : kind->numbers()) {
    const auto given = spec.numbers.find(n.name);
    require(given != spec.numbers.end() && given->second >= n.least && given->second <= n.most,
            "analytic " + spec.type + ": " + n.name + " is missing or out of its range");
  }
  std::unique_ptr<const AnalyticShape> shape = kind->make(spec.numbers);
  require(shape != nullptr, "analytic " + spec.type + ": its plugin made nothing");
  return shape;
}

}  // namespace glint

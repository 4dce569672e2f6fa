// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/conic.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/base/dense_algebra.h"

namespace glint {
namespace {
constexpr double kRoundOff = std::numeric_limits<double>::epsilon();
constexpr double kRankTolerance = 64 * kRoundOff;  // a determinant below this share of its own terms is round-off

Eigen::Matrix2d rotation(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return Eigen::Matrix2d{{c, -s}, {s, c}};
}

/// Unit largest entry, exactly symmetric: later products neither overflow nor underflow.
Eigen::Matrix3d balanced(const Eigen::Matrix3d& m) {
  const double scale = m.cwiseAbs().maxCoeff();
  if (!(scale > 0)) return m;
  const Eigen::Matrix3d s = m / scale;
  return 0.5 * (s + s.transpose());
}

/// True when the determinant vanishes against the six products it is a sum of. Unlike a ratio of singular values this does not
/// depend on the unit of the pixel.
bool hasNoDeterminant(const Eigen::Matrix3d& m) {
  double terms = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    terms += std::abs(m(0, i) * m(1, j) * m(2, k)) + std::abs(m(0, i) * m(1, k) * m(2, j));
  }
  return !(std::abs(m.determinant()) > kRankTolerance * terms);
}
/// The same for a 2x2 block.
bool hasNoDeterminant(const Eigen::Matrix2d& m) {
  return !(std::abs(m.determinant()) > kRankTolerance * (std::abs(m(0, 0) * m(1, 1)) + m(0, 1) * m(0, 1)));
}

/// A conic with a finite centre, seen from it: x^T A x + value. Small ellipses far from the origin keep their rank this way,
/// while the plain determinant has lost it.
struct Centred {
  Pixel centre;
  Eigen::Matrix2d inverse;  ///< A^-1
  double value;             ///< of the form at the centre
  bool singular;            ///< the value is round-off
};
std::optional<Centred> centred(const Eigen::Matrix3d& m) {
  const Eigen::Matrix2d a = m.topLeftCorner<2, 2>();
  if (hasNoDeterminant(a)) return std::nullopt;
  Centred c;
  c.inverse = Eigen::Matrix2d{{a(1, 1), -a(0, 1)}, {-a(0, 1), a(0, 0)}} / a.determinant();
  const Eigen::Vector2d b = m.topRightCorner<2, 1>();
  c.centre = -(c.inverse * b);
  const Eigen::Vector2d gradient = a * c.centre + b;  // round-off only, but it matters on thin ellipses far away
  c.value = m(2, 2) + b.dot(c.centre) + c.centre.dot(gradient);
  c.singular = !(std::abs(c.value) > kRankTolerance * (std::abs(m(2, 2)) + std::abs(b.dot(c.centre))));
  return c;
}

/// A dual conic with a finite centre, seen from it: [ -S 0 ; 0 1 ].
struct CentredDual {
  Pixel centre;
  Eigen::Matrix2d shape;
  bool singular;
};
std::optional<CentredDual> centred(const DualConic& dual) {
  const Eigen::Matrix3d& m = dual.matrix;
  if (m(2, 2) == 0) return std::nullopt;
  CentredDual c;
  c.centre = m.topRightCorner<2, 1>() / m(2, 2);
  const Eigen::Matrix2d first = c.centre * c.centre.transpose(), second = m.topLeftCorner<2, 2>() / m(2, 2);
  c.shape = first - second;
  if (!c.shape.allFinite() || !first.allFinite()) return std::nullopt;
  const Eigen::Vector2d values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(c.shape, Eigen::EigenvaluesOnly).eigenvalues();
  c.singular = hasNoDeterminant(c.shape) || values.cwiseAbs().minCoeff() <= 4 * kRoundOff * (first.norm() + second.norm());
  return c;
}
const char* const kSingular = "the conic is a pair of lines, a line or a point";
const char* const kSingularDual = "the dual conic is a pair of points, a point or empty";

Eigen::Matrix3d adjugate(const Eigen::Matrix3d& m) {
  Eigen::Matrix3d a;
  a.row(0) = m.col(1).cross(m.col(2));
  a.row(1) = m.col(2).cross(m.col(0));
  a.row(2) = m.col(0).cross(m.col(1));
  return a;
}

/// Semi-axes and angle of the shape S of an ellipse (eigenvalues are squared semi-axes), with b > 0 checked.
Outcome<Ellipse> fromCentreAndShape(const Pixel& centre, const Eigen::Matrix2d& shape) {
  if (!centre.allFinite() || !shape.allFinite()) return Failure{Reason::NotFinite, "ellipse"};
  const double mean = 0.5 * (shape(0, 0) + shape(1, 1));
  const double half = 0.5 * (shape(0, 0) - shape(1, 1));
  const double radius = std::hypot(half, shape(0, 1));
  const double large = mean + radius;
  // The product over the larger root loses fewer digits than mean - radius.
  const double small = large > 0 ? (shape(0, 0) * shape(1, 1) - shape(0, 1) * shape(0, 1)) / large : mean - radius;
  if (!(small > 0)) return Failure{Reason::NotAnEllipse, "the shape is not positive definite"};
  Ellipse e;
  e.centre = centre;
  e.semiAxes << std::sqrt(large), std::sqrt(std::min(small, large));
  e.angle = radius > 0 ? 0.5 * std::atan2(shape(0, 1), half) : 0.0;
  if (e.angle <= -std::numbers::pi / 2) e.angle += std::numbers::pi;
  return e;
}
/// The image of the unit circle under u -> centre + root u. Keeps the shorter axis of a thin ellipse, which root root^T would
/// lose.
Outcome<Ellipse> fromCentreAndRoot(const Pixel& centre, const Eigen::Matrix2d& root) {
  if (!centre.allFinite() || !root.allFinite()) return Failure{Reason::NotFinite, "ellipse"};
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(root, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Ellipse e;
  e.centre = centre;
  e.semiAxes = svd.singularValues();
  if (!(e.semiAxes.y() > 0)) return Failure{Reason::NotAnEllipse, "the shape is not positive definite"};
  const Eigen::Vector2d major = svd.matrixU().col(0);
  e.angle = major.x() == 0 ? std::numbers::pi / 2 : std::atan(major.y() / major.x());
  return e;
}
}  // namespace

Conic Ellipse::conic() const {
  const Eigen::Matrix2d r = rotation(angle);
  const Eigen::Matrix2d a = r * semiAxes.cwiseInverse().cwiseAbs2().asDiagonal() * r.transpose();
  const Eigen::Vector2d ac = a * centre;
  Conic c;
  c.matrix << a, -ac, -ac.transpose(), centre.dot(ac) - 1.0;
  return c;
}

DualConic Ellipse::dual() const {
  const Eigen::Matrix2d r = rotation(angle);
  const Eigen::Matrix2d s = r * semiAxes.cwiseAbs2().asDiagonal() * r.transpose();
  DualConic d;
  d.matrix << centre * centre.transpose() - s, centre, centre.transpose(), 1.0;
  return d;
}

Pixel Ellipse::at(double t) const {
  return centre + rotation(angle) * Eigen::Vector2d(semiAxes.x() * std::cos(t), semiAxes.y() * std::sin(t));
}

double Ellipse::area() const { return std::numbers::pi * semiAxes.x() * semiAxes.y(); }

std::vector<Pixel> Ellipse::sample(int n) const {
  require(n >= 0, "Ellipse::sample: negative count");
  std::vector<Pixel> points;
  points.reserve(n);
  for (int i = 0; i < n; ++i) points.push_back(at(2 * std::numbers::pi * i / n));
  return points;
}

Outcome<DualConic> dualOf(const Conic& c) {
  if (!c.matrix.allFinite()) return Failure{Reason::NotFinite, "conic"};
  const Eigen::Matrix3d m = balanced(c.matrix);
  const std::optional<Centred> parts = centred(m);
  if (parts ? parts->singular : hasNoDeterminant(m)) return Failure{Reason::RankDeficient, kSingular};
  if (!parts) return DualConic{balanced(adjugate(m))};
  DualConic dual;
  dual.matrix << parts->centre * parts->centre.transpose() + parts->value * parts->inverse, parts->centre,
      parts->centre.transpose(), 1.0;
  return dual;
}

Outcome<Conic> conicOf(const DualConic& c) {
  if (!c.matrix.allFinite()) return Failure{Reason::NotFinite, "dual conic"};
  const Eigen::Matrix3d m = balanced(c.matrix);
  const std::optional<CentredDual> parts = centred(DualConic{m});
  if (parts ? parts->singular : hasNoDeterminant(m)) return Failure{Reason::RankDeficient, kSingularDual};
  if (!parts) return Conic{balanced(adjugate(m))};
  const Eigen::Matrix2d& s = parts->shape;
  const Eigen::Matrix2d a = Eigen::Matrix2d{{s(1, 1), -s(0, 1)}, {-s(0, 1), s(0, 0)}} / s.determinant();
  const Eigen::Vector2d ac = a * parts->centre;
  Conic conic;  // S is positive definite for an ellipse, and its centre then has the value -1
  conic.matrix << a, -ac, -ac.transpose(), parts->centre.dot(ac) - 1.0;
  return conic;
}

Outcome<Ellipse> toEllipse(const Conic& c) {
  if (!c.matrix.allFinite()) return Failure{Reason::NotFinite, "conic"};
  const Eigen::Matrix3d m = balanced(c.matrix);
  const std::optional<Centred> parts = centred(m);
  if (parts ? parts->singular : hasNoDeterminant(m)) return Failure{Reason::RankDeficient, kSingular};
  if (!parts) return Failure{Reason::NotAnEllipse, "parabola"};
  if (parts->inverse.determinant() < 0) return Failure{Reason::NotAnEllipse, "hyperbola"};
  const Eigen::Matrix2d shape = -parts->value * parts->inverse;
  if (shape.trace() < 0) return Failure{Reason::NotAnEllipse, "imaginary ellipse"};
  return fromCentreAndShape(parts->centre, shape);
}

Outcome<Ellipse> toEllipse(const DualConic& c) {
  if (!c.matrix.allFinite()) return Failure{Reason::NotFinite, "dual conic"};
  const Eigen::Matrix3d m = balanced(c.matrix);
  const std::optional<CentredDual> parts = centred(DualConic{m});
  if (parts ? parts->singular : hasNoDeterminant(m)) return Failure{Reason::RankDeficient, kSingularDual};
  if (!parts) return Failure{Reason::NotAnEllipse, "parabola"};
  if (parts->shape.determinant() < 0) return Failure{Reason::NotAnEllipse, "hyperbola"};
  if (parts->shape.trace() < 0) return Failure{Reason::NotAnEllipse, "imaginary ellipse"};
  return fromCentreAndShape(parts->centre, parts->shape);
}

Outcome<Ellipse> fitEllipse(const std::vector<Pixel>& points) {
  Pixel low = Pixel::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Pixel& p : points) {
    if (!p.allFinite()) return Failure{Reason::NotFinite, "a contour point"};
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  if (points.size() < 5) return Failure{Reason::TooFewPoints, "need 5, have " + std::to_string(points.size())};
  const double extent = (high - low).maxCoeff();
  if (!std::isfinite(extent)) return Failure{Reason::NotFinite, "the points' extent"};
  std::vector<Pixel> distinct;  // at most five are looked for
  for (const Pixel& p : points) {
    if (std::none_of(distinct.begin(), distinct.end(),
                     [&](const Pixel& q) { return (p - q).cwiseAbs().maxCoeff() <= 1e-12 * extent; }))  // round-off
      distinct.push_back(p);
    if (distinct.size() == 5) break;
  }
  if (distinct.size() < 5) return Failure{Reason::TooFewPoints, "need 5 distinct, have " + std::to_string(distinct.size())};

  // Centre, then whiten along the principal axes. The constraint 4ac - b^2 = 1 only changes its scale under an affine map, so the
  // minimiser is the same ellipse, and a thin one is solved as well as a circle.
  const Eigen::Index n = points.size();
  Pixel mean(0, 0);
  for (const Pixel& p : points) mean += (p - low) / double(n);
  mean += low;
  Eigen::Matrix<double, Eigen::Dynamic, 2> centred(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) centred.row(i) = (points[i] - mean).transpose() / extent;
  const Eigen::Matrix2d r2 = triangularFactor(centred);
  const Eigen::JacobiSVD<Eigen::Matrix2d> axes(r2, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector2d spread = axes.singularValues() / std::sqrt(double(n));
  const double rounding = 8 * kRoundOff * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff()) / extent;
  // A width below 1e-10 of the length leaves fewer than six digits of the ellipse.
  if (!(spread.y() > std::max(1e-10 * spread.x(), rounding))) return Failure{Reason::RankDeficient, "the points lie on a line"};
  const Eigen::Matrix2d pixelFromUnit = axes.matrixV() * spread.asDiagonal();

  // Quadratic part after linear and constant parts are projected out: R of the design matrix with those columns first. Halir and
  // Flusser form M = S1 + S2 T = R^T R; working on R keeps all digits on short arcs.
  Eigen::Matrix<double, Eigen::Dynamic, 6> design =
      Eigen::Matrix<double, Eigen::Dynamic, 6>::Zero(std::max<Eigen::Index>(n, 6), 6);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector2d u = spread.cwiseInverse().cwiseProduct(axes.matrixV().transpose() * centred.row(i).transpose());
    design.row(i) << u.x(), u.y(), 1.0, u.x() * u.x(), u.x() * u.y(), u.y() * u.y();
  }
  const Eigen::Matrix<double, 6, 6> r = triangularFactor(design);
  // Minimise |R a|^2 under a^T K a = 1, K = [0 0 2; 0 -1 0; 2 0 0]. With R = U s V^T and b = s V^T a this is the largest
  // eigenvalue of s^-1 V^T K V s^-1. On an exact ellipse the smallest s is round-off; a floor keeps it finite, and the solution
  // is then that singular vector, as it should be.
  const Eigen::Matrix3d constraint{{0, 0, 2}, {0, -1, 0}, {2, 0, 0}};
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(r.bottomRightCorner<3, 3>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d s = svd.singularValues().cwiseMax(4 * kRoundOff * svd.singularValues()(0));
  if (!(s(0) > 0)) return Failure{Reason::RankDeficient, "the points do not determine a conic"};
  const Eigen::Matrix3d v = svd.matrixV() * s.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(v.transpose() * constraint * v);
  Eigen::Vector3d quadratic = (v * eigen.eigenvectors().col(2)).normalized();
  const auto discriminant = [](const Eigen::Vector3d& a) { return 4 * a(0) * a(2) - a(1) * a(1); };
  if (!(discriminant(quadratic) > 0)) {
    // Exact points of a hyperbola: the wanted eigenvalue drowns beside a huge negative one, and its vector is round-off of the
    // inverse singular values. With those floored at the root of round-off the wanted one stands out again; no ellipse is near
    // these points, so that the eight digits left are more than the answer deserves.
    const Eigen::Vector3d floored = s.cwiseMax(std::sqrt(kRoundOff) * s(0));
    const Eigen::Matrix3d w = svd.matrixV() * floored.cwiseInverse().asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> again(w.transpose() * constraint * w);
    quadratic = (w * again.eigenvectors().col(2)).normalized();
  }
  const Eigen::Vector3d linear =
      -r.topLeftCorner<3, 3>().triangularView<Eigen::Upper>().solve(r.topRightCorner<3, 3>() * quadratic);
  Conic unit;
  unit.matrix << quadratic(0), quadratic(1) / 2, linear(0) / 2, quadratic(1) / 2, quadratic(2), linear(1) / 2, linear(0) / 2,
      linear(1) / 2, linear(2);
  const Outcome<Ellipse> e = toEllipse(unit);
  if (!e) return e.failure();
  // Back to pixels through centre and shape, where nothing cancels.
  return fromCentreAndRoot(mean + extent * (pixelFromUnit * e->centre),
                           extent * (pixelFromUnit * rotation(e->angle) * e->semiAxes.asDiagonal()));
}

Outcome<std::array<Eigen::Vector3d, 2>> tangentLines(const Conic& c, const Eigen::Vector3d& point) {
  if (!point.allFinite()) return Failure{Reason::NotFinite, "point"};
  require(point.cwiseAbs().maxCoeff() > 0, "tangentLines: zero vector");
  const Outcome<Ellipse> e = toEllipse(c);
  if (!e) return e.failure();
  // In the frame where the ellipse is the unit circle, its tangents are (cos t, sin t, -1).
  const Eigen::Matrix2d unitFromPixel = e->semiAxes.cwiseInverse().asDiagonal() * rotation(e->angle).transpose();
  const Eigen::Vector3d p = point / point.cwiseAbs().maxCoeff();
  const Eigen::Vector2d q = unitFromPixel * (p.head<2>() - p.z() * e->centre);
  const double r = q.norm(), w = p.z();
  if (!(r > 0) || r < std::abs(w)) return Failure{Reason::NotAnEllipse, "the point lies inside: no real tangents"};
  const Eigen::Vector2d along = q / r, across(-along.y(), along.x());
  const double cosine = w / r, sine = std::sqrt((r - w) * (r + w)) / r;
  std::array<Eigen::Vector3d, 2> lines;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d normal = unitFromPixel.transpose() * (cosine * along + (i == 0 ? -sine : sine) * across);
    lines[i] << normal, -1.0 - normal.dot(e->centre);
    lines[i] /= normal.norm();
  }
  return lines;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numbers>

#include "core/geometry/ellipsoid.h"
#include "tests/stability/cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/real.h"

namespace glint::stability {
namespace {

/// Centre (x, y) and shape [ p q ; q r ] of an ellipse, eigenvalues of the shape are squared semi-axes.
struct RealEllipse {
  Real x, y, p, q, r;
  Real large() const { return (p + r) / 2 + sqrt((p - r) * (p - r) / 4 + q * q); }
  Real small() const { return (p * r - q * q) / large(); }
};

/// x^T M x = 0 by the classical formulas.
RealEllipse fromConic(const Eigen::Matrix3d& m) {
  const Real a = m(0, 0), b = m(0, 1), c = m(1, 1), d = m(0, 2), e = m(1, 2), f = m(2, 2), det = a * c - b * b;
  RealEllipse out;
  out.x = (b * e - c * d) / det;
  out.y = (b * d - a * e) / det;
  const Real k = -(f + d * out.x + e * out.y) / det;
  out.p = k * c;
  out.q = -k * b;
  out.r = k * a;
  return out;
}
RealEllipse fromDualConic(const Real m[6]) {  // 00, 01, 02, 11, 12, 22
  RealEllipse out;
  out.x = m[2] / m[5];
  out.y = m[4] / m[5];
  out.p = out.x * out.x - m[0] / m[5];
  out.q = out.x * out.y - m[1] / m[5];
  out.r = out.y * out.y - m[3] / m[5];
  return out;
}

/// Largest of the errors of centre (over the longer semi-axis), of each semi-axis (over itself) and of the shape.
double errorOf(const Ellipse& e, const RealEllipse& ref) {
  const Real a = e.semiAxes.x(), b = e.semiAxes.y(), c = cos(Real(e.angle)), s = sin(Real(e.angle));
  const Real p = a * a * c * c + b * b * s * s, r = a * a * s * s + b * b * c * c, q = (a * a - b * b) * c * s;
  const Real large = sqrt(ref.large()), small = sqrt(ref.small());
  const Real dx = Real(e.centre.x()) - ref.x, dy = Real(e.centre.y()) - ref.y;
  const Real shape = sqrt((p - ref.p) * (p - ref.p) + 2 * (q - ref.q) * (q - ref.q) + (r - ref.r) * (r - ref.r)) / ref.large();
  return worstOf({static_cast<double>(sqrt(dx * dx + dy * dy) / large), static_cast<double>(abs(a / large - 1)),
                  static_cast<double>(abs(b / small - 1)), static_cast<double>(shape)});
}

/// An ellipse's conic as doubles, its answer read back.
Outcome<Measured> conicRoundTrip(const Ellipse& ellipse, double multiple) {
  Conic c = ellipse.conic();
  c.matrix *= multiple;
  const RealEllipse ref = fromConic(c.matrix);
  const Outcome<Ellipse> e = toEllipse(c);
  if (!e) return e.failure();
  const double far = ellipse.centre.norm() / ellipse.semiAxes.y();
  return Measured{errorOf(*e, ref), std::max(1 + far * far, std::pow(ellipse.semiAxes.x() / ellipse.semiAxes.y(), 2))};
}
Outcome<Measured> dualRoundTrip(const Ellipse& ellipse, double multiple) {
  DualConic c = ellipse.dual();
  c.matrix *= multiple;
  const Eigen::Matrix3d& m = c.matrix;
  const Real entries[6] = {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)};
  const Outcome<Ellipse> e = toEllipse(c);
  if (!e) return e.failure();
  const double far = ellipse.centre.norm() / ellipse.semiAxes.y();
  return Measured{errorOf(*e, fromDualConic(entries)),
                  std::max(1 + far * far, std::pow(ellipse.semiAxes.x() / ellipse.semiAxes.y(), 2))};
}

/// The minimiser of sum (a x^2 + b x y + c y^2 + d x + e y + f)^2 under 4 a c - b^2 = 1 (Halir and Flusser), from the normal
/// equations, which fifty digits can bear: det(M - lambda K) = 0 has one positive root.
RealEllipse fitted(const std::vector<Pixel>& points) {
  Real mx = 0, my = 0;
  for (const Pixel& p : points) mx += p.x(), my += p.y();
  mx /= Real(double(points.size()));
  my /= Real(double(points.size()));
  Real unit = 0;
  for (const Pixel& p : points) unit = std::max({unit, Real(abs(p.x() - mx)), Real(abs(p.y() - my))});
  Real s[6][6] = {};
  for (const Pixel& p : points) {
    const Real x = (p.x() - mx) / unit, y = (p.y() - my) / unit;
    const Real row[6] = {x * x, x * y, y * y, x, y, Real(1)};
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) s[i][j] += row[i] * row[j];
  }
  // T = -S3^-1 S2^T, M = S1 + S2 T.
  Vec<Real> t[3];
  const Vec<Real> s3[3] = {{s[3][3], s[3][4], s[3][5]}, {s[4][3], s[4][4], s[4][5]}, {s[5][3], s[5][4], s[5][5]}};
  for (int j = 0; j < 3; ++j) t[j] = solve3(s3[0], s3[1], s3[2], Vec<Real>{-s[3][j], -s[4][j], -s[5][j]});
  Real m[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m[i][j] = s[i][j] + s[i][3] * t[j].x + s[i][4] * t[j].y + s[i][5] * t[j].z;
  const auto shifted = [&](const Real& lambda, Vec<Real> row[3]) {  // M - lambda K, K = [0 0 2; 0 -1 0; 2 0 0]
    row[0] = {m[0][0], m[0][1], m[0][2] - 2 * lambda};
    row[1] = {m[1][0], m[1][1] + lambda, m[1][2]};
    row[2] = {m[2][0] - 2 * lambda, m[2][1], m[2][2]};
  };
  const auto determinant = [&](const Real& lambda) {
    Vec<Real> row[3];
    shifted(lambda, row);
    return dot(row[0], cross(row[1], row[2]));
  };
  // Exact points give lambda = 0; the determinant, a cubic, has its only other sign change among lambda >= 0 there.
  Real lambda = 0;
  const Real scale = m[0][0] + m[1][1] + m[2][2];
  if (determinant(Real(0)) > scale * scale * scale * Real("1e-140")) {
    Real high = scale * Real("1e-40");
    while (determinant(high) > 0) high *= 4;
    lambda = rootBetween<Real>(determinant, Real(0), high);
  }
  Vec<Real> row[3];
  shifted(lambda, row);
  Vec<Real> a = cross(row[0], row[1]);
  for (const Vec<Real>& other : {cross(row[1], row[2]), cross(row[2], row[0])})
    if (length(other) > length(a)) a = other;
  const Real d = a.x * t[0].x + a.y * t[1].x + a.z * t[2].x, e = a.x * t[0].y + a.y * t[1].y + a.z * t[2].y,
             f = a.x * t[0].z + a.y * t[1].z + a.z * t[2].z;
  const Real det = a.x * a.z - a.y * a.y / 4;
  RealEllipse out;
  const Real cx = (a.y * e / 4 - a.z * d / 2) / det, cy = (a.y * d / 4 - a.x * e / 2) / det;
  const Real k = -(f + d * cx / 2 + e * cy / 2) / det;
  out.x = mx + unit * cx;
  out.y = my + unit * cy;
  out.p = unit * unit * k * a.z;
  out.q = -unit * unit * k * a.y / 2;
  out.r = unit * unit * k * a.x;
  return out;
}

/// `n` points over `arc` radians of an ellipse, off it by `noise` of the shorter axis in a fixed pattern.
Outcome<Measured> fitCase(const Ellipse& ellipse, int n, double arc, double noise, int repeats = 1) {
  std::vector<Pixel> points;
  for (int k = 0; k < repeats; ++k)
    for (int i = 0; i < n; ++i) {
      const double t = arc * i / n;
      Pixel p = ellipse.at(t);
      p += noise * ellipse.semiAxes.y() * Pixel(std::cos(7.0 * i * i), std::sin(5.0 * i * i));
      points.push_back(p);
    }
  const Outcome<Ellipse> e = fitEllipse(points);
  if (!e) return e.failure();
  // Pixels are round numbers of their own size; on an arc the far side swings by about (2 pi / arc)^4.
  const double far = 1 + ellipse.centre.norm() / ellipse.semiAxes.y();
  return Measured{errorOf(*e, fitted(points)), far * std::pow(2 * std::numbers::pi / arc, 4)};
}

/// Outline of an ellipsoid by P Q* P^T in full.
Outcome<Measured> outlineCase(const Ellipsoid& ellipsoid, const Projection& projection, double condition) {
  const Vec<Real> c = exactly<Real>(ellipsoid.centre());
  Real q[4][4], p[3][4], pq[3][4] = {}, dual[6];
  Vec<Real> axis[3];
  for (int i = 0; i < 3; ++i)
    axis[i] = Real(ellipsoid.semiAxes()(i)) * exactly<Real>(Eigen::Vector3d(ellipsoid.worldFromBody().linear().col(i)));
  const auto at = [](const Vec<Real>& v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; };
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      q[i][j] = at(c, i) * at(c, j);
      for (int k = 0; k < 3; ++k) q[i][j] -= at(axis[k], i) * at(axis[k], j);
    }
    q[i][3] = q[3][i] = at(c, i);
  }
  q[3][3] = 1;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) p[i][j] = projection.matrix(i, j);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) pq[i][j] += p[i][k] * q[k][j];
  int n = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      dual[n] = 0;
      for (int k = 0; k < 4; ++k) dual[n] += pq[i][k] * p[j][k];
      ++n;
    }
  const Outcome<Ellipse> e = outlineEllipse(ellipsoid, projection);
  if (!e) return e.failure();
  return Measured{errorOf(*e, fromDualConic(dual)), condition};
}

Projection projectionAt(double focal, const Eigen::Vector3d& offset) {
  Eigen::Matrix3d k;
  k << focal, 0, 319.5, 0, focal, 239.5, 0, 0, 1;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 0.5).normalized()));
  pose.pretranslate(offset);
  return {k * pose.matrix().topRows<3>()};
}
Ellipsoid ellipsoidOf(const Eigen::Vector3d& axes, const Eigen::Vector3d& centre) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()));
  pose.pretranslate(centre);
  return Ellipsoid(pose, axes);
}

}  // namespace

void addConicCases(Cases& cases) {
  const Ellipse plain{{320.25, 241.75}, {40, 25}, 0.6};
  const auto add = [&](const char* stage, const std::string& name, double parameter, double tolerance, const char* note,
                       auto run) { cases.push_back(answerCase(stage, name, parameter, tolerance, note, run)); };
  const char* const kMatrix = "the matrix's own rounding: its entries hold (distance / axis)^2 beside 1";
  add("conic", "ellipse of 1 px at 2,000 px from the origin", 2000, 64 * kRound * 1.6e7, kMatrix, [] {
    return conicRoundTrip({{1600, 1200}, {0.6, 0.5}, 0.3}, 1);
  });
  add("conic", "dual conic of an ellipse of 1 px at 2,000 px", 2000, 1e-9, "", [] {
    return dualRoundTrip({{1600, 1200}, {0.6, 0.5}, 0.3}, 1);
  });
  add("conic", "ellipse of 0.01 px at 10,000 px from the origin", 1e4, 64 * kRound * 1e12, kMatrix, [] {
    return conicRoundTrip({{8000, 6000}, {0.012, 0.01}, 0.3}, 1);
  });
  add("conic", "axis ratio 1e-5", 1e-5, 64 * kRound * 1e10, "the shorter axis is a difference in entries 1e10 times larger", [] {
    return conicRoundTrip({{0, 0}, {100, 1e-3}, 0.7}, 1);
  });
  add("conic", "matrix times 1e-290", 1e-290, 1e-9, "", [plain] { return conicRoundTrip(plain, 1e-290); });
  add("conic", "dual matrix times 1e+290", 1e290, 1e-9, "", [plain] { return dualRoundTrip(plain, 1e290); });
  add("ellipse fit", "highlight of 1e-3 px at 500 px", 1e-3, 1e-9, "", [] {
    return fitCase({{400, 300}, {1e-3, 7e-4}, 0.4}, 36, 2 * std::numbers::pi, 0.02);
  });
  add("ellipse fit", "highlight of 1e6 px", 1e6, 1e-9, "", [] {
    return fitCase({{320, 240}, {1e6, 4e5}, 0.4}, 36, 2 * std::numbers::pi, 0.02);
  });
  add("ellipse fit", "pixels shifted by 1e6", 1e6, 1e-9, "", [] {
    return fitCase({{1e6, -1e6}, {40, 25}, 0.4}, 36, 2 * std::numbers::pi, 0.02);
  });
  add("ellipse fit", "axis ratio 1e-6", 1e-6, 1e-9, "", [] {
    return fitCase({{320, 240}, {100, 1e-4}, 0.4}, 36, 2 * std::numbers::pi, 0.02);
  });
  add("ellipse fit", "arc of 20 degrees, exact points", 20, 256 * kRound * 1.4e6,
      "the far side swings by (360 / 20)^4 times the points' rounding", [] {
        return fitCase({{320, 240}, {40, 25}, 0.4}, 36, std::numbers::pi / 9, 0);
      });
  add("ellipse fit", "every point 50 times", 50, 1e-9, "", [] {
    return fitCase({{320, 240}, {40, 25}, 0.4}, 36, 2 * std::numbers::pi, 0.05, 50);
  });
  add("outline", "ellipsoid 1e-6 of its distance", 1e-6, 1e-9, "", [] {
    return outlineCase(ellipsoidOf({1e-6, 7e-7, 4e-7}, {0.1, -0.1, 1}), projectionAt(800, {0, 0, 0.5}), 1e6);
  });
  add("outline", "focal length 50 px", 50, 1e-9, "", [] {
    return outlineCase(ellipsoidOf({0.3, 0.2, 0.12}, {0.1, -0.1, 1}), projectionAt(50, {0, 0, 0.5}), 1);
  });
  add("outline", "focal length 50,000 px", 5e4, 1e-9, "", [] {
    return outlineCase(ellipsoidOf({0.3, 0.2, 0.12}, {0.1, -0.1, 1}), projectionAt(5e4, {0, 0, 0.5}), 1);
  });
  add("outline", "one zero axis", 0, 1e-9, "", [] {
    return outlineCase(ellipsoidOf({0.3, 0.2, 0}, {0.1, -0.1, 1}), projectionAt(800, {0, 0, 0.5}), 1);
  });
  add("outline", "ellipsoid of 1e8 m at 1e9 m", 1e9, 1e-9, "", [] {
    return outlineCase(ellipsoidOf({1e8, 7e7, 4e7}, {1e8, -1e8, 1e9}), projectionAt(800, {0, 0, 0.5}), 1);
  });
  {
    Case c;
    c.stage = "outline";
    c.name = "two zero axes";
    c.note = "the outline of a segment is a segment";
    c.expect = Expect::Failure;
    c.reasons = {Reason::NotAnEllipsoid};
    c.run = []() -> Outcome<Measured> {
      Eigen::Matrix3d shape = Eigen::Matrix3d::Zero();
      shape(0, 0) = 0.09;
      const Outcome<Ellipsoid> e = Ellipsoid::fromCentreAndShape({0.1, -0.1, 1}, shape);
      if (!e) return e.failure();
      return Measured{0, 1};
    };
    cases.push_back(c);
  }
}

}  // namespace glint::stability

// SPDX-License-Identifier: BSD-3-Clause
#include "viz/quadric_wire.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace glint::viz {
namespace {

constexpr int kMeridians = 12, kRings = 8, kSteps = 96;
constexpr double kFlat = 1e-12;  // share of the largest squared axis that counts as zero, as in the core's describe()

/// Gathers curves, cut where they leave the sphere about the region.
class Cutter {
 public:
  Cutter(QuadricWire& wire, const Eigen::AlignedBox3d& region)
      : wire_(wire), centre_(region.center()), radius_(0.5 * region.diagonal().norm()) {}
  template <class Curve>
  void add(Curve&& curve, double from, double to, int steps = kSteps) {
    Points chain;
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector3d p = curve(from + (to - from) * i / steps);
      if (p.allFinite() && (p - centre_).norm() <= radius_) {
        chain.push_back(p);
        continue;
      }
      flush(chain);
    }
    flush(chain);
  }
  double radius() const { return radius_; }
  const Eigen::Vector3d& centre() const { return centre_; }

 private:
  void flush(Points& chain) {
    if (chain.size() > 1) wire_.curves.push_back(chain);
    chain.clear();
  }
  QuadricWire& wire_;
  Eigen::Vector3d centre_;
  double radius_;
};

/// Largest parameter of cosh or sinh that can still lie in the sphere.
double longest(double axis, double reach) { return std::min(std::asinh(reach / std::max(axis, 1e-9 * reach)) + 1, 30.0); }

/// One sheet or two, with centre c: axes of positive and of negative squares.
void hyperboloid(Cutter& cutter, const Eigen::Vector3d& c, const std::vector<Eigen::Vector3d>& real,
                 const std::vector<Eigen::Vector3d>& imaginary) {
  const double reach = (cutter.centre() - c).norm() + cutter.radius();
  constexpr double kTurn = 2 * std::numbers::pi;
  if (real.size() == 2) {
    const double end = longest(imaginary[0].norm(), reach);
    const auto at = [&](double t, double turn) -> Eigen::Vector3d {
      return c + std::cosh(t) * (std::cos(turn) * real[0] + std::sin(turn) * real[1]) + std::sinh(t) * imaginary[0];
    };
    for (int i = 0; i < kMeridians; ++i) cutter.add([&](double t) { return at(t, kTurn * i / kMeridians); }, -end, end);
    for (int i = -kRings / 2; i <= kRings / 2; ++i)
      cutter.add([&](double turn) { return at(end * 2 * i / kRings, turn); }, 0, kTurn);
  } else {
    const double end = longest(std::max(imaginary[0].norm(), imaginary[1].norm()), reach);
    for (const double side : {-1.0, 1.0}) {
      const auto at = [&](double t, double turn) -> Eigen::Vector3d {
        return c + side * std::cosh(t) * real[0] + std::sinh(t) * (std::cos(turn) * imaginary[0] + std::sin(turn) * imaginary[1]);
      };
      for (int i = 0; i < kMeridians; ++i) cutter.add([&](double t) { return at(t, kTurn * i / kMeridians); }, 0, end);
      for (int i = 1; i <= kRings; ++i) cutter.add([&](double turn) { return at(end * i / kRings, turn); }, 0, kTurn);
    }
  }
}

void central(QuadricWire& wire, Cutter& cutter, const Eigen::Vector3d& c, const Eigen::Matrix3d& shape) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(shape);
  const double largest = eigen.eigenvalues().cwiseAbs().maxCoeff();
  std::vector<Eigen::Vector3d> real, imaginary;
  for (int i = 0; i < 3; ++i) {
    const double s = eigen.eigenvalues()(i);
    if (std::abs(s) <= kFlat * largest) continue;
    (s > 0 ? real : imaginary).push_back(std::sqrt(std::abs(s)) * eigen.eigenvectors().col(i));
  }
  wire.anchor = c;
  constexpr double kTurn = 2 * std::numbers::pi;
  const std::size_t rank = real.size() + imaginary.size();
  if (rank == 3 && !real.empty() && !imaginary.empty()) {
    hyperboloid(cutter, c, real, imaginary);
  } else if (real.size() >= 2) {  // an ellipsoid, flat or not: its principal ellipses
    for (std::size_t i = 0; i < real.size(); ++i) {
      for (std::size_t j = i + 1; j < real.size(); ++j)
        cutter.add([&](double t) -> Eigen::Vector3d { return c + std::cos(t) * real[i] + std::sin(t) * real[j]; }, 0, kTurn);
    }
  } else if (rank == 2 && real.size() == 1) {  // flat: a hyperbola in a plane
    const double end = longest(imaginary[0].norm(), (cutter.centre() - c).norm() + cutter.radius());
    for (const double side : {-1.0, 1.0})
      cutter.add([&](double t) -> Eigen::Vector3d { return c + side * std::cosh(t) * real[0] + std::sinh(t) * imaginary[0]; },
                 -end, end);
  } else if (rank == 1 && real.size() == 1) {
    cutter.add([&](double t) -> Eigen::Vector3d { return c + t * real[0]; }, -1, 1);
  } else {  // imaginary, or a point: no real surface
    const double least = 0.02 * cutter.radius();
    if (imaginary.empty())
      for (int i = 0; i < 3; ++i) imaginary.push_back(least * Eigen::Vector3d::Unit(i));
    for (Eigen::Vector3d a : imaginary) {
      if (a.norm() < least) a = least * a.normalized();
      if (a.norm() > cutter.radius()) a = cutter.radius() * a.normalized();
      wire.axes.emplace_back(c - a, c + a);
    }
  }
}

/// Q* of full rank without a centre: the points of the surface satisfy x^T E x + 2 f.x + g = 0 with E of rank 2.
void paraboloid(Cutter& cutter, const Eigen::Matrix4d& dual) {
  const Eigen::Matrix4d point = dual.inverse();
  if (!point.allFinite()) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(point.topLeftCorner<3, 3>());
  Eigen::Index axis = 0;
  eigen.eigenvalues().cwiseAbs().minCoeff(&axis);
  const int u = static_cast<int>((axis + 1) % 3), v = static_cast<int>((axis + 2) % 3);
  const Eigen::Vector3d origin = cutter.centre();
  const Eigen::Vector3d slope = point.topLeftCorner<3, 3>() * origin + point.topRightCorner<3, 1>();
  const double value = origin.homogeneous().dot(point * origin.homogeneous());
  const Eigen::Matrix3d e = eigen.eigenvectors();
  const Eigen::Vector3d f = e.transpose() * slope;
  if (f(axis) == 0) return;
  const auto at = [&](double a, double b) -> Eigen::Vector3d {
    const double rest = eigen.eigenvalues()(u) * a * a + eigen.eigenvalues()(v) * b * b + 2 * (f(u) * a + f(v) * b) + value;
    return origin + a * e.col(u) + b * e.col(v) - rest / (2 * f(axis)) * e.col(axis);
  };
  const double r = cutter.radius();
  for (int i = -kRings; i <= kRings; ++i) {
    const double fixed = r * i / kRings;
    cutter.add([&](double t) { return at(fixed, t); }, -r, r);
    cutter.add([&](double t) { return at(t, fixed); }, -r, r);
  }
}

}  // namespace

QuadricWire wireOf(const DualQuadric& quadric, const Eigen::AlignedBox3d& region) {
  QuadricWire wire;
  wire.kind = describe(quadric);
  wire.anchor = region.center();
  if (!quadric.matrix.allFinite() || quadric.matrix.cwiseAbs().maxCoeff() == 0) return wire;
  Cutter cutter(wire, region);
  const Eigen::Matrix4d q = quadric.matrix / quadric.matrix.cwiseAbs().maxCoeff();
  if (q(3, 3) != 0) {
    const Eigen::Vector3d c = q.topRightCorner<3, 1>() / q(3, 3);
    const Eigen::Matrix3d upper = q.topLeftCorner<3, 3>() / q(3, 3);
    const Eigen::Matrix3d shape = c * c.transpose() - 0.5 * (upper + upper.transpose());
    if (!c.allFinite() || !shape.allFinite()) return wire;
    central(wire, cutter, c, shape);
  } else {
    paraboloid(cutter, q);
  }
  // The label is where the wire comes nearest to the region's centre.
  double nearest = std::numeric_limits<double>::infinity();
  for (const Points& curve : wire.curves) {
    for (const Eigen::Vector3d& p : curve) {
      if ((p - cutter.centre()).norm() >= nearest) continue;
      nearest = (p - cutter.centre()).norm();
      wire.anchor = p;
    }
  }
  return wire;
}

}  // namespace glint::viz

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/surface/added_shape.h"

namespace glint::example {

/// |x/a|^n + |y/b|^n + |z/c|^n = 1: an ellipsoid for n = 2, near a box for n = 8.
class Superellipsoid final : public AnalyticShape {
 public:
  Superellipsoid(const Eigen::Vector3d& axes, double exponent) : axes_(axes), n_(exponent) {}
  std::string describe() const override { return "superellipsoid"; }
  double value(const Eigen::Vector3d& p) const override { return p.cwiseQuotient(axes_).array().abs().pow(n_).sum() - 1; }
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const override {
    const Eigen::Array3d q = p.cwiseQuotient(axes_).array();
    return (n_ * q.sign() * q.abs().pow(n_ - 1) / axes_.array()).matrix();
  }
  Eigen::Matrix3d hessian(const Eigen::Vector3d& p) const override {
    const Eigen::Array3d q = p.cwiseQuotient(axes_).array();
    return (n_ * (n_ - 1) * q.abs().pow(n_ - 2) / axes_.array().square()).matrix().asDiagonal();
  }
  /// Along a line the value is convex: it has a lowest point, and a root on each side of it or none.
  LineRoots roots(const Eigen::Vector3d& o, const Eigen::Vector3d& d) const override {
    const auto at = [&](double t) { return value(o + t * d); };
    const double middle = -o.dot(d), reach = 2 * axes_.norm();  // the shape lies in a ball of half of that about its centre
    const double lowest = bisected([&](double t) { return gradient(o + t * d).dot(d); }, middle - reach, middle + reach);
    LineRoots found;
    if (!(at(lowest) < 0)) return found;
    found.add(bisected([&](double t) { return -at(t); }, middle - reach, lowest));
    found.add(bisected(at, lowest, middle + reach));
    return found;
  }
  double size() const override { return axes_.maxCoeff(); }
  Eigen::AlignedBox3d bounds(const Eigen::Isometry3d& worldFromLocal) const override {
    Eigen::AlignedBox3d box;
    for (int corner = 0; corner < 8; ++corner)
      box.extend(worldFromLocal * Eigen::Vector3d((corner & 1 ? 1 : -1) * axes_.x(), (corner & 2 ? 1 : -1) * axes_.y(),
                                                  (corner & 4 ? 1 : -1) * axes_.z()));
    return box;
  }
  std::vector<Eigen::Vector3d> grid(int, int, const Eigen::Vector3d&, double) const override { return {}; }
  bool bounded() const override { return true; }

 private:
  /// Where a function that is negative at `low` and positive at `high` changes its sign.
  static double bisected(const std::function<double(double)>& f, double low, double high) {
    for (int i = 0; i < 200 && low < high; ++i) {  // until two neighbouring doubles are left
      const double middle = 0.5 * (low + high);
      if (middle == low || middle == high) break;
      (f(middle) < 0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

  Eigen::Vector3d axes_;
  double n_;
};

class SuperellipsoidKind final : public ShapeKind {
 public:
  std::string name() const override { return "superellipsoid"; }
  std::vector<ShapeNumber> numbers() const override {
    return {{"a", 1e-3, 1e3}, {"b", 1e-3, 1e3}, {"c", 1e-3, 1e3}, {"exponent", 2, 8, 2.0}};
  }
  std::unique_ptr<const AnalyticShape> make(const std::map<std::string, double>& n) const override {
    return std::make_unique<Superellipsoid>(Eigen::Vector3d(n.at("a"), n.at("b"), n.at("c")), n.at("exponent"));
  }
};

}  // namespace glint::example

// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>

#include "core/advise/camera_check.h"

namespace glint {
namespace {
using Eigen::Matrix3d, Eigen::Vector3d;

/// Slope and bend at a place, in steps.
struct Quadric {
  Vector3d slope;
  Matrix3d bend;

  /// To its least value; where it does not bend upwards, down the slope.
  Vector3d down() const {
    constexpr double kFlat = 1e-3;   // of the largest bend: rounding beside it
    constexpr double kFarthest = 8;  // steps: the quadric says nothing about what lies farther away
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(bend);
    const Eigen::Array3d bends = axes.eigenvalues().array().abs();
    if (!(bends.maxCoeff() > 0)) return Vector3d::Zero();
    const Eigen::Array3d along = (axes.eigenvectors().transpose() * slope).array() / bends.max(kFlat * bends.maxCoeff());
    const Vector3d step = -(axes.eigenvectors() * along.matrix());
    const double length = step.norm();
    return length > kFarthest ? Vector3d(kFarthest / length * step) : step;
  }
};

}  // namespace

Vector3d lowestPlace(const Vector3d& from, double step, const std::function<std::optional<double>(const Vector3d&)>& cost) {
  constexpr int kRounds = 4;
  constexpr double kEnough = 0.9;  // of the value before: less is gained by a further round
  Vector3d at = from;
  std::optional<double> here = cost(at);
  if (!here) return from;
  const auto quadricAt = [&](const Vector3d& place, double value) -> std::optional<Quadric> {
    Quadric q;
    Vector3d up;
    for (int i = 0; i < 3; ++i) {
      const Vector3d along = step * Vector3d::Unit(i);
      const std::optional<double> u = cost(place + along), d = cost(place - along);
      if (!u || !d) return std::nullopt;
      up[i] = *u;
      q.slope[i] = (*u - *d) / 2;
      q.bend(i, i) = *u + *d - 2 * value;
      for (int k = 0; k < i; ++k) {
        const std::optional<double> both = cost(place + along + step * Vector3d::Unit(k));
        if (!both) return std::nullopt;
        q.bend(i, k) = q.bend(k, i) = *both - up[i] - up[k] + value;
      }
    }
    return q;
  };
  for (int round = 0; round < kRounds; ++round) {
    const double before = *here;
    if (const std::optional<Quadric> q = quadricAt(at, before))
      for (double part = 1; part > 0.2 && *here == before; part /= 2) {
        const Vector3d there = at + part * step * q->down();
        if (const std::optional<double> value = cost(there); value && *value < before) at = there, here = value;
      }
    if (*here == before)
      step /= 2;
    else if (*here > kEnough * before)
      break;
  }
  return at;
}

}  // namespace glint

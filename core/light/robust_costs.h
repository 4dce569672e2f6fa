// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <deque>
#include <vector>

namespace glint {

/// The costs of all points as one block of residuals, which Ceres evaluates several times as fast as hundreds of blocks. Huber's
/// loss rho (Huber 1964) is in it as r -> sign(r) sqrt(rho(r^2)): the same sum of squares, smooth where the two branches meet.
/// @tparam CostFunction  ceres::CostFunction, which headers of core do not include
/// @tparam PointCost     a ceres::CostFunction of one residual over at most three blocks of parameters, the same for every point
template <class CostFunction, class PointCost>
class RobustCosts final : public CostFunction {
 public:
  /// @param points     at least one; PointCost is made of each and of `arguments`
  /// @param scale      of Huber's loss, in the unit of the residuals, > 0
  template <class Point, class... Arguments>
  RobustCosts(const std::vector<Point>& points, double scale, Arguments... arguments) : scale_(scale) {
    for (const Point& p : points) costs_.emplace_back(p, arguments...);
    this->set_num_residuals(int(points.size()));
    *this->mutable_parameter_block_sizes() = costs_.front().parameter_block_sizes();
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const std::vector<int>& sizes = this->parameter_block_sizes();
    std::array<double*, 3> rows{};
    for (std::size_t i = 0; i < costs_.size(); ++i) {
      for (std::size_t b = 0; b < sizes.size(); ++b)
        rows[b] = jacobians && jacobians[b] ? jacobians[b] + i * std::size_t(sizes[b]) : nullptr;
      double& r = residuals[i];
      if (!costs_[i].Evaluate(parameters, &r, jacobians ? rows.data() : nullptr)) return false;
      const double size = std::abs(r);
      if (!(size > scale_)) continue;
      const double root = std::sqrt(scale_ * (2 * size - scale_)), slope = scale_ / root;
      r = std::copysign(root, r);
      for (std::size_t b = 0; b < sizes.size(); ++b)
        for (int j = 0; rows[b] && j < sizes[b]; ++j) rows[b][j] *= slope;
    }
    return true;
  }

 private:
  std::deque<PointCost> costs_;  // cost functions cannot be moved
  double scale_;
};

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// One block of residuals with Huber's loss inside, against Ceres's own loss on a block per point.
#include "core/light/robust_costs.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "tests/tolerances.h"

namespace glint {
namespace {

struct Point {
  double x, y;
};

/// y - (a0 + a1 x) b
class LineCost final : public ceres::SizedCostFunction<1, 2, 1> {
 public:
  explicit LineCost(const Point& p, double factor = 1) : p_(p), factor_(factor) {}
  bool Evaluate(double const* const* q, double* r, double** jacobians) const override {
    if (!std::isfinite(p_.y)) return false;
    const double line = q[0][0] + q[0][1] * p_.x;
    *r = factor_ * (p_.y - line * q[1][0]);
    if (jacobians && jacobians[0]) jacobians[0][0] = -factor_ * q[1][0], jacobians[0][1] = -factor_ * p_.x * q[1][0];
    if (jacobians && jacobians[1]) jacobians[1][0] = -factor_ * line;
    return true;
  }

 private:
  Point p_;
  double factor_;
};

using Together = RobustCosts<ceres::CostFunction, LineCost>;

constexpr double kScale = 0.7, kFactor = 1.5;

std::vector<Point> scattered(double spread) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> noise(0, 1);  // zero is no legal standard deviation
  std::vector<Point> points;
  for (int i = 0; i < 40; ++i) points.push_back({0.1 * i, 1 + 2 * (0.1 * i) + spread * noise(engine)});
  return points;
}

struct Value {
  double cost = 0;
  std::vector<double> gradient;
};
Value valueOf(ceres::Problem& problem) {
  Value v;
  EXPECT_TRUE(problem.Evaluate({}, &v.cost, nullptr, &v.gradient, nullptr));
  return v;
}

TEST(RobustCosts, CostAndGradientAreThoseOfHubersLossOnEveryPoint) {
  for (const double spread : {0.0, 0.3, 3.0, 300.0}) {
    const std::vector<Point> points = scattered(spread);
    double line[2] = {0.8, 2.2}, height = 1.1;
    ceres::Problem single, together;
    for (const Point& p : points) single.AddResidualBlock(new LineCost(p, kFactor), new ceres::HuberLoss(kScale), line, &height);
    together.AddResidualBlock(new Together(points, kScale, kFactor), nullptr, line, &height);
    const Value expected = valueOf(single), got = valueOf(together);
    EXPECT_NEAR(got.cost / expected.cost, 1, tolerance::kExact) << spread;
    ASSERT_EQ(got.gradient.size(), expected.gradient.size());
    double size = 0;  // single entries may cancel
    for (const double g : expected.gradient) size += std::abs(g);
    for (std::size_t i = 0; i < got.gradient.size(); ++i)
      EXPECT_NEAR(got.gradient[i], expected.gradient[i], tolerance::kExact * size) << spread << ", " << i;
  }
}

TEST(RobustCosts, ABlockThatIsHeldAsksForNoDerivative) {
  double line[2] = {0.8, 2.2}, height = 1.25;
  ceres::Problem problem;
  problem.AddResidualBlock(new Together(scattered(0), kScale), nullptr, line, &height);
  problem.SetParameterBlockConstant(&height);
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_EQ(height, 1.25);
  EXPECT_NEAR(line[0], 1 / 1.25, tolerance::kSolve);
  EXPECT_NEAR(line[1], 2 / 1.25, tolerance::kSolve);
}

TEST(RobustCosts, APointThatCannotBeEvaluatedFailsAll) {
  std::vector<Point> points = scattered(1);
  points[20].y = std::nan("");
  double line[2] = {0.8, 2.2}, height = 1.1, cost = 0;
  ceres::Problem problem;
  problem.AddResidualBlock(new Together(points, kScale), nullptr, line, &height);
  EXPECT_FALSE(problem.Evaluate({}, &cost, nullptr, nullptr, nullptr));
}

}  // namespace
}  // namespace glint

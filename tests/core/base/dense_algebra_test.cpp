// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/dense_algebra.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/tolerances.h"

namespace glint {
namespace {

// R^T R = A^T A for A = Q R, whatever the signs; by hand 3 4 0, 0 0 5 over columns: |r11| = 5, |r12| = 0, |r22| = 5.
TEST(TriangularFactor, HasTheProductsOfTheRows) {
  Eigen::MatrixXd known(3, 2);
  known << 3, 0, 4, 0, 0, 5;
  const Eigen::MatrixXd small = triangularFactor(known);
  EXPECT_NEAR(std::abs(small(0, 0)), 5, tolerance::kExact);
  EXPECT_NEAR(small(0, 1), 0, tolerance::kExact);
  EXPECT_NEAR(std::abs(small(1, 1)), 5, tolerance::kExact);

  for (const double scale : {1e-150, 1.0, 1e150}) {
    const Eigen::MatrixXd rows = scale * Eigen::MatrixXd::NullaryExpr(40, 10, [](Eigen::Index i, Eigen::Index j) {
                                   return std::sin(double(1 + i * j) + 0.1 * double(i));
                                 });
    const Eigen::MatrixXd r = triangularFactor(rows);
    ASSERT_EQ(r.rows(), 10);
    ASSERT_EQ(r.cols(), 10);
    EXPECT_EQ(r.triangularView<Eigen::StrictlyLower>().toDenseMatrix().norm(), 0);
    EXPECT_LT(((r / scale).transpose() * (r / scale) - (rows / scale).transpose() * (rows / scale)).norm(),
              40 * tolerance::kExact)
        << scale;
  }
}

TEST(TriangularFactor, OfTooFewRowsIsRefused) {
  EXPECT_THROW((void)triangularFactor(Eigen::MatrixXd::Zero(3, 4)), std::invalid_argument);
  EXPECT_EQ(triangularFactor(Eigen::MatrixXd::Zero(4, 4)).norm(), 0);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/tolerances.h"

namespace glint {
namespace {

// One and two degrees of freedom have closed forms: tan(pi c / 2) and c sqrt(2 / (1 - c^2)). The others are of printed tables.
TEST(StudentFactor, AgreesWithClosedFormsAndTables) {
  for (const double c : {0.1, 0.5, 0.9, 0.95, 0.999}) {
    EXPECT_NEAR(studentFactor(c, 1) / std::tan(M_PI * c / 2), 1, 1e-10) << c;
    EXPECT_NEAR(studentFactor(c, 2) / (c * std::sqrt(2 / (1 - c * c))), 1, 1e-10) << c;
  }
  EXPECT_NEAR(studentFactor(0.95, 5), 2.571, 5e-4);
  EXPECT_NEAR(studentFactor(0.95, 30), 2.042, 5e-4);
  EXPECT_NEAR(studentFactor(0.99, 120), 2.617, 5e-4);
  EXPECT_NEAR(studentFactor(0.95, 1e5), 1.96, 5e-4);
  EXPECT_NEAR(studentFactor(0.95, 1e9), 1.9599639845400545, tolerance::kSolve);
  EXPECT_NEAR(studentFactor(0.95, 0.9e6), studentFactor(0.95, 1.1e6), 1e-5) << "where the formula changes";
}

TEST(StudentFactor, RefusesWhatIsNoProbability) {
  for (const double c : {0.0, 1.0, -0.5, double(NAN)}) EXPECT_THROW((void)studentFactor(c, 5), std::invalid_argument) << c;
  EXPECT_THROW((void)studentFactor(0.9, 0), std::invalid_argument);
}

}  // namespace
}  // namespace glint

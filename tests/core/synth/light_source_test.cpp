// SPDX-License-Identifier: BSD-3-Clause
#include "core/synth/light_source.h"

#include <gtest/gtest.h>

#include <cmath>

namespace glint {
namespace {

constexpr double kStated = 1e-7;  // of log I, down to a thousandth of the peak (light_source.cpp)

/// A lobe of width w about a direction that leaves the lamp's centre by `off`, gathered over the lamp.
double gathered(const TrueLight& lamp, double w, double off, double ruleWidth) {
  const Eigen::Vector3d axis(std::sin(off), 0, std::cos(off));
  double sum = 0;
  for (const LightSample& s : sampleLight(lamp.lamp, Eigen::Vector3d::Zero(), ruleWidth)) {
    const double angle = std::atan2(s.direction.cross(axis).norm(), s.direction.dot(axis));
    sum += s.weight * std::exp(-angle * angle / (w * w));
  }
  return sum;
}

// Against the richest rule, which a lobe that is narrow without bounds asks for. Each ratio of lamp to lobe is the largest that
// its rule serves.
TEST(LightSource, SpheresAreAsExactAsStated) {
  TrueLight lamp;
  lamp.lamp = lampAt(Eigen::Vector3d(0, 0, 2));
  for (const double ratio : {0.01, 0.05, 0.5, 1.0, 2.0, 4.0}) {
    lamp.lamp = withRadius(lamp.lamp, 0.02);
    const double w = std::atan2(radiusOf(lamp.lamp), 2.0) / (ratio * (1 - 1e-9));
    // A lobe that has fallen to a thousandth: exp(-2.63^2).
    for (const double off : {0.0, 1.0, 2.63})
      EXPECT_NEAR(std::log(gathered(lamp, w, off * w, w) / gathered(lamp, w, off * w, 1e-9)), 0, kStated) << ratio << ", " << off;
  }
}

TEST(LightSource, SmallSpheresTakeFewSamples) {
  TrueLight lamp;
  lamp.lamp = lampAt(Eigen::Vector3d(0, 0, 2));
  lamp.lamp = withRadius(lamp.lamp, 0.01);
  EXPECT_LE(sampleLight(lamp.lamp, Eigen::Vector3d::Zero(), 0.2).size(), 12u);
}

}  // namespace
}  // namespace glint

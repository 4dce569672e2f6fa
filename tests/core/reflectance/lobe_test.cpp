// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/lobe.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/reflectance/light_radiance.h"
#include "core/synth/light_source.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using Real = long double;
const Real kPi = std::acos(-1.0L);

struct Geometry {
  Eigen::Vector3d n, l, v;
};

Geometry geometry(double thetaL, double thetaV, double phi) {
  return {Eigen::Vector3d::UnitZ(), Eigen::Vector3d(std::sin(thetaL), 0, std::cos(thetaL)),
          Eigen::Vector3d(std::sin(thetaV) * std::cos(phi), std::sin(thetaV) * std::sin(phi), std::cos(thetaV))};
}

/// The same quantities from angles, in long double, by the textbook forms.
struct Angles {
  Real l, v, h;
};
Angles anglesOf(const Geometry& g) {
  const Eigen::Matrix<Real, 3, 1> l = g.l.cast<Real>().normalized(), v = g.v.cast<Real>().normalized(), h = (l + v).normalized();
  return {std::acos(l.z()), std::acos(v.z()), std::atan2(std::hypot(h.x(), h.y()), h.z())};
}

Real beckmannLambdaExact(Real m, Real theta) {
  if (theta == 0) return 0;
  const Real a = 1 / (m * std::tan(theta));
  return (std::erf(a) - 1) / 2 + std::exp(-a * a) / (2 * a * std::sqrt(kPi));
}

TEST(EqTorranceSparrow, AgreesWithLongDouble) {
  for (const double m : {0.05, 0.144, 0.5})
    for (const double l : {0.0, 0.3, 1.0, 1.4})
      for (const double v : {0.1, 0.7, 1.3}) {
        const Geometry g = geometry(l, v, 2.9);
        const Angles a = anglesOf(g);
        const Real t = std::tan(a.h), c = std::cos(a.h);
        const Real d = std::exp(-t * t / (Real(m) * m)) / (kPi * m * m * c * c * c * c);
        const Real masking = 1 / (1 + beckmannLambdaExact(m, a.l) + beckmannLambdaExact(m, a.v));
        const Real expected = std::log(d) + std::log(masking / (4 * std::cos(a.v)));
        if (!std::isfinite(expected)) continue;
        const auto log = logRadiance(Lobe::TorranceSparrow, m, g.n, g.l, g.v);
        ASSERT_TRUE(log);
        EXPECT_NEAR(log->total(), static_cast<double>(expected), 1e-11 * (1 + std::abs(static_cast<double>(expected))))
            << m << " " << l << " " << v;
      }
}

TEST(EqGgx, AgreesWithLongDouble) {
  for (const double m : {0.05, 0.3, 0.8})
    for (const double l : {0.2, 1.2})
      for (const double v : {0.1, 1.3}) {
        const Geometry g = geometry(l, v, 1.0);
        const Angles a = anglesOf(g);
        const Real m2 = Real(m) * m, t = std::tan(a.h), c = std::cos(a.h);
        const auto lambda = [&](Real theta) { return (std::sqrt(1 + m2 * std::tan(theta) * std::tan(theta)) - 1) / 2; };
        const Real d = m2 / (kPi * c * c * c * c * (m2 + t * t) * (m2 + t * t));
        const Real expected = std::log(d / (1 + lambda(a.l) + lambda(a.v)) / (4 * std::cos(a.v)));
        const auto log = logRadiance(Lobe::Ggx, m, g.n, g.l, g.v);
        ASSERT_TRUE(log);
        EXPECT_NEAR(log->total(), static_cast<double>(expected), 1e-11 * (1 + std::abs(static_cast<double>(expected))));
      }
}

/// A distribution of slopes: the integral of D cos(theta_h) over the hemisphere is 1. Recovered from log I at normal incidence of
/// both, where H = N would not vary; so L = V, H = L, is swept over the hemisphere.
TEST(EqTorranceSparrow, DistributionIsNormalised) {
  for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx})
    for (const double m : {0.1, 0.4}) {
      double sum = 0;
      constexpr int kSteps = 200000;
      for (int i = 0; i < kSteps; ++i) {
        const double theta = M_PI / 2 * (i + 0.5) / kSteps;
        const Geometry g = geometry(theta, theta, 0);
        sum += std::exp(logRadiance(lobe, m, g.n, g.l, g.v)->lobe) * std::cos(theta) * 2 * M_PI * std::sin(theta) *
               (M_PI / 2 / kSteps);
      }
      EXPECT_NEAR(sum, 1, 1e-4) << nameOf(lobe) << " " << m;  // the sum's own error with GGX's long tail
    }
}

TEST(Lobes, AllFallAsTheSameGaussianNearThePeak) {
  // exp(-(theta_h / m)^2): the curvature of log I at the mirror direction is -2 / m^2 in theta_h (terms of order 1 aside).
  const double m = 0.02, theta = 0.002;
  for (const Lobe lobe : {Lobe::Phong, Lobe::BlinnPhong, Lobe::TorranceSparrow, Lobe::Ggx}) {
    const Geometry at = geometry(0, 0, 0), off = geometry(2 * theta, 0, 0);
    const double drop = logRadiance(lobe, m, at.n, at.l, at.v)->lobe - logRadiance(lobe, m, off.n, off.l, off.v)->lobe;
    const double expected = lobe == Lobe::Ggx ? 2 * theta * theta / (m * m) : theta * theta / (m * m);
    EXPECT_NEAR(drop, expected, 0.01 * expected) << nameOf(lobe);
  }
}

TEST(Lobes, BelowTheHorizonIsDark) {
  const Geometry g = geometry(1.7, 0.3, 0);
  for (const Lobe lobe : {Lobe::Phong, Lobe::BlinnPhong, Lobe::TorranceSparrow, Lobe::Ggx}) {
    EXPECT_FALSE(logRadiance(lobe, 0.1, g.n, g.l, g.v));
    EXPECT_FALSE(logRadiance(lobe, 0.1, g.n, g.v, g.l));
  }
  EXPECT_THROW((void)logRadiance(Lobe::Ggx, 0, g.n, g.v, g.v), std::invalid_argument);
  EXPECT_EQ(lobeOf("torrance-sparrow"), Lobe::TorranceSparrow);
  EXPECT_FALSE(lobeOf("lambert"));
}

/// log of the mean over a disc of radius `radius` about `light`, facing `point`: Simpson's rule in the squared radius, equal
/// steps around.
double denseLog(Lobe lobe, double m, const Eigen::Vector3d& n, const Eigen::Vector3d& v, const Eigen::Vector3d& light,
                double radius) {
  constexpr int kSquares = 400, kAround = 480;
  const Eigen::Vector3d side = light.unitOrthogonal(), up = light.normalized().cross(side);
  double sum = 0;
  for (int i = 0; i <= kSquares; ++i) {
    const double r = radius * std::sqrt(double(i) / kSquares), weight = i == 0 || i == kSquares ? 1 : i % 2 ? 4 : 2;
    for (int k = 0; k < kAround; ++k) {
      const double t = 2 * M_PI * k / kAround;
      const Eigen::Vector3d l = light + r * (std::cos(t) * side + std::sin(t) * up);
      const std::optional<LogRadiance> value = logRadiance(lobe, m, n, l.normalized(), v);
      if (value) sum += weight / (3.0 * kSquares * kAround) * std::exp(value->total()) / l.squaredNorm();
    }
  }
  return std::log(sum);
}

// From lamps far narrower than the lobe to six times as wide, at the peak, at the lamp's edge and at the highlight's foot.
TEST(SphereLight, AgreesWithADenseQuadrature) {
  const double m = 0.03;
  const Eigen::Vector3d n = Eigen::Vector3d::UnitZ();
  for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong})
    for (const double slant : {0.2, 1.1})
      for (const double ratio : {0.1, 0.3, 0.8, 1.7, 3.0, 6.0}) {
        const Eigen::Vector3d v(std::sin(slant), 0, std::cos(slant));
        const double radius = 2 * std::tan(ratio * 2 * m * std::cos(slant)), edge = std::atan(radius / 2);
        for (const double off : {0.0, edge, edge + 1.5 * m}) {
          const Eigen::Vector3d light = 2 * Eigen::Vector3d(-std::sin(slant - off), 0, std::cos(slant - off));
          Eigen::Vector4d l;
          l << light, 1;
          const Lamp lamp{l, SphereShape<>::of(radius)};
          const lobe::LampRule rule = lobe::lampRuleFor(lamp.shape, lobe::lampRatio(m, Eigen::Vector3d::Zero(), v, lamp));
          const auto value = lobe::logOfLamp<double>(lobe, m, Eigen::Vector3d::Zero(), n, v, lamp, rule);
          ASSERT_TRUE(value);
          EXPECT_NEAR(*value, denseLog(lobe, m, n, v, light, radius), 3e-5)
              << nameOf(lobe) << " " << slant << " " << ratio << " " << off;
        }
      }
}

double irradiance(const TrueLight& light, const Eigen::Vector3d& point, const Eigen::Vector3d& n) {
  double sum = 0;
  for (const LightSample& s : sampleLight(light.lamp, point)) sum += s.weight * std::max(0.0, n.dot(s.direction));
  return sum;
}

TEST(SampleLight, ASphereFacingThePointGivesTheInverseSquareLaw) {
  // A uniform sphere above the horizon has the irradiance of a point at its centre, whatever its radius (Lambert).
  for (const double radius : {0.0, 0.01, 0.3, 0.9}) {
    TrueLight light;
    light.lamp = lampAt(Eigen::Vector3d(0, 0, 2));
    light.lamp = withRadius(light.lamp, radius);
    EXPECT_NEAR(irradiance(light, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()), 0.25, 1e-12) << radius;
  }
}

TEST(SampleLight, ATubeAgreesWithTheClosedForm) {
  // Tube of length 2a along x, centred above the point at height h, intensity (2 / pi) / a dx sin(psi), facing plane:
  // E = (4 / pi) (1 / 2a) int h^2 / (h^2 + x^2)^2 dx = (4 / pi) (1 / 2a) (a / (a^2 + h^2) + atan(a / h) / h).
  const double a = 0.7, h = 1.3;
  TrueLight light;
  light.lamp = segmentLamp(Eigen::Vector3d(-a, 0, h), Eigen::Vector3d(a, 0, h));
  const double expected = 4 / M_PI / (2 * a) * (a / (a * a + h * h) + std::atan(a / h) / h);
  EXPECT_NEAR(irradiance(light, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()), expected, 1e-12);
}

}  // namespace
}  // namespace glint

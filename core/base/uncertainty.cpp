// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/uncertainty.h"

#include <cmath>
#include <numbers>

#include "core/base/outcome.h"

namespace glint {
namespace {

/// Continued fraction of the incomplete beta function I_x(a, b) by Lentz's method; converges fast for x < (a + 1) / (a + b + 2).
double betaFraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300;  // stands for 0 in a denominator, as Lentz's method asks
  double c = 1, d = 1 - (a + b) * x / (a + 1);
  d = 1 / (std::abs(d) < kTiny ? kTiny : d);
  double h = d;
  for (int m = 1; m < 300; ++m) {
    for (const double term : {m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)), -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))}) {
      d = 1 + term * d;
      d = 1 / (std::abs(d) < kTiny ? kTiny : d);
      c = 1 + term / c;
      if (std::abs(c) < kTiny) c = kTiny;
      h *= c * d;
    }
    if (std::abs(c * d - 1) < 1e-15) break;  // the next factors are 1 in double precision
  }
  return h;
}

/// Share of a Student distribution outside +-t: I_{n / (n + t^2)}(n / 2, 1 / 2).
double outside(double t, double n) {
  const double a = 0.5 * n, b = 0.5, x = n / (n + t * t), y = t * t / (n + t * t);
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) - a * std::log1p(t * t / n) + b * std::log(y));
  return x < (a + 1) / (a + b + 2) ? front * betaFraction(a, b, x) / a : 1 - front * betaFraction(b, a, y) / b;
}

}  // namespace

double studentFactor(double coverage, double degreesOfFreedom) {
  require(coverage > 0 && coverage < 1 && degreesOfFreedom > 0, "studentFactor: coverage in (0, 1), dof > 0");
  // Beyond a million the lgammas cancel; the normal distribution is then the same to 1e-6.
  const auto share = [&](double t) { return degreesOfFreedom > 1e6 ? std::erfc(t / std::numbers::sqrt2) : outside(t, degreesOfFreedom); };
  double low = 0, high = 1;
  while (share(high) > 1 - coverage && high < 1e12) low = high, high *= 2;
  for (int i = 0; i < 200 && high - low > 1e-13 * high; ++i) {  // the share has about thirteen digits
    const double middle = 0.5 * (low + high);
    (share(middle) > 1 - coverage ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace glint

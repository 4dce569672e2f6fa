// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "core/base/image.h"
#include "core/geometry/polyline.h"

/// Images with a closed form, for the tests of detection.
namespace glint::test {

/// An elliptic Gaussian K exp(-(u/a)^2 - (v/b)^2) in axes turned by `angle`; its level set q is an ellipse with
/// semi-axes a sqrt(-ln q), b sqrt(-ln q).
struct Blob {
  Pixel centre{100.3, 80.7};
  double a = 30, b = 18, angle = 0.4, height = 2;

  double at(const Pixel& p) const {
    const Pixel d = p - centre;
    const double u = std::cos(angle) * d.x() + std::sin(angle) * d.y(), v = -std::sin(angle) * d.x() + std::cos(angle) * d.y();
    return height * std::exp(-(u / a) * (u / a) - (v / b) * (v / b));
  }
  Polyline levelSet(double level, int n = 720) const {
    Polyline line;
    const double s = std::sqrt(-std::log(level));
    for (int i = 0; i < n; ++i) {
      const double t = 2 * M_PI * i / n, u = s * a * std::cos(t), v = s * b * std::sin(t);
      line.points.push_back(centre + Pixel(std::cos(angle) * u - std::sin(angle) * v, std::sin(angle) * u + std::cos(angle) * v));
    }
    return line;
  }
};

template <class F>
Image drawn(int width, int height, const F& value) {
  Image image(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.at(x, y) = static_cast<float>(value(Pixel(x, y)));
  return image;
}

inline void addNoise(Image& image, double sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma);
  for (float& v : image.data) v = std::max(0.f, v + static_cast<float>(normal(random)));
}

/// Symmetric mean distance over arc length (method.md section 10), by brute force.
inline double meanDistance(const Polyline& a, const Polyline& b, int n = 400) {
  double sum = 0;
  for (const Pixel& p : resample(a, n)) sum += distance(b, p);
  for (const Pixel& p : resample(b, n)) sum += distance(a, p);
  return sum / (2 * n);
}

inline double largestDistance(const Polyline& a, const Polyline& b, int n = 400) {
  double worst = 0;
  for (const Pixel& p : resample(a, n)) worst = std::max(worst, distance(b, p));
  for (const Pixel& p : resample(b, n)) worst = std::max(worst, distance(a, p));
  return worst;
}

}  // namespace glint::test

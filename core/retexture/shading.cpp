// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/shading.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/numeric.h"
#include "core/retexture/pixels.h"
#include "core/surface/occlusion.h"

namespace glint {
namespace {

constexpr double kMostHighlight = 0.5;   // of a pixel's light: beyond, what is left of it is the highlight's own error
constexpr int kLeastShadedPixels = 100;  // for a handful of unknowns
constexpr int kRounds = 8;               // of robust weights: they settle in about five
constexpr double kTukey = 4.7;           // Tukey's weights keep 95 % of the efficiency under Gaussian noise
constexpr double kMadToSigma = 1.4826;   // of a Gaussian

/// E_l per pixel: N.L / r^2, 1 at the mean distance of the frame for a light at infinity too.
struct Irradiance {
  std::vector<std::vector<float>> byLight;
  std::vector<char> onSurface;
};

Irradiance irradianceOf(const Surface& surface, const Camera& camera, const std::vector<Light>& lights,
                        const ProgressFn& progress) {
  const std::size_t pixels = std::size_t(camera.width) * std::size_t(camera.height);
  Irradiance e{std::vector(lights.size(), std::vector<float>(pixels, 0.f)), std::vector<char>(pixels, 0)};
  const Eigen::Vector3d eye = camera.centreInWorld();
  forEachSurfacePixel(
      camera, surface,
      [&](std::size_t i, const SurfacePoint& p) {
        e.onSurface[i] = 1;
        for (std::size_t l = 0; l < lights.size(); ++l) {
          const double cosine = p.normal.dot(lights[l].directionFrom(p.position));
          if (!(cosine > 0)) continue;
          const double squared = lights[l].atInfinity() ? 1 : (lights[l].position() - p.position).squaredNorm();
          const double value = cosine / squared;
          if (!std::isfinite(value)) continue;
          const Eigen::Vector3d target = occlusionTarget(surface, p.position, lights[l], (eye - p.position).norm());
          if (!surface.occluded(p, target)) e.byLight[l][i] = float(value);
        }
      },
      progress, "shading");
  // So that numbers are of one size, whatever the unit of length.
  for (std::vector<float>& of : e.byLight) {
    double sum = 0, n = 0;
    for (const float v : of)
      if (v > 0) sum += v, ++n;
    if (n > 0 && sum > 0)
      for (float& v : of) v = float(v / (sum / n));
  }
  return e;
}

struct ShadeSample {
  Eigen::VectorXd row;
  double value;
};

/// Weighted least squares with coefficients >= 0: negative ones are taken out, the most negative first.
Eigen::VectorXd nonNegative(const std::vector<ShadeSample>& samples, const std::vector<double>& weights) {
  const Eigen::Index n = samples.front().row.size();
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    normal.noalias() += weights[i] * samples[i].row * samples[i].row.transpose();
    right += weights[i] * samples[i].value * samples[i].row;
  }
  constexpr double kRidge = 1e-9;  // of the diagonal: a light that lights nothing, or two that cannot be told apart
  normal.diagonal() *= 1 + kRidge;
  normal.diagonal().array() += kRidge * std::max(std::numeric_limits<double>::min(), normal.diagonal().maxCoeff());
  std::vector<char> out(std::size_t(n), 0);
  Eigen::VectorXd solution = Eigen::VectorXd::Zero(n);
  for (Eigen::Index round = 0; round <= n; ++round) {
    Eigen::MatrixXd m = normal;
    Eigen::VectorXd r = right;
    for (Eigen::Index k = 0; k < n; ++k)
      if (out[std::size_t(k)]) m.row(k).setZero(), m.col(k).setZero(), m(k, k) = 1, r(k) = 0;
    solution = m.ldlt().solve(r);
    Eigen::Index worst = 0;
    if (!solution.allFinite() || solution.minCoeff(&worst) >= 0) break;
    out[std::size_t(worst)] = 1;
  }
  return solution.cwiseMax(0);
}

}  // namespace

Outcome<LambertShading> fitLambert(const Surface& surface, const Camera& camera, const std::vector<Light>& lights,
                                   const ShadedFrame& frame, const ProgressFn& progress) {
  require(!lights.empty(), "fitLambert: at least one light");
  require(frame.linear.width == camera.width && frame.linear.height == camera.height && frame.linear.channels == 3 &&
              frame.highlight.data.size() == frame.linear.data.size() && 3 * frame.usable.size() == frame.linear.data.size(),
          "fitLambert: images of the camera's size");
  Irradiance e = irradianceOf(surface, camera, lights, progress);
  const Eigen::Index unknowns = Eigen::Index(lights.size()) + 1;
  const auto rowAt = [&](std::size_t i) {
    Eigen::VectorXd row(unknowns);
    row(0) = 1;
    for (std::size_t l = 0; l < lights.size(); ++l) row(Eigen::Index(l) + 1) = e.byLight[l][i];
    return row;
  };
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < e.onSurface.size(); ++i)
    if (e.onSurface[i] && frame.usable[i]) places.push_back(i);
  if (std::none_of(e.onSurface.begin(), e.onSurface.end(), [](char c) { return c != 0; }))
    return Failure{Reason::NoSurface, "no pixel of the frame shows the surface"};
  constexpr std::size_t kMostPixels = 30000;  // a denser grid changes four numbers by less than their noise
  const std::size_t stride = std::max<std::size_t>(1, places.size() / kMostPixels);
  std::vector<ShadeSample> samples;
  for (std::size_t k = 0; k < places.size(); k += stride) {
    const std::size_t i = places[k];
    double light = 0, highlight = 0;
    for (std::size_t c = 0; c < 3; ++c)
      light += frame.linear.data[3 * i + c] / 3, highlight += frame.highlight.data[3 * i + c] / 3;
    if (highlight > kMostHighlight * light) continue;
    samples.push_back({rowAt(i), light - highlight});
  }
  if (int(samples.size()) < kLeastShadedPixels)
    return Failure{Reason::TooFewPoints, "too few pixels beside the highlight show the surface's shading"};
  std::vector<double> weights(samples.size(), 1);
  Eigen::VectorXd solution;
  double squares = 0, sum = 0, weight = 0;
  for (int round = 0; round < kRounds; ++round) {
    solution = nonNegative(samples, weights);
    std::vector<double> residuals;
    for (const ShadeSample& s : samples) residuals.push_back(std::abs(s.value - s.row.dot(solution)));
    const double scale = kTukey * kMadToSigma * upperMedian(residuals);
    squares = sum = weight = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double t = scale > 0 ? residuals[i] / scale : 0;
      weights[i] = t < 1 ? (1 - t * t) * (1 - t * t) : 0;
      squares += residuals[i] * residuals[i];
      sum += samples[i].value;
      weight += 1;
    }
  }
  if (!solution.allFinite()) return Failure{Reason::NotFinite, "the surface's shading"};
  LambertShading result{Image(camera.width, camera.height, 1), std::move(e.onSurface), solution(0), {}, 0};
  for (std::size_t l = 0; l < lights.size(); ++l) result.byLight.push_back(solution(Eigen::Index(l) + 1));
  result.relativeRms = sum > 0 ? std::sqrt(squares / weight) / (sum / weight) : 0;
  for (std::size_t i = 0; i < result.onSurface.size(); ++i)
    if (result.onSurface[i]) result.shade.data[i] = float(rowAt(i).dot(solution));
  return result;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/model/reconstruct.h"

namespace glint {
namespace {
Ellipsoid truth() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()));
  return Ellipsoid(pose, {0.3, 0.2, 0.12});
}
/// n views from a ring of 2 m around the ellipsoid, 72 contour points each with 0.5 px of noise.
std::vector<ConicView> views(int n) {
  std::mt19937 rng(1);
  std::normal_distribution<double> noise(0, 0.5);
  std::vector<ConicView> result;
  for (int i = 0; i < n; ++i) {
    const double a = 0.3 + 2 * std::numbers::pi * i / n;
    const Eigen::Vector3d from(2 * std::cos(a), 2 * std::sin(a), 0.9), z = -from.normalized();
    const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d k, r;
    k << 800, 0, 320, 0, 800, 240, 0, 0, 1;
    r << x.transpose(), z.cross(x).transpose(), z.transpose();
    ConicView v;
    v.projection.matrix << k * r, k * (r * -from);
    v.points = outlineEllipse(truth(), v.projection)->sample(72);
    for (Pixel& p : v.points) p += Pixel(noise(rng), noise(rng));
    v.ellipse = *fitEllipse(v.points);
    result.push_back(v);
  }
  return result;
}

void fit(benchmark::State& state) {
  const std::vector<Pixel> points = views(1)[0].points;
  for (auto _ : state) benchmark::DoNotOptimize(fitEllipse(points));
}
void linear(benchmark::State& state) {
  const std::vector<ConicView> v = views(int(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(reconstructLinear(v));
}
void anchored(benchmark::State& state) {
  const std::vector<ConicView> v = views(int(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(reconstructAnchored(v, truth().centre()));
}
void refined(benchmark::State& state) {
  const std::vector<ConicView> v = views(int(state.range(0)));
  const Ellipsoid start = *reconstructLinear(v)->ellipsoid;
  for (auto _ : state) benchmark::DoNotOptimize(reconstructRefined(v, start));
}
BENCHMARK(fit)->Unit(benchmark::kMicrosecond);
BENCHMARK(linear)->Arg(6)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(anchored)->Arg(6)->Unit(benchmark::kMicrosecond);
BENCHMARK(refined)->Arg(6)->Unit(benchmark::kMicrosecond);
}  // namespace
}  // namespace glint

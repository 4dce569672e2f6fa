// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "core/geometry/plane.h"
#include "core/surface/brightest_point.h"
#include "core/surface/level_set.h"
#include "core/surface/mesh.h"
#include "tests/core/surface/surfaces.h"

namespace glint {
namespace {

using Eigen::Vector3d;

AnalyticSpec ellipsoid() { return test::ellipsoid(0.6, 0.35, 0.25); }

/// The ellipsoid as a mesh of n^2 2 triangles (708: one million), built once per policy.
const Surface& bigMesh(NormalPolicy policy) {
  static std::shared_ptr<const Surface> meshes[3];
  std::shared_ptr<const Surface>& mesh = meshes[static_cast<int>(policy)];
  if (!mesh) mesh = makeMesh(makeAnalytic(ellipsoid())->tessellate(Eigen::AlignedBox3d(), 708), policy);
  return *mesh;
}

Camera camera() { return test::lookAt({0.4, -1.5, 1.4}, {0, 0, 0}); }
Light light() { return Light::at({0.9, -0.6, 2.0}); }

std::vector<Ray> someRays() {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Ray> rays;
  for (int i = 0; i < 4096; ++i) rays.push_back(camera().ray({320 + 120 * u(rng), 240 + 60 * u(rng)}));
  return rays;
}

void meshBuild(benchmark::State& state) {
  const TriangleMesh mesh = makeAnalytic(ellipsoid())->tessellate(Eigen::AlignedBox3d(), 708);
  for (auto _ : state) benchmark::DoNotOptimize(makeMesh(mesh, NormalPolicy::Interpolated));
}
BENCHMARK(meshBuild)->Unit(benchmark::kMillisecond)->Iterations(2);

void firstHit(benchmark::State& state) {
  const Surface& mesh = bigMesh(static_cast<NormalPolicy>(state.range(0)));
  const std::vector<Ray> rays = someRays();
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(mesh.firstHit(rays[i++ & 4095]));
}
BENCHMARK(firstHit)->Arg(0)->Arg(1)->Arg(2);

void approximateHitsPerRay(benchmark::State& state) {
  const Surface& mesh = bigMesh(NormalPolicy::Interpolated);
  std::vector<Ray> rays;
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 40; ++i) rays.push_back(camera().ray({16.0 * i, 16.0 * j}));
  for (auto _ : state) benchmark::DoNotOptimize(mesh.approximateHits(rays));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * rays.size()));
}
BENCHMARK(approximateHitsPerRay);

/// The walk of a canonical prediction: 36 directions, 6 feet each, from the brightest point outwards over about 3 cm.
void feetOfOnePrediction(benchmark::State& state) {
  const Surface& mesh = bigMesh(static_cast<NormalPolicy>(state.range(0)));
  const auto found = predictedBrightestPoints(bigMesh(NormalPolicy::Interpolated), camera(), light());
  if (!found) return state.SkipWithError(found.failure().message().c_str());
  const SurfacePoint start = facing(*mesh.firstHit(camera().ray((*found)[0].pixel)), camera().centreInWorld());
  const Eigen::Matrix<double, 3, 2> basis = tangentBasis(start.normal);
  for (auto _ : state)
    for (int k = 0; k < 36; ++k) {
      const Vector3d d = basis * Eigen::Vector2d(std::cos(k * M_PI / 18), std::sin(k * M_PI / 18));
      SurfacePoint previous = start;
      for (int i = 1; i <= 6; ++i) {
        const Outcome<SurfacePoint> foot = mesh.foot(start.position + 0.005 * i * d, start.normal, previous);
        if (!foot) break;
        previous = *foot;
      }
      benchmark::DoNotOptimize(previous);
    }
}
BENCHMARK(feetOfOnePrediction)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMicrosecond);

void predictedBrightest(benchmark::State& state) {
  const Surface& mesh = bigMesh(static_cast<NormalPolicy>(state.range(0)));
  const Camera c = camera();
  BrightestPointOptions options;
  if (state.range(1) > 0) options.seedStepPx = static_cast<double>(state.range(1));
  for (auto _ : state) benchmark::DoNotOptimize(predictedBrightestPoints(mesh, c, light(), options));
}
BENCHMARK(predictedBrightest)
    ->Args({0, 0})
    ->Args({1, 0})
    ->Args({2, 0})
    ->Args({1, 12})
    ->Args({1, 16})
    ->Args({1, 20})
    ->Unit(benchmark::kMicrosecond);

void predictedBrightestAnalytic(benchmark::State& state) {
  const auto surface = makeAnalytic(ellipsoid());
  const Camera c = camera();
  for (auto _ : state) benchmark::DoNotOptimize(predictedBrightestPoints(*surface, c, light()));
}
BENCHMARK(predictedBrightestAnalytic)->Unit(benchmark::kMicrosecond);

/// A component about 60 px wide, by exact field calls only.
void levelSet(benchmark::State& state) {
  const auto analytic = makeAnalytic(ellipsoid());
  const Surface& surface = state.range(0) ? bigMesh(NormalPolicy::Interpolated) : *analytic;
  const Camera c = camera();
  const Vector3d eye = c.centreInWorld();
  const Light l = light();
  std::size_t calls = 0;
  const PixelField alpha = [&](const Pixel& p) -> std::optional<double> {
    ++calls;
    const Outcome<SurfacePoint> hit = surface.firstHit(c.ray(p));
    if (!hit) return std::nullopt;
    const SurfacePoint q = facing(*hit, eye);
    return incidentAngle(q.normal, l.directionFrom(q.position), (eye - q.position).normalized());
  };
  LevelSetOptions options;
  options.seeds = {(*predictedBrightestPoints(surface, c, l))[0].pixel};
  double width = 0, vertices = 0;
  calls = 0;
  for (auto _ : state) {
    const std::vector<LevelSetComponent> found = traceLevelSets(alpha, {}, 7 * M_PI / 180, c.width, c.height, options);
    Eigen::AlignedBox2d box;
    for (const Pixel& p : found.at(0).outline.points) box.extend(p);
    width = box.sizes().maxCoeff();
    vertices = static_cast<double>(found[0].outline.points.size());
  }
  state.counters["width_px"] = width;
  state.counters["vertices"] = vertices;
  state.counters["calls"] = static_cast<double>(calls) / static_cast<double>(state.iterations());
}
BENCHMARK(levelSet)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
// Times of the main job: detection, light, fit, prediction. One thread. docs/performance.md is made from these.
#include <benchmark/benchmark.h>

#include "core/light/estimate.h"
#include "core/model/fit_ellipsoid.h"
#include "core/model/models.h"
#include "core/model/walk.h"
#include "core/surface/mesh.h"
#include "core/synth/synth.h"
#include "tests/core/model/exact_views.h"

namespace glint {
namespace {

/// 80 cameras around an ellipsoid; six of them train.
const test::Synthetic& scene() {
  static const test::Synthetic s = test::ellipsoidScene(80);
  return s;
}
const FitInput& training() {
  static const FitInput input = [] {
    test::Synthetic few = scene();
    few.cameras.clear();
    for (int i = 0; i < 6; ++i) few.cameras.push_back(scene().cameras[i * 80 / 6]);
    return test::fitInput(few, {});
  }();
  return input;
}
const ModelFit& fitOf(const std::string& model) {
  static std::map<std::string, ModelFit> fits;
  if (!fits.count(model)) fits.emplace(model, *modelByName(model).fit(training(), {}));
  return fits.at(model);
}

/// The ellipsoid itself, or as a mesh of 708^2 2 triangles: one million.
const Surface& surface(bool mesh) {
  static const std::shared_ptr<const Surface> analytic = makeAnalytic(scene().surface);
  static std::shared_ptr<const Surface> million;
  if (mesh && !million) million = makeMesh(analytic->tessellate(Eigen::AlignedBox3d(), 708), NormalPolicy::Interpolated);
  return mesh ? *million : *analytic;
}

/// Frames that do not train, one after another.
void predict(benchmark::State& state, const std::string& model, bool mesh, const std::vector<std::string>& set = {}) {
  const HighlightModel& m = modelByName(model);
  const ModelFit& fit = fitOf(model);
  const Surface& s = surface(mesh);
  Settings settings;
  for (const std::string& v : set) settings.setFromText(v.substr(0, v.find('=')), v.substr(v.find('=') + 1));
  std::size_t frame = 1, found = 0, calls = 0;
  double coverage = 0;
  for (auto _ : state) {
    const Prediction p = m.predict(fit, scene().cameras[frame], &s, settings);
    found += p.highlights.size();
    for (const PredictedHighlight& h : p.highlights) coverage += h.coverage;
    ++calls;
    frame = (frame + 7) % scene().cameras.size();
  }
  state.counters["highlights"] = static_cast<double>(found) / static_cast<double>(calls);
  state.counters["coverage"] = found ? coverage / static_cast<double>(found) : 0;
}
void canonicalPredictionMesh(benchmark::State& state) { predict(state, "canonical", true); }
void canonicalPredictionAnalytic(benchmark::State& state) { predict(state, "canonical", false); }
void dualPredictionMesh(benchmark::State& state) { predict(state, "dual", true); }
void limitAnglePredictionMesh(benchmark::State& state) { predict(state, "limit-angle", true); }
void limitAnglePredictionAnalytic(benchmark::State& state) { predict(state, "limit-angle", false); }
const std::string kHints = "predict.search=hints", kQuadric = "predict.query=local-quadric", kStar = "predict.contour=star";
void canonicalPredictionMeshHints(benchmark::State& state) { predict(state, "canonical", true, {kHints}); }
void canonicalPredictionMeshQuadric(benchmark::State& state) { predict(state, "canonical", true, {kQuadric, kHints}); }
void canonicalPredictionMeshQuadricGrid(benchmark::State& state) { predict(state, "canonical", true, {kQuadric}); }
void limitAnglePredictionMeshStar(benchmark::State& state) { predict(state, "limit-angle", true, {kStar, kHints}); }
void limitAnglePredictionMeshStarGrid(benchmark::State& state) { predict(state, "limit-angle", true, {kStar}); }
void limitAnglePredictionMeshQuadric(benchmark::State& state) { predict(state, "limit-angle", true, {kQuadric, kHints}); }
BENCHMARK(canonicalPredictionMeshHints)->Unit(benchmark::kMicrosecond);
BENCHMARK(canonicalPredictionMeshQuadric)->Unit(benchmark::kMicrosecond);
BENCHMARK(canonicalPredictionMeshQuadricGrid)->Unit(benchmark::kMicrosecond);
BENCHMARK(limitAnglePredictionMeshStar)->Unit(benchmark::kMicrosecond);
BENCHMARK(limitAnglePredictionMeshStarGrid)->Unit(benchmark::kMicrosecond);
BENCHMARK(limitAnglePredictionMeshQuadric)->Unit(benchmark::kMicrosecond);
BENCHMARK(canonicalPredictionMesh)->Unit(benchmark::kMicrosecond);
BENCHMARK(canonicalPredictionAnalytic)->Unit(benchmark::kMicrosecond);
BENCHMARK(dualPredictionMesh)->Unit(benchmark::kMicrosecond);
BENCHMARK(limitAnglePredictionMesh)->Unit(benchmark::kMicrosecond);
BENCHMARK(limitAnglePredictionAnalytic)->Unit(benchmark::kMicrosecond);

/// Only the search of the brightest point, and only the walk: which part of a prediction costs what.
void partBrightestPointMesh(benchmark::State& state) {
  const Light light = *fitOf("canonical").lightEstimate;
  const Settings settings;
  BrightestPointOptions options;
  options.seedStepPx = settings.number("predict.seed_step");  // as the models do
  std::size_t frame = 1;
  for (auto _ : state) {
    benchmark::DoNotOptimize(predictedBrightestPoints(surface(true), scene().cameras[frame], light, options));
    frame = (frame + 7) % scene().cameras.size();
  }
}
BENCHMARK(partBrightestPointMesh)->Unit(benchmark::kMicrosecond);

void partWalkMesh(benchmark::State& state) {
  const ModelFit& fit = fitOf("canonical");
  const Camera& camera = scene().cameras[8];
  const auto found = predictedBrightestPoints(surface(true), camera, *fit.lightEstimate, BrightestPointOptions{});
  const TangentWalk walk(surface(true), camera, found->at(0), *fit.lightEstimate);
  const Outcome<Ellipse> ellipse = outlineEllipse(*fit.ellipsoid, virtualCamera(camera, walk.tangentPlane()));
  for (auto _ : state) benchmark::DoNotOptimize(predictFromEllipse(walk, surface(true), camera, *ellipse, 36));
}
BENCHMARK(partWalkMesh)->Unit(benchmark::kMicrosecond);

std::vector<BundleView> bundleViews(bool mesh) {
  std::vector<BundleView> views;
  for (const TrainingView& v : training().views)
    views.push_back({v.camera, &surface(mesh), v.highlight.contour.points, v.brightest});
  return views;
}
Light triangulated() {
  std::vector<ReflectedRay> rays;
  for (const TrainingView& v : training().views) rays.push_back(reflectedRay(*v.brightest, v.camera));
  return triangulateLight(rays)->light;
}
void bundle(benchmark::State& state, bool mesh) {
  const std::vector<BundleView> views = bundleViews(mesh);
  const Light start = triangulated();
  for (auto _ : state) benchmark::DoNotOptimize(bundleLight(views, start));
}
void bundleAnalytic(benchmark::State& state) { bundle(state, false); }
void bundleMesh(benchmark::State& state) { bundle(state, true); }
BENCHMARK(bundleAnalytic)->Unit(benchmark::kMillisecond);
BENCHMARK(bundleMesh)->Unit(benchmark::kMillisecond);

/// Light, canonical contours and the refined ellipsoid: from six views to a model.
void refinedWithBundle(benchmark::State& state, bool mesh) {
  std::vector<TrainingView> views = training().views;
  if (mesh)
    for (TrainingView& v : views) v.surface = std::shared_ptr<const Surface>(&surface(true), [](const Surface*) {});
  for (TrainingView& v : views) v.highlight.contour = Polyline{resample(v.highlight.contour, 72), true};
  const Settings settings;
  for (auto _ : state) {
    FitInput input{views, *estimateLight(views, settings), {}};
    for (TrainingView& v : input.views) addCanonicalContour(v, input.light->light, settings);
    benchmark::DoNotOptimize(modelByName("canonical").fit(input, settings));
  }
}
void refinedWithBundleAnalytic(benchmark::State& state) { refinedWithBundle(state, false); }
void refinedWithBundleMesh(benchmark::State& state) { refinedWithBundle(state, true); }
BENCHMARK(refinedWithBundleAnalytic)->Unit(benchmark::kMillisecond);
BENCHMARK(refinedWithBundleMesh)->Unit(benchmark::kMillisecond);

/// The fit of the canonical model alone, by each solver, from 72-point canonical contours.
void fitOnly(benchmark::State& state, const std::string& solver) {
  Settings settings;
  settings.setFromText("predict.directions", "72");
  FitInput input = training();
  for (TrainingView& v : input.views) addCanonicalContour(v, input.light->light, settings);
  settings.setFromText("fit.solver", solver);
  for (auto _ : state) benchmark::DoNotOptimize(modelByName("canonical").fit(input, settings));
}
void fitLinear(benchmark::State& state) { fitOnly(state, "linear"); }
void fitAnchored(benchmark::State& state) { fitOnly(state, "anchored"); }
void fitRefined(benchmark::State& state) { fitOnly(state, "refined"); }
BENCHMARK(fitLinear)->Unit(benchmark::kMillisecond);
BENCHMARK(fitAnchored)->Unit(benchmark::kMillisecond);
BENCHMARK(fitRefined)->Unit(benchmark::kMillisecond);

void canonicalContourOfOneView(benchmark::State& state) {
  TrainingView view = training().views[2];
  view.surface = std::shared_ptr<const Surface>(&surface(true), [](const Surface*) {});
  const Outcome<BrightestPoint> brightest = observedBrightestPoint(*view.surface, view.camera, view.highlight.peak);
  view.brightest = *brightest;
  const Settings settings;
  for (auto _ : state) {
    addCanonicalContour(view, training().light->light, settings);
    benchmark::DoNotOptimize(view.canonical);
  }
}
BENCHMARK(canonicalContourOfOneView)->Unit(benchmark::kMicrosecond);

void detectOneFrame(benchmark::State& state) {
  Material material;
  const RenderedFrame frame = renderFrame(surface(false), scene().cameras[8], {scene().light}, material);
  DetectOptions options;
  for (auto _ : state) benchmark::DoNotOptimize(detectHighlights(frame.specular, nullptr, options));
  state.SetLabel(std::to_string(frame.specular.width) + " x " + std::to_string(frame.specular.height));
}
BENCHMARK(detectOneFrame)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace glint

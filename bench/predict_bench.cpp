// SPDX-License-Identifier: BSD-3-Clause
// Times of the main job: detection, light, fit, prediction. One thread. docs/performance.md is made from these.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>

#include "core/base/progress.h"
#include "core/light/estimate.h"
#include "core/model/fit_ellipsoid.h"
#include "core/model/models.h"
#include "core/model/walk.h"
#include "core/pipeline/comparison.h"
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
  if (!fits.count("reflectance")) {
    // The contours above are those of a limit angle; a prediction asks only for a lobe.
    for (const auto& [name, radius] : {std::pair("reflectance", 0.0), std::pair("reflectance-disc", 0.15)}) {
      fits[name].lightEstimate = test::lightOf(scene().light);
      fits[name].family = ReflectanceFit{Lobe::TorranceSparrow, 0.1, 0.5, sphereLamp(*fits[name].lightEstimate, radius).shape};
    }
  }
  if (!fits.count(model)) {
    Settings settings;
    settings.setFromText("fit.most_residual", "10");  // the time is of interest, even if `dual` leaves too much
    fits.emplace(model, *modelByName(model).fit(training(), settings));
  }
  return fits.at(model);
}

constexpr int kMillion = 1'000'000;

/// The ellipsoid as a mesh of about that many triangles, interpolated normals; 0: the analytic surface.
const Surface& surfaceOf(int triangles) {
  static std::map<int, std::shared_ptr<const Surface>> surfaces;
  std::shared_ptr<const Surface>& s = surfaces[triangles];
  if (s) return *s;
  const std::shared_ptr<const Surface> analytic = makeAnalytic(scene().surface);
  const int cells = static_cast<int>(std::lround(std::sqrt(triangles / 2.0)));
  s = triangles ? makeMesh(analytic->tessellate(Eigen::AlignedBox3d(), cells), NormalPolicy::Interpolated) : analytic;
  return *s;
}
const Surface& surface(bool mesh) { return surfaceOf(mesh ? kMillion : 0); }

/// Frames that do not train, one after another.
void predict(benchmark::State& state, const std::string& model, int triangles, const std::vector<std::string>& set = {},
             const std::string& fitName = "") {
  const HighlightModel& m = modelByName(model);
  const ModelFit& fit = fitOf(fitName.empty() ? model : fitName);
  const Surface& s = surfaceOf(triangles);
  Settings settings;
  for (const std::string& v : set) settings.setFromText(v.substr(0, v.find('=')), v.substr(v.find('=') + 1));
  std::size_t frame = 1, found = 0, calls = 0;
  double coverage = 0;
  m.predict(fit, scene().cameras[0], &s, settings);  // the first search on a mesh builds its tree
  for (auto _ : state) {
    const Prediction p = m.predict(fit, scene().cameras[frame], &s, settings);
    found += p.highlights().size();
    for (const PredictedHighlight& h : p.highlights()) coverage += h.coverage;
    ++calls;
    frame = (frame + 7) % scene().cameras.size();
  }
  state.counters["highlights"] = static_cast<double>(found) / static_cast<double>(calls);
  state.counters["coverage"] = found ? coverage / static_cast<double>(found) : 0;
}
void canonicalPredictionMesh(benchmark::State& state) { predict(state, "canonical", kMillion); }
void canonicalPredictionAnalytic(benchmark::State& state) { predict(state, "canonical", 0); }
void dualPredictionMesh(benchmark::State& state) { predict(state, "dual", kMillion); }
void limitAnglePredictionMesh(benchmark::State& state) { predict(state, "limit-angle", kMillion); }
void limitAnglePredictionAnalytic(benchmark::State& state) { predict(state, "limit-angle", 0); }
const std::string kHints = "predict.search=hints", kQuadric = "predict.query=local-quadric", kStar = "predict.contour=star";
void canonicalPredictionMeshHints(benchmark::State& state) { predict(state, "canonical", kMillion, {kHints}); }
void canonicalPredictionMeshQuadric(benchmark::State& state) { predict(state, "canonical", kMillion, {kQuadric, kHints}); }
void canonicalPredictionMeshQuadricGrid(benchmark::State& state) { predict(state, "canonical", kMillion, {kQuadric}); }
void limitAnglePredictionMeshStar(benchmark::State& state) { predict(state, "limit-angle", kMillion, {kStar, kHints}); }
void limitAnglePredictionMeshStarGrid(benchmark::State& state) { predict(state, "limit-angle", kMillion, {kStar}); }
void limitAnglePredictionMeshQuadric(benchmark::State& state) { predict(state, "limit-angle", kMillion, {kQuadric, kHints}); }
void reflectancePredictionMesh(benchmark::State& state) { predict(state, "reflectance", kMillion); }
void reflectancePredictionMeshStar(benchmark::State& state) { predict(state, "reflectance", kMillion, {kStar}); }
void reflectancePredictionMeshStarDisc(benchmark::State& state) {
  predict(state, "reflectance", kMillion, {kStar}, "reflectance-disc");
}
void reflectancePredictionAnalytic(benchmark::State& state) { predict(state, "reflectance", 0); }
void reflectancePredictionAnalyticStar(benchmark::State& state) { predict(state, "reflectance", 0, {kStar}); }
BENCHMARK(reflectancePredictionMesh)->Unit(benchmark::kMicrosecond);
BENCHMARK(reflectancePredictionMeshStar)->Unit(benchmark::kMicrosecond);
BENCHMARK(reflectancePredictionMeshStarDisc)->Unit(benchmark::kMicrosecond);
BENCHMARK(reflectancePredictionAnalytic)->Unit(benchmark::kMicrosecond);
BENCHMARK(reflectancePredictionAnalyticStar)->Unit(benchmark::kMicrosecond);
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
  const Outcome<Ellipse> ellipse = outlineEllipse(*fit.ellipsoid(), virtualCamera(camera, walk.tangentPlane()));
  for (auto _ : state) benchmark::DoNotOptimize(predictFromEllipse(walk, surface(true), camera, *ellipse, 36));
}
BENCHMARK(partWalkMesh)->Unit(benchmark::kMicrosecond);

std::vector<BundleView> bundleViews(bool mesh) {
  std::vector<BundleView> views;
  for (const TrainingView& v : training().views)
    views.push_back({v.camera, &surface(mesh), v.highlight.contour.points, v.seen->brightest});
  return views;
}
Light triangulated() {
  std::vector<ReflectedRay> rays;
  for (const TrainingView& v : training().views) rays.push_back(reflectedRay(v.seen->brightest, v.camera));
  return triangulateLight(rays)->light;
}
void bundle(benchmark::State& state, bool mesh) {
  const std::vector<BundleView> views = bundleViews(mesh);
  const Light start = triangulated();
  for (auto _ : state) benchmark::DoNotOptimize(bundleLight(views, start));
}
void bundleAnalytic(benchmark::State& state) { bundle(state, false); }
void bundleMesh(benchmark::State& state) { bundle(state, true); }
void bundleDirected(benchmark::State& state) {
  const std::vector<BundleView> views = bundleViews(true);
  const Light start = triangulated();
  BundleOptions options;
  options.limitOrders = 1;
  for (auto _ : state) benchmark::DoNotOptimize(bundleLight(views, start, options));
}
BENCHMARK(bundleDirected)->Unit(benchmark::kMillisecond);
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
    FitInput input;
    input.views = views;
    input.light = *estimateLight(views, settings);
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
  view.seen->brightest = *brightest;
  const Settings settings;
  for (auto _ : state) {
    addCanonicalContour(view, training().light->light, settings);
    benchmark::DoNotOptimize(view.canonical);
  }
}
BENCHMARK(canonicalContourOfOneView)->Unit(benchmark::kMicrosecond);

// Cost curves: by triangles, by directions, by views, by frames.
void canonicalByTriangles(benchmark::State& state) { predict(state, "canonical", int(state.range(0))); }
void canonicalQuadricByTriangles(benchmark::State& state) {
  predict(state, "canonical", int(state.range(0)), {kQuadric, kHints});
}
void levelSetByTriangles(benchmark::State& state) { predict(state, "limit-angle", int(state.range(0))); }
void starByTriangles(benchmark::State& state) { predict(state, "limit-angle", int(state.range(0)), {kStar, kHints}); }
void dualByTriangles(benchmark::State& state) { predict(state, "dual", int(state.range(0))); }
void buildByTriangles(benchmark::State& state) {
  const int cells = static_cast<int>(std::lround(std::sqrt(state.range(0) / 2.0)));
  const TriangleMesh mesh = makeAnalytic(scene().surface)->tessellate(Eigen::AlignedBox3d(), cells);
  for (auto _ : state) benchmark::DoNotOptimize(makeMesh(mesh, NormalPolicy::Interpolated));
}
/// The first search on a mesh builds its tree of normals.
void firstSearchByTriangles(benchmark::State& state) {
  const int cells = static_cast<int>(std::lround(std::sqrt(state.range(0) / 2.0)));
  const TriangleMesh mesh = makeAnalytic(scene().surface)->tessellate(Eigen::AlignedBox3d(), cells);
  const Light light = *fitOf("canonical").lightEstimate;
  std::shared_ptr<const Surface> fresh;
  for (auto _ : state) {
    state.PauseTiming();
    fresh = makeMesh(mesh, NormalPolicy::Interpolated);
    state.ResumeTiming();
    benchmark::DoNotOptimize(predictedBrightestPoints(*fresh, scene().cameras[1], light, BrightestPointOptions{}));
  }
}
BENCHMARK(firstSearchByTriangles)->RangeMultiplier(10)->Range(1000, kMillion)->Unit(benchmark::kMicrosecond);
void searchByTriangles(benchmark::State& state) {
  const Light light = *fitOf("canonical").lightEstimate;
  const Surface& mesh = surfaceOf(int(state.range(0)));
  benchmark::DoNotOptimize(predictedBrightestPoints(mesh, scene().cameras[0], light, BrightestPointOptions{}));
  std::size_t frame = 1;
  for (auto _ : state) {
    benchmark::DoNotOptimize(predictedBrightestPoints(mesh, scene().cameras[frame], light, BrightestPointOptions{}));
    frame = (frame + 7) % scene().cameras.size();
  }
}
BENCHMARK(searchByTriangles)->RangeMultiplier(10)->Range(1000, kMillion)->Unit(benchmark::kMicrosecond);
BENCHMARK(buildByTriangles)->RangeMultiplier(10)->Range(1000, kMillion)->Unit(benchmark::kMicrosecond);
BENCHMARK(canonicalByTriangles)->RangeMultiplier(10)->Range(1000, kMillion)->Unit(benchmark::kMicrosecond);
BENCHMARK(canonicalQuadricByTriangles)->RangeMultiplier(10)->Range(1000, kMillion)->Unit(benchmark::kMicrosecond);
BENCHMARK(levelSetByTriangles)->RangeMultiplier(10)->Range(1000, kMillion)->Unit(benchmark::kMicrosecond);
BENCHMARK(starByTriangles)->RangeMultiplier(10)->Range(1000, kMillion)->Unit(benchmark::kMicrosecond);
BENCHMARK(dualByTriangles)->RangeMultiplier(10)->Range(1000, kMillion)->Unit(benchmark::kMicrosecond);

void byDirections(benchmark::State& state, const std::string& model, std::vector<std::string> set) {
  set.push_back("predict.directions=" + std::to_string(state.range(0)));
  predict(state, model, kMillion, set);
}
void canonicalByDirections(benchmark::State& state) { byDirections(state, "canonical", {}); }
void canonicalQuadricByDirections(benchmark::State& state) { byDirections(state, "canonical", {kQuadric, kHints}); }
void starByDirections(benchmark::State& state) { byDirections(state, "limit-angle", {kStar, kHints}); }
BENCHMARK(canonicalByDirections)->Arg(6)->Arg(36)->Arg(120)->Arg(360)->Unit(benchmark::kMicrosecond);
BENCHMARK(canonicalQuadricByDirections)->Arg(6)->Arg(36)->Arg(120)->Arg(360)->Unit(benchmark::kMicrosecond);
BENCHMARK(starByDirections)->Arg(6)->Arg(36)->Arg(120)->Arg(360)->Unit(benchmark::kMicrosecond);

void bundleByViews(benchmark::State& state) {
  std::vector<BundleView> views;
  const std::vector<BundleView> six = bundleViews(true);
  for (int i = 0; i < state.range(0); ++i) views.push_back(six[i % six.size()]);
  const Light start = triangulated();
  for (auto _ : state) benchmark::DoNotOptimize(bundleLight(views, start));
}
BENCHMARK(bundleByViews)->Arg(3)->Arg(6)->Arg(20)->Arg(60)->Arg(1000)->Unit(benchmark::kMicrosecond);

/// The six training views over and over: what one more view costs, not what it teaches.
FitInput repeated(const FitInput& six, int views) {
  FitInput input = six;
  input.views.clear();
  for (int i = 0; i < views; ++i) {
    input.views.push_back(six.views[i % six.views.size()]);
    input.views.back().frame = i;
  }
  return input;
}
void fitByViews(benchmark::State& state, const std::string& solver) {
  Settings settings;
  settings.setFromText("predict.directions", "72");
  settings.setFromText("fit.solver", solver);
  FitInput six = training();
  for (TrainingView& v : six.views) addCanonicalContour(v, six.light->light, settings);
  const FitInput input = repeated(six, static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(modelByName("canonical").fit(input, settings));
}
void fitLinearByViews(benchmark::State& state) { fitByViews(state, "linear"); }
void fitAnchoredByViews(benchmark::State& state) { fitByViews(state, "anchored"); }
void fitRefinedByViews(benchmark::State& state) { fitByViews(state, "refined"); }
/// Contours of a glossy material, so that the reflectance model has something to explain.
void fitReflectanceByViews(benchmark::State& state) {
  static const FitInput six = [] {
    test::Synthetic s = test::ellipsoidScene(6);
    s.material = Material{};
    return test::fitInput(s, {});
  }();
  const FitInput input = repeated(six, static_cast<int>(state.range(0)));
  bool fitted = true;
  for (auto _ : state) fitted = fitted && modelByName("reflectance").fit(input, {});
  state.counters["fitted"] = fitted;
}
BENCHMARK(fitLinearByViews)->Arg(3)->Arg(6)->Arg(20)->Arg(60)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(fitAnchoredByViews)->Arg(3)->Arg(6)->Arg(20)->Arg(60)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(fitRefinedByViews)->Arg(3)->Arg(6)->Arg(20)->Arg(60)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(fitReflectanceByViews)->Arg(3)->Arg(6)->Arg(20)->Arg(60)->Unit(benchmark::kMicrosecond);

/// Frames predicted on a mesh of one million triangles and compared with what was observed, on all cores: wall time.
void framesPredictedAndCompared(benchmark::State& state, const std::string& model, const std::vector<std::string>& set) {
  static const std::vector<FrameEvidence> evidence = [] {
    std::vector<FrameEvidence> all;
    for (const Camera& camera : scene().cameras) {
      FrameEvidence e;
      e.frame = static_cast<int>(all.size());
      e.highlights = test::exactHighlightsOf(scene(), camera);
      all.push_back(std::move(e));
    }
    return all;
  }();
  const HighlightModel& m = modelByName(model);
  const ModelFit& fit = fitOf(model);
  const Surface& s = surfaceOf(kMillion);
  Settings settings;
  for (const std::string& v : set) settings.setFromText(v.substr(0, v.find('=')), v.substr(v.find('=') + 1));
  double error = 0;
  m.predict(fit, scene().cameras[0], &s, settings);
  for (auto _ : state) {
    std::vector<FrameComparison> frames(state.range(0));
    parallelFor(
        static_cast<int>(frames.size()),
        [&](int i) {
          const std::size_t k = i % evidence.size();
          const Camera& camera = scene().cameras[k];
          frames[i] = compareFrame(evidence[k], "lamp", camera, m.predict(fit, camera, &s, settings));
        },
        {}, "");
    error = 0;
    for (const FrameComparison& f : frames)
      if (!f.rows.empty() && f.rows[0].metrics) error += f.rows[0].metrics->contourErrorPct / double(frames.size());
  }
  state.counters["error_pct"] = error;
}
void framesCanonical(benchmark::State& state) { framesPredictedAndCompared(state, "canonical", {}); }
void framesCanonicalQuadric(benchmark::State& state) { framesPredictedAndCompared(state, "canonical", {kQuadric, kHints}); }
void framesStar(benchmark::State& state) { framesPredictedAndCompared(state, "limit-angle", {kStar, kHints}); }
BENCHMARK(framesCanonical)->Arg(1)->Arg(10)->Arg(100)->Arg(1000)->Arg(1410)->UseRealTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(framesCanonicalQuadric)->Arg(1)->Arg(10)->Arg(100)->Arg(1000)->Arg(1410)->UseRealTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(framesStar)->Arg(1)->Arg(10)->Arg(100)->Arg(1000)->Arg(1410)->UseRealTime()->Unit(benchmark::kMicrosecond);

void compareOneFrame(benchmark::State& state) {
  const Prediction p = modelByName("canonical").predict(fitOf("canonical"), scene().cameras[8], &surface(false), {});
  FrameEvidence e;
  e.highlights = test::exactHighlightsOf(scene(), scene().cameras[8]);
  for (auto _ : state) benchmark::DoNotOptimize(compareFrame(e, "lamp", scene().cameras[8], p));
}
BENCHMARK(compareOneFrame)->Unit(benchmark::kMicrosecond);

void detectOneFrame(benchmark::State& state) {
  Material material;
  const RenderedFrame frame = renderFrame(surface(false), scene().cameras[8], {scene().light}, material);
  DetectOptions options;
  for (auto _ : state) benchmark::DoNotOptimize(detectHighlights(frame.specular, nullptr, options));
  state.SetLabel(std::to_string(frame.specular.width) + " x " + std::to_string(frame.specular.height));
}
BENCHMARK(detectOneFrame)->Unit(benchmark::kMillisecond);

/// The same picture at several widths, 4:3.
void detectByWidth(benchmark::State& state) {
  Camera camera = scene().cameras[8];
  const double scale = double(state.range(0)) / camera.width;
  camera.width = static_cast<int>(state.range(0));
  camera.height = static_cast<int>(std::lround(camera.height * scale));
  camera.pixelFromRay.topRows<2>() *= scale;
  const RenderedFrame frame = renderFrame(surface(false), camera, {scene().light}, Material{});
  std::size_t found = 0;
  for (auto _ : state) {
    const auto detected = detectHighlights(frame.specular, nullptr, DetectOptions{});
    found = detected ? detected->size() : 0;
  }
  state.counters["highlights"] = static_cast<double>(found);
}
BENCHMARK(detectByWidth)->Arg(320)->Arg(640)->Arg(1280)->Arg(1920)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace glint

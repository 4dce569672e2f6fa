// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "core/model/models.h"
#include "core/pipeline/evidence.h"
#include "tests/core/model/exact_views.h"

/// Noisy trials with the right model: how often does the truth lie inside the predicted band? Shared by the test and by
/// bench/coverage_trials.cpp, which makes docs/uncertainty.md.
namespace glint::test {

struct CoverageTrials {
  Synthetic scene;  ///< its last camera is held out
  std::string model = "limit-angle";
  double noisePx = 0.5;    ///< per coordinate, on 72 points of every training contour and on its peak (--noise-px)
  double coverage = 0.95;  ///< of the band
  int trials = 100;
  unsigned firstSeed = 1;
  Settings settings;
};

/// Contours of a Torrance-Sparrow lobe, fitted with that lobe: the right model.
inline CoverageTrials rightLobe(CoverageTrials t) {
  t.model = "reflectance";
  t.scene.material = Material{};
  t.settings.set("fit.lobe", std::string("torrance-sparrow"));
  t.settings.set("fit.light_size", std::string("point"));
  return t;
}

struct CoverageResult {
  int trials = 0, failed = 0;  ///< failed: no fit, no prediction or no band
  long pairs = 0, inside = 0;  ///< (trial, direction)
  double shareSpread = 0;  ///< standard deviation over trials of a trial's share inside: directions of one trial move together
  double meanSigmaPx = 0, rmsErrorPx = 0, meanNoisePx = 0;
  double biasPx = 0;  ///< RMS over directions of the mean error over trials, outwards positive
  double share() const { return pairs ? double(inside) / double(pairs) : 0; }
};

/// Compares with the exact contour for level-set models; for an ellipsoid model, which is not exact on a curved surface, with its
/// own prediction from noise-free contours: the band is about noise.
inline CoverageResult runCoverageTrials(const CoverageTrials& t) {
  constexpr int kDirections = 36;
  const std::shared_ptr<const Surface> surface = makeAnalytic(t.scene.surface);
  const HighlightModel& model = modelByName(t.model);
  const Camera& heldOut = t.scene.cameras.back();
  std::vector<FrameEvidence> exact;
  for (std::size_t i = 0; i + 1 < t.scene.cameras.size(); ++i) {
    FrameEvidence evidence;
    evidence.frame = static_cast<int>(i);
    evidence.highlights = exactHighlightsOf(t.scene, t.scene.cameras[i]);
    exact.push_back(std::move(evidence));
  }
  const auto fitted = [&](double noise, unsigned seed) -> Outcome<ModelFit> {
    FitInput input;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      FrameEvidence evidence = exact[i];
      evidence.highlights = {withNoise(exact[i].highlights[0], noise, seed, exact[i].frame, 0)};
      input.views.push_back(trainingView(evidence, 0, t.scene.cameras[i], surface));
    }
    const Outcome<LightEstimate> light = estimateLight(input.views, t.settings);
    if (!light) return light.failure();
    input.light = *light;
    if (model.needsCanonicalContours())
      for (TrainingView& v : input.views) addCanonicalContour(v, light->light, t.settings);
    return model.fit(input, t.settings);
  };
  Polyline truth;
  if (t.model == "limit-angle" || t.model == "reflectance") {
    truth = exactHighlightsOf(t.scene, heldOut)[0].contour;
  } else {
    const Outcome<ModelFit> fit = fitted(0, 0);
    if (!fit) throw std::runtime_error("noise-free fit: " + fit.failure().message());
    const Prediction p = model.predict(*fit, heldOut, surface.get(), t.settings);
    if (p.highlights().empty()) throw std::runtime_error("noise-free prediction");
    truth = p.highlights()[0].contour;
  }
  CoverageResult result;
  result.trials = t.trials;
  std::vector<double> errors(kDirections, 0.0);
  double sigmas = 0, squares = 0, noise = 0, shares = 0, sharesSquared = 0;
  for (int k = 0; k < t.trials; ++k) {
    const Outcome<ModelFit> fit = fitted(t.noisePx, t.firstSeed + k);
    if (!fit || !fit->uncertainty) {
      ++result.failed;
      continue;
    }
    const Prediction p = model.predict(*fit, heldOut, surface.get(), t.settings);
    if (p.highlights().size() != 1) {
      ++result.failed;
      continue;
    }
    const std::vector<double> sigma = model.bandSigmaPx(*fit, p.highlights()[0], heldOut, surface.get(), t.settings);
    const Polyline& contour = p.highlights()[0].contour;
    if (sigma.size() != contour.points.size()) {
      ++result.failed;
      continue;
    }
    const double factor = studentFactor(t.coverage, fit->uncertainty->degreesOfFreedom);
    const Pixel middle = centroid(contour);
    int inside = 0;
    for (int d = 0; d < kDirections; ++d) {
      const double azimuth = 2 * M_PI * d / kDirections;
      std::size_t nearest = 0;
      double smallest = 10;
      for (std::size_t i = 0; i < contour.points.size(); ++i) {
        const Pixel q = contour.points[i] - middle;
        const double off = std::abs(std::remainder(std::atan2(q.y(), q.x()) - azimuth, 2 * M_PI));
        if (off < smallest) smallest = off, nearest = i;
      }
      const double error = distance(truth, contour.points[nearest]);
      inside += error <= factor * sigma[nearest];
      errors[d] += contains(truth, contour.points[nearest]) ? -error : error;
      sigmas += sigma[nearest];
      squares += error * error;
    }
    result.pairs += kDirections;
    result.inside += inside;
    noise += fit->uncertainty->noisePx;
    shares += double(inside) / kDirections;
    sharesSquared += std::pow(double(inside) / kDirections, 2);
  }
  const double n = std::max(1, t.trials - result.failed);
  if (result.pairs) {
    result.meanSigmaPx = sigmas / double(result.pairs);
    result.rmsErrorPx = std::sqrt(squares / double(result.pairs));
    result.meanNoisePx = noise / n;
    for (const double e : errors) result.biasPx += e * e / (n * n * kDirections);
    result.biasPx = std::sqrt(result.biasPx);
    result.shareSpread = std::sqrt(std::max(0.0, sharesSquared / n - std::pow(shares / n, 2)));
  }
  return result;
}

/// A unit sphere seen on an arc.
inline Synthetic sphereScene(int n = 7) {
  Synthetic s;
  s.surface = sphere(0.5);
  for (int i = 0; i < n; ++i) {
    const double a = -1.2 + 1.6 * i / std::max(1, n - 1);
    s.cameras.push_back(lookAt({2 * std::cos(a), 2 * std::sin(a), 0.8 + 0.3 * std::cos(3 * a)}, {0, 0, 0}));
  }
  s.light = trueLampAt({0.8, -1.5, 1.8});
  return s;
}

/// The surfaces and baselines on which the band is checked, by name.
inline std::vector<std::pair<std::string, Synthetic>> coverageScenes() {
  std::vector<std::pair<std::string, Synthetic>> scenes;
  scenes.emplace_back("plane", sheetScene(0, 7));
  scenes.emplace_back("bent sheet, 1.2 /m", sheetScene(1.2, 7));
  scenes.emplace_back("sphere", sphereScene(7));
  scenes.emplace_back("ellipsoid", ellipsoidScene(7));
  Synthetic narrow = ellipsoidScene(31);  // neighbours on the arc, and a view far from them
  narrow.cameras.erase(narrow.cameras.begin() + 6, narrow.cameras.end() - 1);
  scenes.emplace_back("ellipsoid, narrow baseline, far view", narrow);
  Synthetic few = sheetScene(0.4, 4);
  scenes.emplace_back("bent sheet, 3 views", few);
  return scenes;
}

}  // namespace glint::test

// SPDX-License-Identifier: BSD-3-Clause
#include "core/choice/extrapolation.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>

#include "core/base/evenly.h"
#include "core/base/progress.h"
#include "core/base/stage_times.h"
#include "core/pipeline/lobe_stage.h"
#include "core/pipeline/metrics.h"

namespace glint {
namespace {

constexpr double kBeyond = 1.5;         // times what leaving one out has tested: a little further is not another situation
constexpr std::size_t kFoldsShown = 6;  // left-out fits that predict the views: more would not change the size of a spread
/// Mean of |x| over its root mean square, for Gaussian x: contour errors are means of absolute distances.
const double kMeanOfGaussian = std::sqrt(2 / std::numbers::pi);

/// Where a light's training highlights are on the object.
Eigen::Vector3d middleOf(const Scene& scene, const std::vector<Fold>& folds, const std::string& light) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const Fold& f : folds)
    if (f.left.highlight.light == light && f.left.seen) {
      sum += scene.frames[f.left.frame].worldFromObject.inverse() *
             (f.left.fromScene.inverse() * f.left.seen->brightest.point.position);
      ++count;
    }
  return count ? Eigen::Vector3d(sum / count) : sum;
}

/// Where a camera is as the object sees it, which may move before a camera that stands still.
Eigen::Vector3d eyeAround(const Frame& frame) { return frame.worldFromObject.inverse() * frame.camera.centreInWorld(); }

/// @param a, b, middle  in the object
double distanceDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& middle) {
  const Eigen::Vector3d u = a - middle, v = b - middle;
  const double angle = std::atan2(u.cross(v).norm(), u.dot(v)), ratio = std::log(u.norm() / v.norm());
  return std::hypot(angle, ratio) * 180 / std::numbers::pi;
}

double equivalentDiameter(const Polyline& line) { return 2 * std::sqrt(std::abs(signedArea(line)) / std::numbers::pi); }

double contourDistancePct(const PredictedHighlight& a, const PredictedHighlight& b) {
  const ContourMetrics m =
      compareContours(a.contour, b.contour, b.gaps, std::nullopt, a.brightest.pixel, b.brightest.pixel, /*iou=*/0.0);
  return std::isfinite(m.contourErrorPct) ? std::min(m.contourErrorPct, kNoPredictionPct) : kNoPredictionPct;
}

/// Mean absolute distance that the model's own band expects; NaN without a band.
double bandPct(const HighlightModel& model, const ModelFit& fit, const std::vector<PredictedHighlight>& highlights,
               const ViewToPredict& view, const Settings& settings) {
  double sum = 0;
  int count = 0;
  for (const PredictedHighlight& h : highlights) {
    const double diameter = equivalentDiameter(h.contour);
    for (const double s : model.bandSigmaPx(fit, h, view.camera, view.surface.get(), settings)) {
      if (!std::isfinite(s)) continue;
      sum += kMeanOfGaussian * 100 * s / diameter;
      ++count;
    }
  }
  return count ? sum / count : std::nan("");
}

}  // namespace

std::vector<ViewToPredict> viewsToPredict(const Inspection& inspection, const std::vector<Fold>& folds, std::size_t most) {
  std::vector<ViewToPredict> all, some;
  if (inspection.train.perSurface) return some;  // every frame trains
  const Scene& scene = *inspection.scene;
  std::set<std::string> lights, surfaces;
  for (const Fold& f : folds) lights.insert(f.left.highlight.light), surfaces.insert(scene.frames[f.left.frame].surface);
  for (const std::string& light : lights) {
    const Eigen::Vector3d middle = middleOf(scene, folds, light);
    std::vector<const TrainingView*> training;
    for (const Fold& f : folds)
      if (f.left.highlight.light == light) training.push_back(&f.left);
    const auto eye = [&](int frame) { return eyeAround(scene.frames[frame]); };
    double tested = 0;
    for (const Fold& f : folds) {
      if (f.left.highlight.light != light) continue;
      double nearest = HUGE_VAL;
      for (const TrainingView& o : f.others) nearest = std::min(nearest, distanceDeg(eye(f.left.frame), eye(o.frame), middle));
      if (std::isfinite(nearest)) tested = std::max(tested, nearest);
    }
    for (int f = 0; f < static_cast<int>(scene.frames.size()); ++f) {
      if (!inspection.isHeldOut(f) || inspection.isTraining(f) || !isOn(scene, inspection.request.whatIf, f, light)) continue;
      ViewToPredict view;
      view.frame = f;
      view.light = light;
      view.camera = inspection.cameraFor(f, light);
      view.testedDeg = tested;
      view.distanceDeg = HUGE_VAL;
      for (const TrainingView* t : training)
        view.distanceDeg = std::min(view.distanceDeg, distanceDeg(eye(f), eye(t->frame), middle));
      const std::string& surface = scene.frames[f].surface;
      view.outside = !(view.distanceDeg <= kBeyond * tested) || (!surface.empty() && !surfaces.count(surface));
      all.push_back(std::move(view));
    }
  }
  for (ViewToPredict& view : evenly(all, most)) {
    const auto surface = surfaceFor(inspection, view.frame, view.light);
    if (!surface) continue;  // no prediction of any kind
    view.surface = *surface;
    some.push_back(std::move(view));
  }
  return some;
}

std::map<std::string, Fold> wholeFolds(const Inspection& inspection, const std::vector<Fold>& folds) {
  std::map<std::string, Fold> whole;
  for (const Fold& f : folds) {
    const std::string& light = f.left.highlight.light;
    const auto [at, isNew] = whole.try_emplace(light, f);
    if (!isNew) continue;
    Fold& all = at->second;
    all.light.reset();
    all.fits.clear();
    all.canonicalTried = false;
    all.others.clear();
    if (f.left.known) all.others = inspection.viewsOf({light, {}}, true);  // of other lamps, too
    for (std::size_t v = 0; v < inspection.views.size() && !f.left.known; ++v)
      if (inspection.views[v].seen && inspection.views[v].highlight.light == light)
        all.others.push_back(inspection.viewAsGiven(static_cast<int>(v)));
    all.pixels = knownPixelsOf(inspection, {light, {}});
  }
  return whole;
}

double differencePct(const std::vector<PredictedHighlight>& a, const std::vector<PredictedHighlight>& b) {
  if (a.empty() && b.empty()) return std::nan("");
  if (a.size() == 1 && b.size() == 1) return contourDistancePct(a[0], b[0]);
  std::vector<Polyline> first, second;
  for (const PredictedHighlight& h : a) first.push_back(h.contour);
  for (const PredictedHighlight& h : b) second.push_back(h.contour);
  const auto pairs = matchByOverlap(first, second);
  const std::size_t count = a.size() + b.size() - pairs.size();
  double sum = kNoPredictionPct * double(count - pairs.size());
  for (const auto& [i, j] : pairs) sum += contourDistancePct(a[i], b[j]);
  return sum / double(count);
}

Outlook lookAhead(const HighlightModel& model, std::map<std::string, Outcome<ModelFit>> fits,
                  const std::map<std::string, Fold>& whole, const std::vector<Fold>& folds, const std::vector<Answer>& answers,
                  const std::vector<ViewToPredict>& views, const Settings& settings, const ProgressFn& progress) {
  Outlook outlook;
  const Clock::time_point start = Clock::now();
  outlook.fits = std::move(fits);
  outlook.predictions.resize(views.size());
  outlook.spreadPct.assign(views.size(), kNoPredictionPct);
  parallelFor(
      static_cast<int>(views.size()),
      [&](int i) {
        const ViewToPredict& view = views[i];
        const Outcome<ModelFit>& fit = outlook.fits.at(view.light);
        if (!fit) return;
        const auto predict = [&](const ModelFit& f) {
          return model.predict(f, view.camera, view.surface.get(), settings).highlights();
        };
        outlook.predictions[i] = predict(*fit);
        std::vector<const ModelFit*> leftOut;
        std::size_t ofLight = 0;
        for (std::size_t f = 0; f < folds.size(); ++f) {
          if (folds[f].left.highlight.light != view.light) continue;
          ++ofLight;
          if (answers[f].fit) leftOut.push_back(&*answers[f].fit);
        }
        double squares = 0;
        const std::size_t shown = std::min(leftOut.size(), kFoldsShown);
        for (std::size_t f = 0; f < shown; ++f) {
          const double d = differencePct(outlook.predictions[i], predict(*leftOut[f * leftOut.size() / shown]));
          if (std::isfinite(d)) squares += d * d;  // none if both see no highlight: they agree
        }
        const std::size_t n = whole.at(view.light).others.size();
        const double jackknife = std::sqrt(double(n - 1) * squares / double(shown));
        // Where most left-out fits fail, the others are no sample of them; fits to one or two views are no fits to one more.
        double spread = 2 * leftOut.size() > ofLight ? jackknife : std::nan("");
        if (n < kFewViews || std::isnan(spread))
          if (const double band = bandPct(model, *fit, outlook.predictions[i], view, settings); std::isfinite(band))
            spread = band;
        if (spread < kNoPredictionPct) outlook.spreadPct[i] = spread;
      },
      progress, "look ahead " + model.id());
  outlook.timeUs = microsecondsSince(start);
  return outlook;
}

double contourNoisePct(const Polyline& observed) {
  constexpr int kHarmonics = 8;  // on either side of 0
  const int n = static_cast<int>(observed.points.size());
  if (n < 6 * kHarmonics || !observed.closed) return 0;
  using Complex = std::complex<double>;
  std::vector<Complex> smooth(n, 0);
  for (int k = -kHarmonics; k <= kHarmonics; ++k) {
    Complex z = 0;
    for (int j = 0; j < n; ++j)
      z += Complex(observed.points[j].x(), observed.points[j].y()) * std::polar(1.0 / n, -2 * std::numbers::pi * k * j / n);
    for (int j = 0; j < n; ++j) smooth[j] += z * std::polar(1.0, 2 * std::numbers::pi * k * j / n);
  }
  PredictedHighlight jagged, low;
  jagged.contour = observed;
  for (const Complex& z : smooth) low.contour.points.emplace_back(z.real(), z.imag());
  // The harmonics follow their share of the noise.
  return contourDistancePct(jagged, low) / std::sqrt(1 - (2.0 * kHarmonics + 1) / n);
}

}  // namespace glint

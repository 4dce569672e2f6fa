// SPDX-License-Identifier: BSD-3-Clause
#include "core/choice/choice_ground.h"

#include <utility>

#include "core/base/progress.h"
#include "core/model/pixel_evidence.h"
#include "core/pipeline/corrected_depth.h"

namespace glint {

ChoiceGround::ChoiceGround(const Inspection& given, std::size_t mostViews) : inspection(given) {
  inspection.correctedDepthMaps = std::make_shared<CorrectedDepthMaps>();  // those of other corrections stay apart
  folds = foldsOf(inspection, LeaveOut::Place);
  views = viewsToPredict(inspection, folds, mostViews);
  whole = wholeFolds(inspection, folds);
}

void ChoiceGround::findLights(const ProgressFn& progress) {
  if (std::exchange(lightsFound_, true) || inspection.train.perSurface) return;
  for (auto& [light, fold] : whole) {
    const FitKey key{light, {}};
    if (inspection.lights.count(key)) continue;
    if (!report(progress, {"light", 0, static_cast<int>(whole.size())})) throw Stopped{};
    fold.light = fitLight(fold.others, *inspection.scene, *inspection.surfaces, inspection.request.settings);
    ++inspection.work.lights;
    inspection.lights.insert_or_assign(key, fold.light->light);
    // Depth maps and normals are corrected by each left-out fit for itself.
    if (fold.light->correction.smoothed) inspection.corrections[key].smoothed = fold.light->correction.smoothed;
  }
  for (ViewToPredict& view : views)
    if (const auto surface = surfaceFor(inspection, view.frame, view.light)) view.surface = *surface;
}

void ChoiceGround::fitPixels(const ProgressFn& progress) {
  if (std::exchange(pixelsFitted_, true)) return;
  const Settings& settings = inspection.request.settings;
  if (!fitsPixels(settings)) return;
  for (auto& [light, fold] : whole) {
    if (!fold.light || !isSmoothedAlone(fold.light->correction) || !havePixels(fold.light->views)) continue;
    const auto estimate = fold.light->light ? std::optional(*fold.light->light) : std::nullopt;
    const Outcome<PixelFit> fit = fitViewsPixels(fold.light->views, estimate, settings, progress);
    KnownPixels known;
    if (fit)
      known.fit = std::make_shared<const PixelFit>(*fit);
    else
      known.unexplained =
          std::make_shared<const UnexplainedPixels>(UnexplainedPixels{fold.light->views, estimate, settings, fit.failure()});
    fold.onSmoothed = known;
    known.near = std::exchange(known.fit, nullptr);
    for (Fold& left : folds)
      if (left.left.highlight.light == light) left.onSmoothed = known;
  }
}

}  // namespace glint

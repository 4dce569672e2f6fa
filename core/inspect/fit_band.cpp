// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/fit_band.h"

#include <utility>

#include "core/fit/fit_engine.h"
#include "core/inspect/lobe_stage.h"
#include "core/model/pixel_evidence.h"

namespace glint {

FitInput fitInputOf(const Inspection& in, const HighlightModel& model, const FitKey& key) {
  std::vector<TrainingView> views;
  for (const TrainingView& v : in.views)
    if (!v.highlight.light.empty() && in.keyFor(v.frame, v.highlight.light) == key) views.push_back(v);
  // The stage's fit is of all views of the group: it serves where none of them lost its pixels since.
  // Corrected normals are not those that the stage saw.
  const bool known = havePixels(views) && !in.corrections.count(key);
  const auto light = in.lights.find(key);
  FitInput input = fitInput(model, std::move(views), light == in.lights.end() ? std::nullopt : std::optional(light->second),
                            in.request.settings, known ? pixelFitFor(in, key) : nullptr);
  if (const auto failed = in.unexplained.find(key); known && failed != in.unexplained.end()) input.unexplained = failed->second;
  return input;
}

FittedBand bandOf(const Inspection& in, const HighlightModel& model, const ModelResult::Fit& fit) {
  if (!fit.fit) return {};
  return bandOf(model, *fit.fit, fitInputOf(in, model, fit.key()), in.request.settings,
                model.needsLight() && in.corrections.count(fit.key()) > 0);
}

}  // namespace glint

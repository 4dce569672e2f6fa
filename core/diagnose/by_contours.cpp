// SPDX-License-Identifier: BSD-3-Clause
#include "core/diagnose/by_contours.h"

#include <algorithm>

#include "core/inspect/lobe_stage.h"
#include "core/inspect/requested_evidence.h"
#include "core/model/model.h"

namespace glint {
namespace {

bool takesPixels(const InspectionRequest& request) {
  const std::string& evidence = request.settings.text("fit.evidence");
  return evidence == "auto" || evidence == "pixels";
}

/// No light's pixels were explained: its fits and contours are as if none had been looked at.
bool pixelsFailed(const Inspection& base) {
  return !base.pixelFits.empty() &&
         std::none_of(base.pixelFits.begin(), base.pixelFits.end(), [](const auto& fit) { return bool(fit.second); });
}

bool fitsPixelsAgain(const Inspection& base, const InspectionRequest& changed, const Change& change, const std::string& model) {
  const Scene& scene = *base.scene;
  StageInputs asked;
  asked.lobes = lobeInputs(changed, parseTrainSpec(changed.train, scene), lightsAreOpenIn(scene, changed));
  if (!asked.same(Stage::Lobes, base.inputs)) return true;
  if (!change.set || !takesPixels(changed) || !modelByName(model).takesPixels()) return false;
  const std::string& stage = paramSpec(change.set->substr(0, change.set->find('='))).stage;
  return stage != "predict" && stage != "evaluate";
}

}  // namespace

std::optional<Change> byContours(const Inspection& base, const Change& change, const std::string& model) {
  const InspectionRequest changed = with(base.request, change, *base.scene);
  if (!pixelsFailed(base) || !looksAtPixels(changed) || !fitsPixelsAgain(base, changed, change, model)) return std::nullopt;
  Change quick = change;
  if (changed.settings.text("detect.background") == "lobe") quick.alsoSet.emplace_back("detect.background=smooth");
  if (takesPixels(changed)) quick.alsoSet.emplace_back("fit.evidence=contours");
  return quick;
}

}  // namespace glint

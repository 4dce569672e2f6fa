// SPDX-License-Identifier: BSD-3-Clause
#include "core/diagnose/model_causes.h"

#include <algorithm>

#include "core/base/angle.h"
#include "core/base/light_name.h"
#include "core/base/number_text.h"
#include "core/diagnostics/conditioning.h"
#include "core/inspect/summary.h"
#include "core/selection/selection.h"

namespace glint {
namespace {

constexpr std::size_t kMostNamed = 4;  // views in one sentence

std::string frameText(const Inspection& r, int frame) { return "frame " + r.scene->frames[std::size_t(frame)].id; }

/// Views that the fit did not see and gets wrong: what they have in common shows what the model misses.
std::string goneAstray(const Inspection& r, const UnseenError& error) {
  std::vector<const UnseenError::View*> astray;
  for (const UnseenError::View& v : error.views)
    if (v.observed() > 0 && isAstray(v)) astray.push_back(&v);
  if (astray.empty() || error.matched() == 0) return "";
  std::stable_sort(astray.begin(), astray.end(), [](auto* a, auto* b) { return a->wrongPct > b->wrongPct; });
  std::string text = formatted("%zu of %zu views that the fit did not see are wrong: ", astray.size(), error.views.size());
  for (std::size_t i = 0; i < astray.size() && i < kMostNamed; ++i) {
    const UnseenError::View& v = *astray[i];
    text += (i ? ", " : "") + std::string(error.leftOut ? "left-out " : "held-out ") + frameText(r, v.frame);
    text += v.matched > 0 ? formatted(" off by %.3g %%", v.contourPct / v.matched) : " not predicted";
  }
  return text + (astray.size() > kMostNamed ? formatted(" and %zu more", astray.size() - kMostNamed) : "");
}

/// "" if one limit angle fits all highlights of a light, or none is asked for.
std::string twoLimitAngles(const Inspection& r, const HighlightModel& model, const std::vector<HighlightEvidence>& evidence) {
  const LimitConflict c = limitConflict(evidence);
  const std::vector<ModelResult::Fit>& fits = r.models.at(model.id()).fits;
  const bool lobe =
      std::any_of(fits.begin(), fits.end(), [](const auto& f) { return f.fit && f.fit->template as<ReflectanceFit>(); });
  if (!c.wide || !model.needsLight() || lobe) return "";
  const auto placed = [&](const HighlightEvidence& e) {
    return formatted("%.3g\u00b0 (", degrees(*e.limitAngle)) + frameText(r, e.frame) + ", " + lightName(e.light) + ")";
  };
  return "two highlights have limit angles " + placed(*c.wide) + " and " + placed(*c.narrow) +
         ": one limit angle cannot fit both";
}

}  // namespace

ModelDiagnosis diagnosisOf(const Inspection& r, const std::string& name, const UnseenError& error, const ProgressFn& progress) {
  const ModelResult& result = r.models.at(name);
  const HighlightModel& model = modelByName(name);
  ModelDiagnosis d;
  d.model = name;
  d.error = error;
  d.evidence = highlightEvidence(r, model, progress);
  const auto worst = [&](const char* status) {
    return std::any_of(result.fits.begin(), result.fits.end(),
                       [&](const auto& f) { return std::string(fitStatus(f)) == status; });
  };
  d.status = result.fits.empty() || worst("failed") ? "failed" : worst("poor") ? "poor" : "ok";
  if (d.status == "ok" && error.missed() == 0 && !(error.contourPct() > kLargestExpectedPct)) return d;
  const auto add = [&](std::string cause) {
    if (!cause.empty() && !std::count(d.causes.begin(), d.causes.end(), cause)) d.causes.push_back(std::move(cause));
  };
  for (const ModelResult::Fit& fit : result.fits)
    if (const std::string reason = fitReason(fit); !reason.empty()) add(lightName(textOf(fit.key())) + ": " + reason);
  if (std::none_of(r.views.begin(), r.views.end(), [](const TrainingView& v) { return bool(v.seen); }))
    add("no training view can be used");
  add(twoLimitAngles(r, model, d.evidence));
  for (const Conditioning& c : conditioningOf(r))
    for (const Finding& f : c.findings)
      if (c.model == name && f.verdict == Verdict::Red && f.id != "fit")
        add(lightName(c.light) + ", " + f.title + ": " + f.reason);
  add(goneAstray(r, error));
  if (d.status != "ok") d.fits = traceFits(r, model, progress);
  return d;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/fitted_lobe.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/angle.h"
#include "core/base/light_name.h"
#include "core/base/number_text.h"

namespace glint {
namespace {
/// The fit of reflectance that tells the frame's lobe best; null = no fit of any light.
const ModelResult::Fit* reflectanceFit(const Inspection& in, int frame) {
  const auto result = in.models.find(radianceModel().id());
  if (result == in.models.end()) return nullptr;
  const std::string surface = in.surfaces ? in.surfaces->keyOf(frame) : "";
  const std::vector<Highlight>& shown = in.evidence[std::size_t(frame)].highlights;
  const auto score = [&](const ModelResult::Fit& f) {
    const bool usable = f.fit && f.fit->as<ReflectanceFit>();
    const bool ofFrame = (!f.surface || *f.surface == surface) &&
                         std::any_of(shown.begin(), shown.end(), [&](const Highlight& h) { return h.light == f.light; });
    return 2 * int(usable) + int(ofFrame);
  };
  const std::vector<ModelResult::Fit>& fits = result->second.fits;
  const auto best = std::max_element(fits.begin(), fits.end(),
                                     [&](const ModelResult::Fit& a, const ModelResult::Fit& b) { return score(a) < score(b); });
  return best == fits.end() ? nullptr : &*best;
}

/// A lobe from the limit angle of the frame's light, else of any.
std::optional<FittedLobe> lobeOfLimitAngle(const Inspection& in, int frame) {
  std::optional<FittedLobe> found;
  for (const TrainingView& v : in.views) {
    if (found && v.frame != frame) continue;
    const double q = v.highlight.level;
    const LightEstimate* const light = in.lightFor(v.frame, v.highlight.light);
    if (!v.seen || !(q > 0 && q < 1) || !light) continue;
    const double alpha = light->limitAngle;
    if (!(alpha > 0)) continue;
    const std::string origin = formatted("limit angle %.3g\u00b0 at level %.3g, light ", degrees(alpha), q);
    found = FittedLobe{Lobe::TorranceSparrow, std::tan(alpha) / std::sqrt(-std::log(q)), origin + v.highlight.light};
  }
  return found;
}
}  // namespace

Outcome<FittedLobe> fittedLobe(const Inspection& in, int frame) {
  require(in.scene && frame >= 0 && frame < int(in.scene->frames.size()), "fittedLobe: no such frame");
  if (in.request.whatIf.synthesise)
    return Failure{Reason::NotSupported, "the contours are synthesised, so no fit describes the captured scene"};
  const ModelResult::Fit* reflectance = reflectanceFit(in, frame);
  if (reflectance && reflectance->fit)
    if (const ReflectanceFit* const fit = reflectance->fit->as<ReflectanceFit>())
      return FittedLobe{fit->lobe, fit->roughness.mean, "reflectance, " + lightName(reflectance->light)};
  if (const std::optional<FittedLobe> lobe = lobeOfLimitAngle(in, frame)) return *lobe;
  if (reflectance && reflectance->failure()) return *reflectance->failure();
  return Failure{Reason::NotSupported, "no computed model gives the lobe (reflectance does, or a model that needs the light)"};
}

}  // namespace glint

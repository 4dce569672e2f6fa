// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/fits.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/base/progress.h"
#include "core/base/words.h"
#include "core/model/models.h"
#include "core/model/pixel_evidence.h"
#include "core/pipeline/carried.h"
#include "core/pipeline/fit_engine.h"
#include "core/pipeline/known_lamps.h"
#include "core/pipeline/lobe_stage.h"

namespace glint {
FitInput fitInputOf(const Inspection& in, const HighlightModel& model, const FitKey& key) {
  std::vector<TrainingView> views = in.viewsOf(key);
  // The stage's fit is of all views of the group: it serves where none of them lost its pixels since.
  // Corrected normals are not those that the stage saw.
  const bool known = havePixels(views) && !in.corrections.count(key);
  const auto light = in.lights.find(key);
  return fitInput(model, std::move(views), light == in.lights.end() ? std::nullopt : std::optional(light->second),
                  in.request.settings, known ? knownPixelsOf(in, key) : KnownPixels{});
}

std::optional<ModelResult::Fit> fitAtObservedLevel(const ModelResult::Fit& fit, const HighlightModel& model,
                                                   const FrameEvidence& evidence, const Camera& camera, const Surface* surface,
                                                   const Settings& settings) {
  if (!fit.fit || !surface) return std::nullopt;
  for (const Highlight& h : evidence.scored()) {
    if (h.light != fit.light || !h.peakCut || h.clipped) continue;
    std::optional<ModelFit> there = model.atLevelOf(*fit.fit, h.peak, camera, *surface, settings);
    if (!there) return std::nullopt;
    ModelResult::Fit other = fit;
    other.fit = *std::move(there);
    return other;
  }
  return std::nullopt;
}

namespace {

/// Two fits of known lamps of one material: what else explains the one explains the other, too.
bool shareOthers(const Inspection& in, const ModelResult::Fit& a, const ModelResult::Fit& b) {
  const std::optional<KnownLamp> lampA = knownLamp(*in.scene, a.light), lampB = knownLamp(*in.scene, b.light);
  if (!a.fit || !b.fit || a.surface != b.surface || !lampA || !lampB || !shareMaterial(*lampA, *lampB)) return false;
  const ReflectanceFit* const lobeA = a.fit->as<ReflectanceFit>();
  const ReflectanceFit* const lobeB = b.fit->as<ReflectanceFit>();
  if (lobeA && lobeB) return lobeA->lobe == lobeB->lobe && lobeA->evidence == lobeB->evidence && a.fit->poor == b.fit->poor;
  return a.fit->as<LimitAngleFit>() && b.fit->as<LimitAngleFit>() && a.fit->poor == b.fit->poor;
}

std::vector<OtherFit> otherFitsOf(const Inspection& in, const HighlightModel& model, const ModelResult::Fit& fit) {
  if (!fit.fit) return {};
  std::vector<OtherFit> others = otherFits(model, *fit.fit, fitInputOf(in, model, fit.key()), in.request.settings);
  for (OtherFit& other : others) other.fit.light = fit.light;
  return others;
}

FittedBand bandOf(const Inspection& in, const HighlightModel& model, const ModelResult::Fit& fit, std::vector<OtherFit> others) {
  if (!fit.fit) return {};
  for (OtherFit& other : others) {
    if (other.fit.light == fit.light) continue;
    other.fit.lightEstimate = fit.fit->lightEstimate;  // the material under this lamp
    other.fit.hints.clear();                           // they lie where the other lamp's views were carried
  }
  return bandOf(model, *fit.fit, fitInputOf(in, model, fit.key()), in.request.settings, others,
                model.needsLight() && in.corrections.count(fit.key()) > 0);
}

}  // namespace

std::vector<FittedBand> bandsOf(const Inspection& in, const HighlightModel& model, const std::vector<ModelResult::Fit>& fits,
                                const ProgressFn& progress) {
  const auto leaderOf = [&](std::size_t i) {
    for (std::size_t k = 0; k < i; ++k)
      if (shareOthers(in, fits[k], fits[i])) return k;
    return i;
  };
  std::vector<std::size_t> leaders, leading;
  for (std::size_t i = 0; i < fits.size(); ++i)
    if (leaders.push_back(leaderOf(i)); leaders[i] == i) leading.push_back(i);
  std::vector<std::vector<OtherFit>> others(fits.size());
  std::vector<FittedBand> bands(fits.size());
  const std::string stage = "band " + model.id();
  parallelFor(
      static_cast<int>(leading.size()),
      [&](int k) {
        const std::size_t i = leading[static_cast<std::size_t>(k)];
        others[i] = otherFitsOf(in, model, fits[i]);
      },
      progress, stage);
  parallelFor(
      static_cast<int>(fits.size()),
      [&](int k) {
        const std::size_t i = static_cast<std::size_t>(k);
        bands[i] = bandOf(in, model, fits[i], others[leaders[i]]);
      },
      progress, stage);
  return bands;
}

bool isSeen(const Inspection& r, const std::string& light) {
  return std::any_of(r.evidence.begin(), r.evidence.end(), [&](const FrameEvidence& e) {
    return std::any_of(e.highlights.begin(), e.highlights.end(), [&](const Highlight& h) { return h.light == light; });
  });
}

std::string mergedRemark(const Inspection& r, const ModelFit& fit) {
  std::map<std::string, int> on;
  for (const int frame : fit.frames)
    for (const std::string& light : r.scene->frames[std::size_t(frame)].lightsOn)
      if (light != fit.light && isOn(*r.scene, r.request.whatIf, frame, light)) ++on[light];
  std::string names;
  int most = 0;
  for (const auto& [light, frames] : on) {
    if (2 * frames < static_cast<int>(fit.frames.size()) || isSeen(r, light)) continue;
    names += (names.empty() ? "" : ", ") + light;
    most = std::max(most, frames);
  }
  if (names.empty()) return "";
  return "also on in " + std::to_string(most) + " of " + std::to_string(fit.frames.size()) +
         " training frames, without a separate highlight: " + names +
         "; where highlights of several lights merge, the estimated light lies between these lights";
}

std::string oneViewRemark(const Inspection& r, const ModelFit& fit) {
  const auto isFirst = [&](int frame) { return frame == fit.frames.front(); };
  if (fit.frames.empty() || !std::all_of(fit.frames.begin(), fit.frames.end(), isFirst)) return "";
  if (r.train.perSurface || knownLamp(*r.scene, fit.light)) return "";
  return "the fit rests on one view, frame " + r.scene->frames[std::size_t(fit.frames.front())].id +
         ": many lamps and lobes fit one view, so that neither the residual nor the band shows an error";
}

std::string repeatedRemark(const Inspection& r, const ModelFit& fit) {
  std::string names;
  int count = 0;
  for (const int frame : r.train.frames) {
    const std::vector<int>& excluded = r.request.excluded;
    if (std::find(excluded.begin(), excluded.end(), frame) != excluded.end()) continue;
    if (r.keyFor(frame, fit.light).surface != fit.surface) continue;
    const std::vector<Highlight>& highlights = r.evidence[std::size_t(frame)].highlights;
    if (std::none_of(highlights.begin(), highlights.end(), [&](const Highlight& h) { return h.light == fit.light; })) continue;
    if (std::any_of(r.views.begin(), r.views.end(), [&](const TrainingView& v) { return v.frame == frame; })) continue;
    names += (count++ == 0 ? "" : ", ") + r.scene->frames[std::size_t(frame)].id;
  }
  if (count == 0) return "";
  return std::to_string(count) + (count == 1 ? " training frame repeats" : " training frames repeat") +
         " another one exactly and count once: " + names;
}

std::string cutRemark(const Inspection& r, const ModelFit& fit) {
  int cut = 0, all = 0;
  for (const TrainingView& v : r.views) {
    if (!v.seen || v.highlight.light != fit.light) continue;
    if (std::find(fit.frames.begin(), fit.frames.end(), v.frame) == fit.frames.end()) continue;
    ++all;
    cut += v.highlight.touchesBorder;
  }
  return cut == 0 ? ""
                  : formatted("the image's border cuts %d of %d training highlights: only the part that is seen is evidence", cut,
                              all);
}

std::string byHandRemark(const Inspection& r, const ModelFit& fit) {
  std::string names;
  for (const TrainingView& v : r.views) {
    if (v.highlight.byHand.empty() || !v.seen || v.highlight.light != fit.light) continue;
    if (std::find(fit.frames.begin(), fit.frames.end(), v.frame) == fit.frames.end()) continue;
    names += (names.empty() ? "" : "; ") + ("frame " + r.scene->frames[std::size_t(v.frame)].id + ": " + v.highlight.byHand);
  }
  return names;
}

std::string switchedRemark(const Inspection& r, const ModelFit& fit,
                           const std::function<std::shared_ptr<const Surface>(int frame)>& surfaceOf) {
  constexpr int kLeastOff = 2;  // frames: one highlight may be missed for another reason
  const std::vector<Frame>& frames = r.scene->frames;
  if (r.train.perSurface || !fit.lightEstimate ||
      std::any_of(frames.begin(), frames.end(), [](const Frame& f) { return !f.lightsOn.empty(); }))
    return "";
  std::set<std::string> trained, untrained;
  for (const TrainingView& v : r.views) trained.insert(v.highlight.light);
  int off = 0, on = 0;
  for (const FrameEvidence& e : r.evidence) {
    std::set<std::string> shown;
    for (const Highlight& h : e.highlights) shown.insert(h.light);
    for (const std::string& light : shown)
      if (!light.empty() && !trained.count(light)) untrained.insert(light);
    if (e.frame < 0 || shown.empty() || shown.count("")) continue;
    if (shown.count(fit.light)) {
      ++on;
      continue;
    }
    const std::shared_ptr<const Surface> surface = carried(surfaceOf(e.frame), r.lightFromScene(e.frame, fit.light));
    off += surface && brightestPointsFor(*surface, r.cameraFor(e.frame, fit.light), *fit.lightEstimate, r.request.settings);
  }
  std::string text;
  for (const std::string& light : untrained) text += (text.empty() ? "" : ", ") + light;
  if (!text.empty()) text = "lamps are switched: no training frame shows " + text + ", which other frames show";
  if (off < kLeastOff) return text;
  return text + (text.empty() ? "" : "; ") + "no highlight of this light is in " + std::to_string(off) + " of " +
         std::to_string(off + on) + " frames where it would be seen: its lamp may be off there (state which lights are on)";
}

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

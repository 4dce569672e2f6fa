// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/diagnosis_parts.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/advise/conditioning.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/base/words.h"
#include "core/choice/selection.h"
#include "core/model/model.h"
#include "core/model/reflectance_settings.h"
#include "core/pipeline/hand_edits.h"
#include "core/pipeline/lobe_stage.h"
#include "core/pipeline/summary.h"
#include "core/reflectance/added_lobe.h"
#include "core/scene/frame_name.h"

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

namespace {

constexpr std::size_t kMostExcluded = 2;  // frames tried one by one
constexpr std::size_t kFewestViews = 4;   // an exclusion must leave one more than a fit with a free centre needs
constexpr std::size_t kMoreFrames = 12;   // twice the default: enough to tell whether more help

class Candidates {
 public:
  Candidates(const Inspection& inspection, const std::string& model, const ProgressFn& progress)
      : r_(inspection), model_(modelByName(model)), evidence_(highlightEvidence(inspection, model_, progress)) {}

  std::vector<CandidateChange> run() {
    lightFrame();
    filters();
    lobes();
    otherFrames();
    lightSolver();
    exclusions();
    ellipsoidSolvers();
    surface();
    cameras();
    return std::move(all_);
  }

 private:
  void set(const std::string& key, const std::string& value, const std::string& why) {
    Settings other = r_.request.settings;
    other.setFromText(key, value);
    if (!(other.value(key) == r_.request.settings.value(key))) all_.push_back({{.set = key + "=" + value}, why});
  }

  /// The highlights speak against what is stated.
  void lightFrame() {
    if (!r_.lightFrame.doubt.empty()) set("light.frame", "auto", r_.lightFrame.reason);
  }

  void filters() {
    const ModelSummary summary = summarise(r_, r_.models.at(model_.id()));
    if (summary.spurious == 0) return;
    set("predict.filter_area", "true", "predictions that are smaller than what detection takes");
    set("predict.filter_shadow", "true", "predictions in the shadow of the object itself");
  }

  void lightSolver() {
    if (!model_.needsLight()) return;
    set("light.solver", "triangulated", "the light from peaks alone, which one odd contour does not move");
    set("light.solver", "bundle", "the light from whole contours");
  }

  void exclusions() {
    std::map<int, double> weights;  // by frame
    std::set<int> frames;
    for (const HighlightEvidence& e : evidence_) {
      frames.insert(e.frame);
      weights[e.frame] = std::max(weights[e.frame], e.weight);
    }
    if (frames.size() <= kFewestViews) return;
    std::vector<std::pair<double, int>> worst;
    for (const auto& [frame, weight] : weights) worst.emplace_back(-weight, frame);
    std::sort(worst.begin(), worst.end());
    for (std::size_t i = 0; i < worst.size() && i < kMostExcluded; ++i) {
      if (i > 0 && worst[i].first == 0) break;  // one is tried even where none stands out
      exclude({worst[i].second}, worst[i].first == 0 ? "no frame stands out; the first one" : "it contradicts the model most");
    }
    if (worst.size() > kFewestViews + 1 && worst[1].first < 0)
      exclude({worst[0].second, worst[1].second}, "the two frames that contradict the model most");
  }
  void exclude(std::vector<int> frames, const std::string& why) {
    frames.insert(frames.end(), r_.request.excluded.begin(), r_.request.excluded.end());  // the flag replaces those
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    all_.push_back({{.exclude = frameSpec(frames, *r_.scene)}, why});
  }

  void otherFrames() {
    if (r_.train.perSurface) return;
    const std::size_t n = r_.scene->frames.size(), used = r_.train.frames.size();
    if (n < used + 2) return;  // nothing would be left to predict
    train("spread:" + std::to_string(std::max<std::size_t>(used, 4)), "views farther apart");
    if (n >= kMoreFrames + 2 && used < kMoreFrames) train("spread:" + std::to_string(kMoreFrames), "more views");
    if (used < n / 2) train("first:" + std::to_string(std::min(2 * used, n - 2)), "more views");
  }
  void train(const std::string& spec, const std::string& why) {
    if (spec != r_.request.train && parseTrainSpec(spec, *r_.scene).frames != r_.train.frames)
      all_.push_back({{.train = spec}, why});
  }

  void ellipsoidSolvers() {
    if (!model_.hasOutlines()) return;
    for (const char* solver : {"refined", "anchored", "linear"}) set("fit.solver", solver, "another solver of the ellipsoid");
  }

  /// Shapes of the lamp and lobes that no fit of this model has already.
  void lobes() {
    if (!mayHaveLobe()) return;
    std::set<std::string> found;
    if (const auto result = r_.models.find(model_.id()); result != r_.models.end())
      for (const ModelResult::Fit& f : result->second.fits)
        if (const ReflectanceFit* lobe = f.fit ? f.fit->as<ReflectanceFit>() : nullptr)
          found.insert({nameOf(lobe->shape), nameOf(lobe->lobe)});
    const auto setOther = [&](const std::string& key, const std::string& value, const std::string& why) {
      if (!found.count(value)) set(key, value, why);
    };
    for (const LampShape& shape : allLampShapes())
      setOther("fit.light_size", nameOf(shape), std::visit([](const auto& s) { return s.kWords; }, shape));
    set("fit.evidence", "contours", "a lobe that the pixels do not follow");
    std::vector<std::string> lobes{"ggx", "torrance-sparrow"};
    for (const Lobe lobe : allLobes())
      if (profileOf(lobe)) lobes.emplace_back(nameOf(lobe));  // of a plugin
    for (const std::string& lobe : lobes) setOther("fit.lobe", lobe, "another lobe");
  }

  /// Its fits have a lobe; without fits, it reconstructs no ellipsoid.
  bool mayHaveLobe() const {
    const auto result = r_.models.find(model_.id());
    if (result != r_.models.end())
      for (const ModelResult::Fit& f : result->second.fits)
        if (f.fit) return f.fit->as<ReflectanceFit>() != nullptr;
    return model_.needsLight() && !model_.hasOutlines();
  }

  void surface() {
    const bool mesh = std::any_of(r_.views.begin(), r_.views.end(), [&](const TrainingView& v) {
      return r_.scene->hasTriangles(r_.scene->frames[std::size_t(v.frame)].surface);
    });
    if (!mesh) return;
    set("surface.normals", "curved", "a coarse mesh");
    if (model_.needsLight()) set("light.refine_normals", "true", "a mesh whose normals are off");
  }

  void cameras() {
    if (model_.needsLight()) set("light.refine_poses", "true", "poses that are off by a little");
  }

  const Inspection& r_;
  const HighlightModel& model_;
  const std::vector<HighlightEvidence> evidence_;
  std::vector<CandidateChange> all_;
};

}  // namespace

std::vector<CandidateChange> candidateChanges(const Inspection& inspection, const std::string& model,
                                              const ProgressFn& progress) {
  return Candidates(inspection, model, progress).run();
}

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
  if (std::none_of(d.causes.begin(), d.causes.end(),
                   [&](const std::string& c) { return c.find(r.lightFrame.doubt) != std::string::npos; }))
    add(r.lightFrame.doubt);
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

// SPDX-License-Identifier: BSD-3-Clause
#include "core/diagnose/diagnosis.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/angle.h"
#include "core/base/light_name.h"
#include "core/base/number_text.h"
#include "core/diagnose/candidates.h"
#include "core/diagnose/spurious_note.h"
#include "core/diagnostics/conditioning.h"
#include "core/scene/frame_spec.h"
#include "core/selection/selection.h"

namespace glint {
namespace {

constexpr std::size_t kMostNamed = 4;           // views in one sentence; --json has all that are measured
constexpr std::size_t kMostLeftOutOfScore = 2;  // more frames are no exceptions
constexpr double kSolved = 0.25;                // of the error before: a smaller gain leaves the search worth its time
constexpr int kMostFrames = 10;  // of the sequence, predicted each time: a mean of so many is known to a third of their spread

std::string placeOf(const Inspection& r, const HighlightEvidence& e) {
  return "frame " + r.scene->frames[std::size_t(e.frame)].id + ", " + lightName(e.light);
}

/// Errors of every model by its name, each measured once.
class ErrorsOfModels {
 public:
  ErrorsOfModels(const Inspection& inspection, const ProgressFn& progress)
      : r_(inspection), progress_(progress), frames_(spreadFrames(inspection, kMostFrames)) {}
  const std::vector<int>& frames() const { return frames_; }
  bool has(const std::string& model) const { return known_.count(model) > 0; }
  const LeftOutError& of(const std::string& model) {
    const auto it = known_.find(model);
    if (it != known_.end()) return it->second;
    return known_.emplace(model, unseenError(r_, r_, frames_, modelByName(model), progress_)).first->second;
  }

 private:
  const Inspection& r_;
  const ProgressFn& progress_;
  std::vector<int> frames_;
  std::map<std::string, LeftOutError> known_;
};

class ModelCase {
 public:
  ModelCase(const Inspection& inspection, const std::string& name, ErrorsOfModels& errors, const DiagnoseOptions& options,
            const ProgressFn& progress)
      : r_(inspection), model_(modelByName(name)), errors_(errors), options_(options), progress_(progress) {
    d_.model = name;
  }

  /// Causes, and remedies that cost next to nothing once the other models' errors are known.
  void start() {
    d_.unseen = errors_.of(d_.model);
    d_.evidence = highlightEvidence(r_, model_);
    judge();
    if (const auto result = r_.models.find(d_.model); result != r_.models.end())
      if (std::string note = spuriousNote(r_, result->second); !note.empty()) d_.notes.push_back(std::move(note));
    if (d_.status == ModelDiagnosis::Status::Ok) return;
    explain();
    otherModels(false);
    leaveOutOfScore();
  }

  /// The rest, each of which is a fit of its own.
  ModelDiagnosis finish() {
    if (d_.status == ModelDiagnosis::Status::Ok) return std::move(d_);
    const std::vector<CandidateChange> candidates = candidateChanges(r_, model_, d_.evidence);
    d_.known += static_cast<int>(candidates.size());
    otherModels(true);
    changes(candidates, false);
    changes(candidates, true);
    d_.fits = traceFits(r_, model_);  // after the remedies: it fits once more, and the first remedy must not wait for that
    std::stable_sort(d_.remedies.begin(), d_.remedies.end(), [](const Remedy& a, const Remedy& b) {
      return std::pair(!a.measured, a.after.meanPct()) < std::pair(!b.measured, b.after.meanPct());
    });
    return std::move(d_);
  }

  const ModelDiagnosis& soFar() const { return d_; }

 private:
  void judge() {
    const auto result = r_.models.find(d_.model);
    if (result == r_.models.end()) return;
    const std::vector<ModelResult::Fit>& fits = result->second.fits;
    const auto failed = std::count_if(fits.begin(), fits.end(), [](const auto& f) { return !f.fit; });
    if (fits.empty() || failed == static_cast<long>(fits.size())) {
      d_.status = ModelDiagnosis::Status::Failed;
    } else if (failed > 0 || isPoor(ofTraining(d_.unseen, true)) || isPoor(ofTraining(d_.unseen, false))) {
      d_.status = ModelDiagnosis::Status::Poor;
    }
  }

  static bool isPoor(const LeftOutError& error) {
    return error.answered() < static_cast<int>(error.views.size()) || error.meanPct() > kLargestExpectedPct;
  }

  void explain() {
    std::vector<std::string>& causes = d_.causes;
    for (const ModelResult::Fit& fit : r_.models.at(d_.model).fits)
      if (fit.failure()) causes.push_back(lightName(textOf(fit.key())) + ": " + fit.failure()->message());
    if (ofTraining(d_.unseen, true).views.empty()) causes.push_back("no training view can be used");
    if (!d_.unseen.firstFailure.empty()) causes.push_back(d_.unseen.firstFailure);
    oneLimitAngle();
    for (const Conditioning& c : conditioningOf(r_)) {
      if (c.model != d_.model) continue;
      for (const Finding& f : c.findings)
        if (f.verdict == Verdict::Red && f.id != "fit") causes.push_back(lightName(c.light) + ", " + f.title + ": " + f.reason);
    }
    goneAstray();
    std::vector<std::string> once;
    for (std::string& c : causes)
      if (std::find(once.begin(), once.end(), c) == once.end()) once.push_back(std::move(c));
    causes = std::move(once);
  }

  /// Views that the fit did not see and gets wrong, where the fit itself is there: what they have in common shows what the model misses.
  void goneAstray() {
    std::vector<const LeftOutError::View*> astray;
    for (const LeftOutError::View& v : d_.unseen.views)
      if (isAstray(v)) astray.push_back(&v);
    if (d_.status == ModelDiagnosis::Status::Failed || astray.empty()) return;
    std::stable_sort(astray.begin(), astray.end(), [](auto* a, auto* b) { return a->pct > b->pct; });
    std::string text = formatted("%zu of %zu views that the fit did not see are wrong: ", astray.size(), d_.unseen.views.size());
    for (std::size_t i = 0; i < astray.size() && i < kMostNamed; ++i) {
      const LeftOutError::View& v = *astray[i];
      text += (i ? ", " : "") + std::string(v.training ? "left-out" : "held-out") + " frame " +
              r_.scene->frames[std::size_t(v.frame)].id;
      text += v.answered ? formatted(" off by %.3g %%", v.pct) : " not predicted";
      text += formatted(" (a highlight of %.2g px radius)", v.radiusPx);
    }
    if (astray.size() > kMostNamed) text += formatted(" and %zu more", astray.size() - kMostNamed);
    d_.causes.push_back(std::move(text));
  }

  bool hasLobe() const {
    const std::vector<ModelResult::Fit>& fits = r_.models.at(d_.model).fits;
    return std::any_of(fits.begin(), fits.end(), [](const auto& f) { return f.fit && f.fit->template as<ReflectanceFit>(); });
  }

  void oneLimitAngle() {
    const LimitConflict c = limitConflict(d_.evidence);
    if (!c.wide || !model_.needsLight() || hasLobe()) return;
    d_.causes.push_back(formatted("two highlights have limit angles %.3g\u00b0 (", degrees(*c.wide->limitAngle)) +
                        placeOf(r_, *c.wide) + formatted(") and %.3g\u00b0 (", degrees(*c.narrow->limitAngle)) +
                        placeOf(r_, *c.narrow) + "): one limit angle cannot fit both");
  }

  void keep(const CandidateChange& candidate, const LeftOutError& after) {
    ++d_.tried;
    if (!isBetter(after, d_.unseen)) return;
    Remedy remedy{candidate.change, candidate.why, commonViews(d_.unseen, after), commonViews(after, d_.unseen)};
    if (options_.found) options_.found(d_.model, remedy);
    d_.remedies.push_back(std::move(remedy));
  }

  /// @param richest  that one alone, which takes seconds, or all but that
  void otherModels(bool richest) {
    for (const std::string& other : modelIds()) {
      if (other == d_.model || richest != (other == modelIds().back())) continue;
      ++d_.known;
      if (richest && solved() && !options_.slowToo && !errors_.has(other)) continue;
      keep({{.model = other}, modelByName(other).assumption()}, errors_.of(other));
    }
  }

  /// Few frames that go astray may show another part or another lamp. Their exclusion cannot be measured: it is offered with its price.
  void leaveOutOfScore() {
    std::vector<int> frames = r_.request.excluded;
    Remedy remedy;
    for (const LeftOutError::View& v : d_.unseen.views) {
      if (isAstray(v) && !v.training) frames.push_back(v.frame);
      if (!isAstray(v) || v.training) remedy.after.views.push_back(v);
    }
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    const std::size_t more = frames.size() - r_.request.excluded.size();
    if (d_.status == ModelDiagnosis::Status::Failed || more == 0 || more > kMostLeftOutOfScore) return;
    ++d_.known;
    ++d_.tried;
    remedy.change.exclude = frameSpec(frames, *r_.scene);
    remedy.why =
        "leaves frames out of the score that the model gets wrong; right only if their highlight is not of the part that matters";
    remedy.before = d_.unseen;
    remedy.measured = false;
    if (options_.found) options_.found(d_.model, remedy);
    d_.remedies.push_back(std::move(remedy));
  }

  /// Some remedy has brought nearly every view under the bound, and the error to a fraction of what it was.
  bool solved() const {
    return std::any_of(d_.remedies.begin(), d_.remedies.end(), [this](const Remedy& r) {
      return r.measured && 4 * r.after.views.size() >= 3 * d_.unseen.views.size() &&
             r.after.answered() == static_cast<int>(r.after.views.size()) &&
             r.after.meanPct() <= std::min(kLargestExpectedPct, kSolved * r.before.meanPct());
    });
  }

  /// Evidence and views under the change.
  Inspection changed(const Change& change) const {
    InspectionRequest request = with(r_.request, change, *r_.scene);
    request.models.clear();
    if (!change.exclude) {
      const TrainSpec train = parseTrainSpec(request.train, *r_.scene);
      return inspectOneFrame(r_.given, request, train.frames.at(0), progress_, &r_);
    }
    Inspection fewer = r_;
    fewer.request = request;
    std::erase_if(fewer.train.frames, [&](int f) { return isExcluded(request, f); });
    fewer.views.clear();
    fewer.viewsAsGiven.clear();
    for (std::size_t i = 0; i < r_.views.size(); ++i) {
      if (isExcluded(request, r_.views[i].frame)) continue;
      if (const auto given = r_.viewsAsGiven.find(int(i)); given != r_.viewsAsGiven.end())
        fewer.viewsAsGiven.emplace(int(fewer.views.size()), given->second);
      fewer.views.push_back(r_.views[i]);
    }
    return fewer;
  }
  static bool isExcluded(const InspectionRequest& request, int frame) {
    return std::binary_search(request.excluded.begin(), request.excluded.end(), frame);
  }

  void changes(const std::vector<CandidateChange>& candidates, bool slow) {
    const int most = hasLobe() && !options_.slowToo ? (options_.mostTried + 1) / 2 : options_.mostTried;  // seconds for each
    for (const CandidateChange& candidate : candidates) {
      if (candidate.slow != slow) continue;
      if (measured_ >= most || (!options_.slowToo && solved())) break;
      if (!report(progress_, {d_.model + ": try " + flagsOf(candidate.change), measured_, static_cast<int>(candidates.size())}))
        throw Stopped{};
      const Inspection inspection = changed(candidate.change);
      keep(candidate, candidate.newContours ? leftOutError(inspection, model_, progress_)
                                            : unseenError(inspection, r_, errors_.frames(), model_, progress_));
      ++measured_;
    }
  }

  const Inspection& r_;
  const HighlightModel& model_;
  ErrorsOfModels& errors_;
  const DiagnoseOptions& options_;
  const ProgressFn& progress_;
  ModelDiagnosis d_;
  int measured_ = 0;  ///< changes, other models aside
};

}  // namespace

const char* nameOf(ModelDiagnosis::Status status) {
  switch (status) {
    case ModelDiagnosis::Status::Ok: return "ok";
    case ModelDiagnosis::Status::Poor: return "poor";
    case ModelDiagnosis::Status::Failed: break;
  }
  return "failed";
}

std::string flagsOf(const Change& change) {
  std::string text;
  const auto add = [&](const char* flag, const std::optional<std::string>& value) {
    if (value) text += (text.empty() ? "" : " ") + (flag + (" " + *value));
  };
  add("--model", change.model);
  add("--train", change.train);
  add("--set", change.set);
  add("--exclude", change.exclude);
  return text;
}

InspectionRequest with(InspectionRequest request, const Change& change, const Scene& scene) {
  if (change.model) request.models = {*change.model};
  if (change.train) request.train = *change.train;
  if (change.set) {
    const std::size_t equals = change.set->find('=');
    request.settings.setFromText(change.set->substr(0, equals),
                                 equals == std::string::npos ? "" : change.set->substr(equals + 1));
  }
  if (change.exclude) {
    for (const int frame : parseFrames(*change.exclude, scene, "--exclude")) request.excluded.push_back(frame);
    std::sort(request.excluded.begin(), request.excluded.end());
    request.excluded.erase(std::unique(request.excluded.begin(), request.excluded.end()), request.excluded.end());
  }
  return request;
}

Diagnosis diagnose(const Inspection& inspection, const DiagnoseOptions& options, const ProgressFn& progress) {
  ErrorsOfModels errors(inspection, progress);
  std::vector<ModelCase> cases;
  cases.reserve(inspection.request.models.size());
  std::vector<std::size_t> quick, slow;
  for (const std::string& model : inspection.request.models) {
    (model == modelIds().back() ? slow : quick).push_back(cases.size());
    cases.emplace_back(inspection, model, errors, options, progress);
  }
  // Somebody may wait: first what every model answers at once, then the rest, beginning with the model that is nearest to being good.
  for (const std::size_t i : quick) cases[i].start();
  std::stable_sort(quick.begin(), quick.end(), [&](std::size_t a, std::size_t b) {
    const LeftOutError &x = cases[a].soFar().unseen, &y = cases[b].soFar().unseen;
    if (x.views.empty() || y.views.empty()) return x.views.size() > y.views.size();
    return std::pair(-x.answered(), x.meanPct()) < std::pair(-y.answered(), y.meanPct());
  });
  Diagnosis all;
  all.models.resize(cases.size());
  for (const std::size_t i : quick) all.models[i] = cases[i].finish();
  for (const std::size_t i : slow) {
    cases[i].start();
    all.models[i] = cases[i].finish();
  }
  return all;
}

}  // namespace glint

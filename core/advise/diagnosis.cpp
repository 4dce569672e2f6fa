// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "core/advise/diagnosis_parts.h"
#include "core/base/number_text.h"
#include "core/choice/selection.h"
#include "core/scene/frame_name.h"

namespace glint {
namespace {

constexpr double kNotFar = 5;  // times the least error: a change may make a model with more the best one

bool isAsItIs(const Change& change) { return !change.train && !change.set && !change.exclude && change.alsoSet.empty(); }

/// Null if the model was not computed as it is.
const UnseenError* errorOf(const Diagnosis& d, const std::string& model) {
  const auto it = std::find_if(d.measured.begin(), d.measured.end(),
                               [&](const Measured& m) { return isAsItIs(m.change) && m.change.model == model; });
  return it == d.measured.end() ? nullptr : &it->error;
}

/// One of each kind is enough.
std::string kindOf(const Change& change) {
  return change.set       ? change.set->substr(0, change.set->find('='))
         : change.train   ? "train"
         : change.exclude ? "exclude"
                          : "model";
}

std::vector<Remedy> remediesFor(const Diagnosis& d) {
  std::vector<Remedy> all, kept;
  const UnseenError* const best = errorOf(d, d.best);
  for (const Measured& m : d.measured) {
    const bool here = m.change.model == d.present;
    if ((here && isAsItIs(m.change)) || !isBetter(m.error, d.now)) continue;
    // Where a model as it is does as well, the change is not what helps.
    if (!isAsItIs(m.change) && best && !isBetter(m.error, *best)) continue;
    all.push_back({m.change, m.why, commonViews(d.now, m.error), commonViews(m.error, d.now)});
    if (here) all.back().change.model.reset();
  }
  std::stable_sort(all.begin(), all.end(), [](const Remedy& a, const Remedy& b) { return a.after.pct() < b.after.pct(); });
  for (Remedy& r : all)
    if (kept.size() < kMostRemedies &&
        std::none_of(kept.begin(), kept.end(), [&](const Remedy& k) { return kindOf(k.change) == kindOf(r.change); }))
      kept.push_back(std::move(r));
  return kept;
}

std::string verdictOf(const Diagnosis& d) {
  if (d.now.observed() == 0) return "Nothing can be measured: no frame shows a highlight that a model could be compared with.";
  if (!d.remedies.empty()) {
    const Remedy& r = d.remedies.front();
    std::string words = wordsOf(r.change);
    words[0] = char(std::toupper(words[0]));
    return words + ": the error is " + textOf(r.after) + ", where " + d.present +
           (r.before.matched() > 0 ? " as it is has " + textOf(r.before) : " predicts no observed highlight") + ".";
  }
  const std::string helps = d.complete ? "Nothing that was tried helps: " : "So far: ";
  if (d.best.empty()) return helps + "no model predicts an observed highlight.";
  const UnseenError& best = *errorOf(d, d.best);
  if (d.best != d.present)
    return helps + "the error of " + d.present + " is " + textOf(d.now) + ", and the smallest, " + textOf(best) + " of " +
           d.best + ", is not smaller beyond chance.";
  const std::string error = d.best + " is best, with an error of " + textOf(best);
  return best.pct() <= kNegligiblePct ? "Nothing is left to improve: " + error + "." : helps + error + ".";
}

class Adviser {
 public:
  Adviser(const Inspection& inspection, const DiagnoseOptions& options, const ProgressFn& progress)
      : r_(inspection), options_(options), progress_(progress) {}

  Diagnosis run() {
    compareComputed();
    tryModels();
    tryChanges();
    d_.complete = true;
    explain();
    askAuto();
    return std::move(d_);
  }

 private:
  using Results = std::shared_ptr<const Inspection>;

  /// The next step of the work, which the user sees counted; what runs in it can be stopped whenever it reports.
  ProgressFn step(const std::string& what) {
    const StageEvent now{what, done_++, std::max(total_, done_)};
    if (!report(progress_, now)) throw Stopped{};
    return [this, now](const StageEvent&) { return report(progress_, now); };
  }

  void tell() {
    adviseFor(d_, d_.present);
    if (options_.soFar) options_.soFar(d_);
  }

  void compareComputed() {
    const std::size_t asked = r_.request.models.size(), others = modelIds().size() - std::min(asked, modelIds().size());
    total_ = int(others + asked) + options_.mostTried + 3;
    const ProgressFn progress = step("compare the models");
    for (const std::string& model : r_.request.models)
      if (r_.models.count(model)) add(model, Results(Results(), &r_), unseenError(r_, model, progress));  // not owned
    adviseFor(d_, options_.present);
    tell();
  }

  void add(const std::string& model, Results of, UnseenError error) {
    results_[model] = std::move(of);
    d_.measured.push_back({{.model = model}, modelByName(model).assumption(), std::move(error)});
  }

  /// Runs the request with a change, for one model alone. Nothing if the program refuses that combination.
  /// @param previous  what has most in common with it: only the rest is computed
  Results measured(const Inspection& previous, const Change& change, const std::string& model, UnseenError& error) {
    const ProgressFn progress = step("try " + flagsOf(change));
    InspectionRequest request = with(r_.request, change, *r_.scene);
    request.models = {model};
    try {
      const auto of = std::make_shared<const Inspection>(inspect(r_.given, request, progress, &previous));
      error = unseenError(*of, model, progress);
      if (change.alsoSet.empty()) ++d_.tried;
      return of;
    } catch (const InputError&) {
      return nullptr;
    }
  }

  /// To improve, by what contours resolve.
  bool nothingIsLeft() const { return !d_.best.empty() && errorOf(d_, d_.best)->pct() <= kNegligiblePct; }

  void tryModels() {
    for (const std::string& model : modelIds()) {
      if (results_.count(model) || nothingIsLeft()) continue;
      ++d_.known;
      UnseenError error;
      if (Results of = measured(r_, {.model = model}, model, error)) add(model, std::move(of), std::move(error));
      tell();
    }
  }

  /// What may help the best model and those close to it, their first changes first. If none answers, the present one. All models,
  /// where the highlights contradict what is stated of the light: that alone may be why they fail.
  std::vector<CandidateChange> changesWorthATrial() {
    const ProgressFn progress = step("find changes to try");
    const bool contradicted = r_.request.settings.text("light.frame") != "auto" && !r_.lightFrame.doubt.empty();
    std::vector<std::pair<double, std::string>> bases;
    for (const auto& [model, of] : results_) {
      const double pct = errorOf(d_, model)->pct();
      if (contradicted || (d_.best.empty() ? model == d_.present : pct <= kNotFar * errorOf(d_, d_.best)->pct()))
        bases.emplace_back(pct, model);
    }
    std::sort(bases.begin(), bases.end());
    std::vector<std::pair<std::size_t, CandidateChange>> ranked;
    for (const auto& [pct, model] : bases) {
      std::vector<CandidateChange> candidates = candidateChanges(*results_.at(model), model, progress);
      d_.known += int(candidates.size());
      const int most = model == bases.front().second ? options_.mostTried : (options_.mostTried + 2) / 3;
      candidates.resize(std::min(candidates.size(), std::size_t(most)));
      for (std::size_t i = 0; i < candidates.size(); ++i) {
        candidates[i].change.model = model;
        ranked.emplace_back(i, std::move(candidates[i]));
      }
    }
    std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<CandidateChange> all;
    for (auto& [rank, candidate] : ranked) all.push_back(std::move(candidate));
    return all;
  }

  /// If no lobe explained the pixels, a change will hardly alter that: contours alone say first what each change comes to.
  std::vector<CandidateChange> quickFormsOf(const std::vector<CandidateChange>& all) const {
    std::vector<CandidateChange> quick;
    for (const CandidateChange& c : all)
      if (const std::optional<Change> change = byContours(*results_.at(*c.change.model), c.change, *c.change.model))
        quick.push_back({*change, c.why + "; by contours alone, as no lobe explains the pixels"});
    return quick;
  }

  void tryChanges() {
    if (d_.now.observed() == 0 || nothingIsLeft()) return;
    std::vector<CandidateChange> all = changesWorthATrial();
    const std::vector<CandidateChange> quick = quickFormsOf(all);
    total_ = done_ + int(quick.size() + all.size() + r_.request.models.size()) + 1;
    for (const CandidateChange& c : quick) tryOut(c);
    // What is on show comes first: its command becomes shorter.
    std::stable_partition(all.begin(), all.end(), [&](const CandidateChange& c) { return isShown(c.change); });
    for (const CandidateChange& c : all) tryOut(c);
  }

  /// As a remedy, perhaps by contours alone.
  bool isShown(const Change& change) const {
    return std::any_of(d_.remedies.begin(), d_.remedies.end(), [&](const Remedy& r) {
      Change shown = r.change;
      shown.model = shown.model.value_or(d_.present);
      shown.alsoSet.clear();
      return shown == change;
    });
  }

  void tryOut(const CandidateChange& c) {
    UnseenError error;
    const Results of = measured(*nearest(c.change), c.change, *c.change.model, error);
    if (!of) return;
    const Change seen = framesAndEvidence(c.change);
    if (!isAsItIs(seen) && !nearby_.count(flagsOf(seen))) nearby_.emplace(flagsOf(seen), of);
    std::erase_if(d_.measured, [&](const Measured& m) {  // the same by contours alone: two flags that are not needed
      Change full = m.change;
      full.alsoSet.clear();
      return m.change != c.change && full == c.change && m.error.views == error.views;
    });
    d_.measured.push_back({c.change, c.why, std::move(error)});
    tell();
  }

  static Change framesAndEvidence(const Change& change) {
    return {.train = change.train, .exclude = change.exclude, .alsoSet = change.alsoSet};
  }

  /// Results with the same frames and evidence, whatever the model: these cost most of a trial. Else those with the same
  /// evidence, or the model as it is.
  Results nearest(const Change& change) const {
    for (const Change& seen : {framesAndEvidence(change), Change{.alsoSet = change.alsoSet}})
      if (const auto known = nearby_.find(flagsOf(seen)); known != nearby_.end()) return known->second;
    return results_.at(*change.model);
  }

  void explain() {
    for (const std::string& model : r_.request.models) {
      if (!r_.models.count(model)) continue;
      const ProgressFn progress = step("say why " + model + " is as it is");
      d_.models.push_back(diagnosisOf(r_, model, *errorOf(d_, model), progress));
    }
    tell();
  }

  /// It sees training frames only, so it may choose another model than held-out frames do. Not asked if one model answers.
  void askAuto() {
    const auto answers = std::count_if(results_.begin(), results_.end(),
                                       [&](const auto& entry) { return errorOf(d_, entry.first)->matched() > 0; });
    if (!options_.askAuto || answers < 2 || d_.now.leftOut) return;
    const Selection choice = selectModel(r_, std::nullopt, step("compare with --models auto"));
    if (choice.model == d_.best) return;
    const UnseenError* const error = errorOf(d_, choice.model);
    d_.notes.push_back("--models auto, which sees the training frames alone, chooses " +
                       (error ? choice.model + "; in the held-out frames its error is " + textOf(*error) + "." : "no model."));
    tell();
  }

  const Inspection& r_;
  const DiagnoseOptions& options_;
  const ProgressFn& progress_;
  Diagnosis d_;
  std::map<std::string, Results> results_;  ///< of the models as they are
  std::map<std::string, Results> nearby_;   ///< of changes, by the flags of their frames and evidence
  int done_ = 0, total_ = 0;                ///< steps
};

}  // namespace

std::string flagsOf(const Change& change) {
  std::string text;
  const auto add = [&](const char* flag, const std::optional<std::string>& value) {
    if (value) text += (text.empty() ? "" : " ") + (flag + (" " + *value));
  };
  add("--model", change.model);
  add("--train", change.train);
  add("--set", change.set);
  add("--exclude", change.exclude);
  for (const std::string& also : change.alsoSet) add("--set", also);
  return text;
}

InspectionRequest with(InspectionRequest request, const Change& change, const Scene& scene) {
  if (change.model) request.models = {*change.model};
  if (change.train) request.train = *change.train;
  const auto set = [&](const std::string& value) {
    const std::size_t equals = value.find('=');
    request.settings.setFromText(value.substr(0, equals), equals == std::string::npos ? "" : value.substr(equals + 1));
  };
  if (change.set) set(*change.set);
  for (const std::string& also : change.alsoSet) set(also);
  if (change.exclude) {
    for (const int frame : parseFrames(*change.exclude, scene, "--exclude")) request.excluded.push_back(frame);
    std::sort(request.excluded.begin(), request.excluded.end());
    request.excluded.erase(std::unique(request.excluded.begin(), request.excluded.end()), request.excluded.end());
  }
  return request;
}

std::string wordsOf(const Change& change) {
  std::string text;
  const auto add = [&](const char* verb, const std::optional<std::string>& value) {
    if (value) text += (text.empty() ? "" : " and ") + (verb + *value);
  };
  add("use ", change.model);
  add("train on ", change.train);
  const auto set = [&](const std::string& value) {
    const std::size_t equals = value.find('=');
    add("set ", value.substr(0, equals) + " = " + (equals == std::string::npos ? "" : value.substr(equals + 1)));
  };
  if (change.set) set(*change.set);
  add("leave out ", change.exclude);
  for (const std::string& also : change.alsoSet) set(also);
  return text;
}

void adviseFor(Diagnosis& d, const std::string& present) {
  d.best.clear();
  for (const std::string& model : modelIds()) {  // of equals the simplest
    const UnseenError* const error = errorOf(d, model);
    if (error && error->matched() > 0 && (d.best.empty() || error->pct() < errorOf(d, d.best)->pct())) d.best = model;
  }
  if (errorOf(d, present)) d.present = present;
  if (!errorOf(d, d.present)) d.present = d.best.empty() && !d.measured.empty() ? *d.measured.back().change.model : d.best;
  const UnseenError* const now = errorOf(d, d.present);
  d.now = now ? *now : UnseenError{};
  d.remedies = remediesFor(d);
  d.verdict = verdictOf(d);
}

std::string effectText(const Remedy& remedy) {
  // Between words and a number an arrow would not be read as "before and after".
  if (remedy.before.matched() == 0) return "no prediction before, " + textOf(remedy.after) + " after";
  return textOf(remedy.before) + " -> " + textOf(remedy.after);
}

Diagnosis diagnose(const Inspection& inspection, const DiagnoseOptions& options, const ProgressFn& progress) {
  return Adviser(inspection, options, progress).run();
}

}  // namespace glint

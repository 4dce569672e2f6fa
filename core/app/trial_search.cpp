// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/trial_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "core/base/number_text.h"
#include "core/choice/pareto.h"

namespace glint {
namespace {

// A model that is this many times worse in both is not worth its knobs: no single knob makes up for that.
constexpr double kHopelessError = 2, kHopelessTime = 1.5;
constexpr double kSameError = 1.01, kSameTime = 1.1;  // of two finalists nearer than this one is enough
constexpr double kWorthwhileError = 0.98;             // a value that takes less off the error is not combined with others
constexpr int kRounds = 4;                            // of combinations: that many knobs away from a model's base

struct Tried {
  Trial trial;
  TrialResult result;
  bool base = false;
  Cost cost() const { return {result.errorPct, result.us}; }
};

/// A value of a knob that is worth combining, with what it alone did: factors on error and time.
struct Promising {
  std::string key;
  SettingValue value;
  double errorFactor = 1, usFactor = 1;
};

std::string idOf(const Trial& t, const std::vector<Knob>& knobs) {
  std::string id = t.model;
  for (const Knob& k : knobs) id += "|" + textOf(t.settings.value(k.key));
  return id;
}

std::string costText(const Cost& c) { return formatted("%.3g %% at %.3g us", c.errorPct, c.us); }

/// Its time is measured, that of a fit is not.
bool usedByPrediction(const Knob& k) { return k.key.rfind("predict.", 0) == 0 || k.key.rfind("surface.", 0) == 0; }

bool lookedAtBy(const Knob& k, const std::string& model) { return k.onlyModel.empty() || k.onlyModel == model; }

double factor(double now, double before) {
  return before > 0 ? now / before : now > 0 ? std::numeric_limits<double>::infinity() : 1;
}

class Search {
 public:
  Search(const std::vector<Knob>& knobs, const std::function<Outcome<TrialResult>(const Trial&)>& tryOne,
         const SearchOptions& options)
      : knobs_(knobs), tryOne_(tryOne), options_(options) {}

  SearchResult run(const std::vector<std::string>& models, const Settings& base) {
    for (const std::string& m : models) findBase(m, base);
    for (const std::string& m : models)
      if (bases_.count(m) && !hopeless(m)) oneKnobAtATime(m);
    combine();
    pickFinalists();
    return std::move(result_);
  }

 private:
  std::optional<int> attempt(const Trial& t) {
    const std::string id = idOf(t, knobs_);
    if (!seen_.insert(id).second) return std::nullopt;
    if (result_.trials >= options_.maxTrials) {
      prune(t, "limit", "the limit of " + std::to_string(options_.maxTrials) + " trials was reached");
      return std::nullopt;
    }
    ++result_.trials;
    Outcome<TrialResult> r = tryOne_(t);
    if (!r) {
      prune(t, "failed", r.failure().message());
      return std::nullopt;
    }
    if (!std::isfinite(r->errorPct) || !std::isfinite(r->us)) {
      prune(t, "failed", "no finite error");
      return std::nullopt;
    }
    if (!r->poor.empty()) {
      poor_.push_back({t, static_cast<int>(result_.pruned.size())});
      prune(t, "poor", r->poor, {r->errorPct, r->us});
      return std::nullopt;
    }
    tried_.push_back({t, std::move(*r)});
    return static_cast<int>(tried_.size()) - 1;
  }

  void prune(const Trial& t, const std::string& kind, const std::string& reason,
             const Cost& cost = {std::nan(""), std::nan("")}) {
    result_.pruned.push_back({t.model, t.settings, kind, reason, cost.errorPct, cost.us});
  }

  /// The model with the base settings; where they fail, with the first single change of light or fit that answers.
  void findBase(const std::string& model, const Settings& settings) {
    std::optional<int> found = attempt({model, settings});
    for (const Knob& k : knobs_) {
      if (found) break;
      if (usedByPrediction(k) || !lookedAtBy(k, model)) continue;
      for (const SettingValue& v : k.values) {
        Trial t{model, settings};
        t.settings.set(k.key, v);
        if ((found = attempt(t))) break;
      }
    }
    if (!found) return;
    tried_[*found].base = true;
    bases_[model] = *found;
  }

  bool hopeless(const std::string& model) {
    const Tried& mine = tried_[bases_.at(model)];
    for (const auto& [other, index] : bases_) {
      if (other == model || !clearlyDominates(tried_[index].cost(), mine.cost(), kHopelessError, kHopelessTime)) continue;
      prune(mine.trial, "model dominated",
            "none of its settings was varied: " + costText(mine.cost()) + " against " + costText(tried_[index].cost()) +
                " with " + other,
            mine.cost());
      return true;
    }
    return false;
  }

  void oneKnobAtATime(const std::string& model) {
    const int baseIndex = bases_.at(model);
    for (const Knob& k : knobs_) {
      if (!lookedAtBy(k, model)) continue;
      for (const SettingValue& v : k.values) {
        Trial t = tried_[baseIndex].trial;
        if (t.settings.value(k.key) == v) continue;
        t.settings.set(k.key, v);
        const std::optional<int> index = attempt(t);
        if (!index) continue;
        const Tried &now = tried_[*index], &base = tried_[baseIndex];
        const Cost a = now.cost(), b = base.cost();
        const std::string what = knobName(k.key) + " " + textOf(v) + ": " + costText(a) + " against " + costText(b);
        const double time = factor(a.us, b.us), error = factor(a.errorPct, b.errorPct);
        // What comes before prediction cannot change its time without changing what is predicted.
        const bool sameTime = !usedByPrediction(k) || (time < kTimeSlack && time * kTimeSlack > 1);
        // With such a knob a shorter time is noise, or a fit that answers less; it is worth combining for its error alone.
        const bool slower = !usedByPrediction(k) || time * kTimeSlack > 1;
        if (now.result.predictions == base.result.predictions && sameTime) {
          prune(t, "no effect", what + ", the same contours", a);
        } else if (error > kWorthwhileError && slower) {
          prune(t, "not better", what, a);
        } else {
          promising_[model].push_back({k.key, v, error, usedByPrediction(k) ? time : 1});
          continue;
        }
        given_.insert(*index);
      }
    }
  }

  /// Some trial that clearly dominates this cost; -1 if none does.
  int dominator(const Cost& c) const {
    for (int i = 0; i < static_cast<int>(tried_.size()); ++i)
      if (clearlyDominates(tried_[i].cost(), c, kErrorSlack, kTimeSlack)) return i;
    return -1;
  }

  /// `a` stands for `b`: the same model, not worse by more than could be told.
  static bool sameAs(const Tried& a, const Tried& b) {
    return a.trial.model == b.trial.model && a.result.errorPct <= b.result.errorPct * kSameError &&
           a.result.us <= b.result.us * kSameTime;
  }

  void combine() {
    std::vector<char> expanded;
    for (int round = 0; round < kRounds; ++round) {
      const std::size_t before = tried_.size();
      expanded.resize(before, 0);
      for (std::size_t i = 0; i < before; ++i) {
        if (expanded[i] || given_.count(static_cast<int>(i)) || dominator(tried_[i].cost()) >= 0) continue;
        // What cannot be told from a setting that was combined already leads to the same places.
        bool known = false;
        for (std::size_t e = 0; e < before && !known; ++e) known = expanded[e] && sameAs(tried_[e], tried_[i]);
        if (known) continue;
        expanded[i] = 1;
        if (!promising_.count(tried_[i].trial.model)) continue;
        for (const Promising& p : promising_.at(tried_[i].trial.model)) {
          const Tried from = tried_[i];
          const SettingValue baseValue = tried_[bases_.at(from.trial.model)].trial.settings.value(p.key);
          if (from.trial.settings.value(p.key) != baseValue) continue;  // this knob was already turned
          Trial t = from.trial;
          t.settings.set(p.key, p.value);
          if (seen_.count(idOf(t, knobs_))) continue;
          const Cost expected{from.result.errorPct * p.errorFactor, from.result.us * p.usFactor};
          if (const int better = dominator(expected); better >= 0) {
            seen_.insert(idOf(t, knobs_));
            prune(t, "expected to be dominated",
                  "its settings, one by one, promise " + costText(expected) + ", worse than " + costText(tried_[better].cost()) +
                      " with " + tried_[better].trial.model);
            continue;
          }
          attempt(t);
        }
      }
      if (tried_.size() == before) break;
    }
  }

  void pickFinalists() {
    std::vector<int> order, kept;
    for (int i = 0; i < static_cast<int>(tried_.size()); ++i)
      if (!given_.count(i)) order.push_back(i);
    std::vector<Cost> costs;
    for (const Tried& t : tried_) costs.push_back(t.cost());
    const std::vector<char> front = paretoFront(costs);
    // Bases first, then the front: what is kept decides what is "the same as".
    const auto rank = [&](int i) { return tried_[i].base ? 0 : front[i] ? 1 : 2; };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return rank(a) != rank(b) ? rank(a) < rank(b) : tried_[a].result.us < tried_[b].result.us;
    });
    for (const int i : order) {
      const Tried& t = tried_[i];
      if (!t.base) {
        if (const int better = dominator(t.cost()); better >= 0) {
          prune(t.trial, "dominated",
                costText(t.cost()) + ", worse than " + costText(tried_[better].cost()) + " with " + tried_[better].trial.model,
                t.cost());
          continue;
        }
        const auto same = std::find_if(kept.begin(), kept.end(), [&](int k) { return sameAs(tried_[k], t); });
        if (same != kept.end()) {
          prune(t.trial, "indistinguishable",
                costText(t.cost()) + ", the same as " + costText(tried_[*same].cost()) + " of the same model", t.cost());
          continue;
        }
        if (static_cast<int>(kept.size()) >= options_.maxFinalists) {
          prune(t.trial, "limit", "the limit of " + std::to_string(options_.maxFinalists) + " full measurements was reached",
                t.cost());
          continue;
        }
      }
      kept.push_back(i);
    }
    for (const int i : kept) result_.finalists.push_back(tried_[i].trial);
    if (result_.finalists.empty()) takePoorOnes();
  }

  /// No other one answers: the first of each model.
  void takePoorOnes() {
    std::set<std::string> taken;
    std::vector<char> keep(result_.pruned.size(), 1);
    for (const auto& [trial, pruned] : poor_) {
      if (!taken.insert(trial.model).second) continue;
      result_.finalists.push_back(trial);
      keep[static_cast<std::size_t>(pruned)] = 0;
    }
    std::vector<PrunedPoint> left;
    for (std::size_t i = 0; i < keep.size(); ++i)
      if (keep[i]) left.push_back(std::move(result_.pruned[i]));
    result_.pruned = std::move(left);
  }

  const std::vector<Knob>& knobs_;
  const std::function<Outcome<TrialResult>(const Trial&)>& tryOne_;
  const SearchOptions& options_;
  SearchResult result_;
  std::vector<Tried> tried_;
  std::set<int> given_;                      ///< tried and pruned
  std::vector<std::pair<Trial, int>> poor_;  ///< with their places in SearchResult::pruned
  std::set<std::string> seen_;
  std::map<std::string, int> bases_;
  std::map<std::string, std::vector<Promising>> promising_;
};

}  // namespace

SearchResult searchTrials(const std::vector<std::string>& models, const Settings& base, const std::vector<Knob>& knobs,
                          const std::function<Outcome<TrialResult>(const Trial&)>& tryOne, const SearchOptions& options) {
  return Search(knobs, tryOne, options).run(models, base);
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/base/outcome.h"
#include "core/choice/pareto.h"
#include "core/choice/tradeoff.h"

namespace glint {
namespace {

std::string costText(const TradeoffPoint& p) {
  return formatted("%.3g %%", p.rankedErrorPct) + " at " + formatted("%.3g us", p.predictUs);
}

/// The last point of the front within a bound, and the first one beyond it; -1 without one.
struct Bounded {
  int best = -1, next = -1;
};
template <class Within>
Bounded boundedOn(const std::vector<int>& front, const Within& within) {
  Bounded b;
  for (const int i : front) {
    if (within(i))
      b.best = i;
    else if (b.next < 0)
      b.next = i;
  }
  return b;
}

std::string said(const Tradeoff& t, int i) { return describe(t, t.points[i]) + " (" + costText(t.points[i]) + " per frame)"; }

/// @param front  points by time
void chooseWithinBudget(Tradeoff& t, const std::vector<Cost>& costs, const std::vector<int>& front, double budgetUs) {
  Bounded b = boundedOn(front, [&](int i) { return costs[i].us <= budgetUs; });
  const std::string budget = formatted("%g us", budgetUs);
  if (b.best < 0) {
    t.reason = "No measured setting predicts a frame within " + budget + "; the fastest is " + said(t, 0) + ".";
    return;
  }
  // The fastest with the same error, as the preset.
  const double same = costs[b.best].errorPct + kSameErrorPct;
  b.best = *std::find_if(front.begin(), front.end(), [&](int i) { return costs[i].errorPct <= same; });
  t.chosen = b.best;
  t.reason = "The most accurate setting within " + budget + " per frame is " + said(t, b.best) +
             (b.next < 0 ? "; no slower one is more accurate."
                         : "; the next more accurate one, " + said(t, b.next) + ", is over the budget.");
}

/// @param front  points by time
void chooseWithinError(Tradeoff& t, const std::vector<Cost>& costs, std::vector<int> front, double maxErrorPct, int exact) {
  std::reverse(front.begin(), front.end());
  const Bounded b = boundedOn(front, [&](int i) { return costs[i].errorPct <= maxErrorPct; });
  const std::string most = formatted("%g %%", maxErrorPct);
  if (b.best < 0) {
    t.reason = "No measured setting has an error of at most " + most + "; the most accurate is " + said(t, exact) + ".";
    return;
  }
  t.chosen = b.best;
  t.reason =
      "The fastest setting with an error of at most " + most + " is " + said(t, b.best) +
      (b.next < 0 ? "; no measured one is faster." : "; the next faster one, " + said(t, b.next) + ", is over that error.");
}

void chooseBalanced(Tradeoff& t, const Presets& presets) {
  t.chosen = presets.balanced;
  if (presets.fast == presets.exact)
    t.reason = said(t, presets.exact) + " is both the fastest usable and the most accurate setting.";
  else
    // Where it is one of the others, presetNote() says so.
    t.reason = "The balanced preset, the knee of the front: " + said(t, presets.balanced) +
               (presets.balanced == presets.fast ? "" : "; fast: " + said(t, presets.fast)) +
               (presets.balanced == presets.exact ? "" : "; exact: " + said(t, presets.exact)) + ".";
}

}  // namespace

double rankedErrorPct(const TradeoffPoint& p) {
  const bool complete = p.missed == 0 && p.spurious == 0 && p.predicted == p.frames && p.coverage >= kFullCoverage;
  if (complete) return p.contourErrorPct;
  const double missed = p.missed, spurious = p.spurious,
               all = p.matched + missed + spurious;  // counts of a file may be as large as an int
  if (all == 0) return 100;
  const double coverage = std::isfinite(p.coverage) ? std::clamp(p.coverage, 0.0, 1.0) : 0;
  const double matched = p.matched > 0 ? coverage * p.contourErrorPct + (1 - coverage) * 100 : 0;
  return (p.matched * matched + 100.0 * (missed + spurious)) / all;
}

void choosePoint(Tradeoff& t, const TradeoffBound& bound) {
  std::stable_sort(t.points.begin(), t.points.end(),
                   [](const TradeoffPoint& a, const TradeoffPoint& b) { return a.predictUs < b.predictUs; });
  std::vector<Cost> costs;
  // A poor setting counts only where no other answers.
  const bool anyOk = std::any_of(t.points.begin(), t.points.end(), [](const TradeoffPoint& p) { return p.poor.empty(); });
  for (const TradeoffPoint& p : t.points)
    costs.push_back({anyOk && !p.poor.empty() ? std::nan("") : p.rankedErrorPct, p.predictUs});
  const std::vector<char> onFront = paretoFront(costs);
  std::vector<int> front;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    t.points[i].pareto = onFront[i] != 0;
    if (onFront[i]) front.push_back(static_cast<int>(i));
  }
  t.presets.clear();
  t.chosen.reset();
  const Presets presets = presetsOf(costs);
  if (presets.exact < 0) {
    t.reason = "No setting predicted an observed highlight.";
    return;
  }
  t.presets = {{"fast", presets.fast}, {"balanced", presets.balanced}, {"exact", presets.exact}};
  if (bound.budgetUs)
    chooseWithinBudget(t, costs, front, *bound.budgetUs);
  else if (bound.maxErrorPct)
    chooseWithinError(t, costs, front, *bound.maxErrorPct, presets.exact);
  else
    chooseBalanced(t, presets);
}

const TradeoffPoint& pointOfPreset(const Tradeoff& t, const std::string& name) {
  const auto fail = [&](const std::string& why) { return InputError("", "--preset " + name, why); };
  if (name == "chosen") {
    if (!t.chosen) throw fail("no point was chosen: " + t.reason);
    return t.points[*t.chosen];
  }
  const auto it = t.presets.find(name);
  if (it == t.presets.end()) {
    std::string known;
    for (const auto& [preset, index] : t.presets) known += preset + ", ";
    throw fail("unknown preset; known: " + known + "chosen");
  }
  return t.points[it->second];
}

}  // namespace glint

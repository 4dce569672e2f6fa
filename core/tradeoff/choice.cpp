// SPDX-License-Identifier: BSD-3-Clause
#include "core/tradeoff/choice.h"

#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/base/outcome.h"
#include "core/tradeoff/pareto.h"

namespace glint {
namespace {

std::string costText(const TradeoffPoint& p) {
  return formatted("%.3g %%", p.rankedErrorPct) + " at " + formatted("%.3g us", p.predictUs);
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
  const std::vector<char> front = paretoFront(costs);
  for (std::size_t i = 0; i < costs.size(); ++i) t.points[i].pareto = front[i] != 0;
  t.presets.clear();
  t.chosen.reset();
  const Presets presets = presetsOf(costs);
  if (presets.exact < 0) {
    t.reason = "No setting predicted an observed highlight.";
    return;
  }
  t.presets = {{"fast", presets.fast}, {"balanced", presets.balanced}, {"exact", presets.exact}};
  const auto said = [&](int i) { return describe(t, t.points[i]) + " (" + costText(t.points[i]) + " per frame)"; };
  if (bound.budgetUs) {
    int best = -1, next = -1;
    for (int i = 0; i < static_cast<int>(costs.size()); ++i) {
      if (!front[i]) continue;
      if (costs[i].us <= *bound.budgetUs)
        best = i;  // along the front the error falls with time
      else if (next < 0)
        next = i;
    }
    if (best >= 0) {  // of the same error the fastest, as the preset
      const double same = costs[best].errorPct + kSameErrorPct;
      for (int i = best; i >= 0; --i)
        if (front[i] && costs[i].errorPct <= same) best = i;
    }
    const std::string budget = formatted("%g us", *bound.budgetUs);
    if (best < 0) {
      t.reason = "No measured setting predicts a frame within " + budget + "; the fastest is " + said(0) + ".";
      return;
    }
    t.chosen = best;
    t.reason = "The most accurate setting within " + budget + " per frame is " + said(best) +
               (next < 0 ? "; no slower one is more accurate."
                         : "; the next more accurate one, " + said(next) + ", is over the budget.");
    return;
  }
  if (bound.maxErrorPct) {
    int best = -1, next = -1;
    for (int i = static_cast<int>(costs.size()) - 1; i >= 0; --i) {
      if (!front[i]) continue;
      if (costs[i].errorPct <= *bound.maxErrorPct)
        best = i;
      else if (next < 0)
        next = i;
    }
    const std::string most = formatted("%g %%", *bound.maxErrorPct);
    if (best < 0) {
      t.reason = "No measured setting has an error of at most " + most + "; the most accurate is " + said(presets.exact) + ".";
      return;
    }
    t.chosen = best;
    t.reason = "The fastest setting with an error of at most " + most + " is " + said(best) +
               (next < 0 ? "; no measured one is faster." : "; the next faster one, " + said(next) + ", is over that error.");
    return;
  }
  t.chosen = presets.balanced;
  if (presets.fast == presets.exact)
    t.reason = said(presets.exact) + " is both the fastest usable and the most accurate setting.";
  else
    // Where it is one of the others, presetNote() says so.
    t.reason = "The balanced preset, the knee of the front: " + said(presets.balanced) +
               (presets.balanced == presets.fast ? "" : "; fast: " + said(presets.fast)) +
               (presets.balanced == presets.exact ? "" : "; exact: " + said(presets.exact)) + ".";
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

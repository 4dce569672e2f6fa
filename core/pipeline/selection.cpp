// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/selection.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "core/base/parallel.h"
#include "core/evaluate/summary.h"
#include "core/pipeline/leave_one_out.h"

namespace glint {
namespace {

/// A frame that is to be predicted shows a surface of the scene file that no training view shows. Depth maps are one object seen
/// from many sides, so they do not count.
bool predictsOtherSurfaces(const Inspection& inspection) {
  if (inspection.train.perSurface) return false;
  std::set<std::string> seen;
  const std::vector<Frame>& frames = inspection.scene->frames;
  for (const TrainingView& v : inspection.views) seen.insert(frames[v.frame].surface);
  for (int f = 0; f < static_cast<int>(frames.size()); ++f)
    if (inspection.isHeldOut(f) && !frames[f].surface.empty() && !seen.count(frames[f].surface)) return true;
  return false;
}

/// What is known when a model is tried: its views need not all be tried once it cannot become the best any more.
struct Known {
  std::vector<char> possible;                             ///< by fold: some model answered it
  double best = std::numeric_limits<double>::infinity();  ///< smallest ranked error of an eligible model, over the possible folds
};

/// Error of a view as it counts in the ranking.
double countedPct(const Answer& a) { return a.errorPct ? *a.errorPct : kNoPredictionPct; }

/// Mean over the views that any model answers; NaN when there are none.
double rankedPct(const std::vector<Answer>& answers, const std::vector<char>& possible) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < answers.size(); ++i)
    if (possible[i]) sum += countedPct(answers[i]), ++count;
  return count ? sum / count : std::nan("");
}

/// Even without any error on the views that are left it would be worse than the best.
bool cannotWin(const std::vector<Answer>& answers, int tried, const Known& known) {
  double sum = 0;
  int count = 0;
  for (int i = 0; i < static_cast<int>(answers.size()); ++i) {
    if (i < tried && answers[i].errorPct && !known.possible[i]) return false;  // here it knows more than the best
    if (!known.possible[i]) continue;
    ++count;
    if (i < tried) sum += countedPct(answers[i]);
  }
  return count > 0 && sum / count > known.best;
}

Candidate tryModel(const Inspection& inspection, const HighlightModel& model, std::vector<Fold>& folds,
                   std::vector<Answer>& answers, const Known& known, const ProgressFn& progress) {
  Candidate c;
  c.model = model.id();
  c.views = static_cast<int>(folds.size());
  answers.assign(folds.size(), {});
  const Clock::time_point start = Clock::now();
  // In groups of fixed size, so that what is given up does not depend on the number of threads.
  constexpr int kGroup = 2;
  int tried = 0;
  while (tried < c.views && !cannotWin(answers, tried, known)) {
    const int count = std::min(kGroup, c.views - tried);
    const ProgressFn offset = [&](const StageEvent& e) { return report(progress, {e.stage, tried + e.done, c.views}); };
    parallelFor(
        count, [&](int i) { answers[tried + i] = leaveOut(folds[tried + i], model, inspection.request.settings); }, offset,
        "leave one out " + c.model);
    tried += count;
  }
  c.timeUs = microsecondsSince(start);
  std::vector<double> errors, times;
  for (int i = 0; i < tried; ++i) {
    if (answers[i].errorPct) {
      errors.push_back(*answers[i].errorPct);
      times.push_back(answers[i].predictUs);
    } else if (c.remark.empty()) {
      c.remark = "without frame " + inspection.scene->frames[folds[i].left->frame].id + ": " + answers[i].failure->message();
    }
  }
  c.tried = tried;
  c.answered = static_cast<int>(errors.size());
  double sum = 0, squares = 0;
  for (const double e : errors) sum += e;
  c.meanPct = errors.empty() ? std::nan("") : sum / double(errors.size());
  for (const double e : errors) squares += (e - c.meanPct) * (e - c.meanPct);
  c.standardErrorPct = errors.size() > 1 ? std::sqrt(squares / double(errors.size() - 1) / double(errors.size())) : std::nan("");
  c.predictUs = statisticOf(times).median;
  return c;
}

}  // namespace

Selection selectModel(const Inspection& inspection, const std::optional<double>& goodEnoughPct, const ProgressFn& progress) {
  Selection s;
  std::vector<Fold> folds = foldsOf(inspection);
  s.leftOut = static_cast<int>(folds.size());
  for (const TrainingView& v : inspection.views) s.trainingViews += v.failure ? 0 : 1;
  const bool otherSurfaces = predictsOtherSurfaces(inspection);
  std::vector<std::vector<Answer>> answers;
  std::vector<char> eligible;
  Known known;
  known.possible.assign(folds.size(), 0);
  bool nothingBetter = false;
  const auto ranked = [&](std::size_t m) { return rankedPct(answers[m], known.possible); };
  const auto choose = [&](std::size_t m, double mostPct) {
    s.candidates[m].remark = "chosen";
    s.model = s.candidates[m].model;
    s.patches = choosePatches(inspection, modelByName(s.model), folds, answers[m], mostPct, progress);
  };
  const auto errorText = [&](std::size_t m) {
    const Candidate& c = s.candidates[m];
    return percentText(ranked(m)) + (ranked(m) != c.meanPct && c.answered < c.tried ? " (a missing view counts as 100 %)" : "");
  };
  for (const auto& model : allModels()) {
    const std::size_t m = answers.size();
    answers.emplace_back();
    s.candidates.push_back(tryModel(inspection, *model, folds, answers[m], known, progress));
    Candidate& c = s.candidates.back();
    const bool bound =
        otherSurfaces && std::any_of(answers[m].begin(), answers[m].end(), [](const Answer& a) { return a.boundToSurface; });
    eligible.push_back(!bound && c.answered > 0 && c.tried == c.views);
    for (std::size_t i = 0; i < folds.size(); ++i)
      if (answers[m][i].errorPct) known.possible[i] = 1;
    if (bound)
      c.remark =
          "not eligible: frames to predict show surfaces that no training view shows, and its ellipsoid belongs to the surface "
          "it was seen on";
    else if (c.tried < c.views)
      c.remark = "given up after " + std::to_string(c.tried) + " views: already worse than the best" +
                 (c.remark.empty() ? "" : "; " + c.remark);
    known.best = std::numeric_limits<double>::infinity();
    for (std::size_t e = 0; e <= m; ++e)
      if (eligible[e]) known.best = std::min(known.best, ranked(e));
    if (!eligible[m] || c.answered < c.views) continue;
    if (goodEnoughPct && c.meanPct <= *goodEnoughPct) {
      s.why = "The simplest model under the stated tolerance of " + percentText(*goodEnoughPct) + ": " + c.model + " has " +
              percentText(c.meanPct) + " leaving one view out; richer models were not tried.";
      choose(m, *goodEnoughPct);
      return s;
    }
    // Whatever a richer one did, this one would be within what contours resolve of it.
    if (!goodEnoughPct && c.meanPct <= kNegligiblePct) {
      nothingBetter = m + 1 < allModels().size();
      break;
    }
  }
  int best = -1;
  for (std::size_t m = 0; m < s.candidates.size(); ++m)
    if (eligible[m] && (best < 0 || ranked(m) < ranked(best))) best = static_cast<int>(m);
  if (best < 0) {
    s.why = s.leftOut == 0 ? "There is no training view to leave out." : "No model predicted a left-out training view.";
    return s;
  }
  if (goodEnoughPct)  // a view that nothing answers tells nothing about the models
    for (std::size_t m = 0; m < s.candidates.size() && s.model.empty(); ++m)
      if (eligible[m] && ranked(m) <= *goodEnoughPct) {
        s.why = "The simplest model under the stated tolerance of " + percentText(*goodEnoughPct) + ": " + s.candidates[m].model +
                " has " + percentText(ranked(m)) + " leaving one view out, counting the views that any model answers.";
        choose(m, *goodEnoughPct);
      }
  const std::string toleranceMet = s.model;
  const Candidate winner = s.candidates[best];
  const double least = ranked(best);
  const double slack = std::max(kNegligiblePct, std::isfinite(winner.standardErrorPct) ? winner.standardErrorPct : 0);
  const std::string slackText = slack > kNegligiblePct ? "one standard error (" + percentText(slack) + ")"
                                                       : "what contours resolve (" + percentText(kNegligiblePct) + ")";
  for (std::size_t m = 0; m < s.candidates.size(); ++m) {
    Candidate& c = s.candidates[m];
    if (!eligible[m] || c.model == toleranceMet) continue;
    if (ranked(m) > least + slack) {
      const std::string worse = "worse than the best by " + percentText(ranked(m) - least);
      c.remark = c.remark.empty() ? worse : worse + "; " + c.remark;
    } else if (s.model.empty()) {
      s.why = static_cast<int>(m) == best
                  ? c.model + " has the smallest leave-one-view-out error, " + errorText(m) +
                        ", and no simpler model is within " + slackText + " of it."
                  : "The simplest model within " + slackText + " of the best: " + c.model + " has " + errorText(m) +
                        " leaving one view out, the best is " + winner.model + " with " + errorText(best) + ".";
      choose(m, least + slack);
    } else {
      c.remark = static_cast<int>(m) == best ? "best, but a simpler one is as good" : "a simpler one is as good";
    }
  }
  if (nothingBetter) s.why += " Richer models were not tried: none could be better by what contours resolve.";
  if (goodEnoughPct && toleranceMet.empty())
    s.why += " No model reached the stated tolerance of " + percentText(*goodEnoughPct) + ".";
  return s;
}

InspectionRequest chosenRequest(InspectionRequest request, const Selection& selection) {
  request.models.clear();
  if (!selection.model.empty()) request.models.push_back(selection.model);
  if (selection.patches)
    request.settings.set("predict.query", std::string(selection.patches->goodEnough ? "local-quadric" : "exact"));
  return request;
}

std::string selectionTable(const Selection& s) {
  std::string out = "candidate     views   leave-one-out %   std. error %  us/frame  seconds  remark\n";
  char line[256];
  for (const Candidate& c : s.candidates) {
    const std::string views = std::to_string(c.answered) + "/" + std::to_string(c.tried);
    std::snprintf(line, sizeof line, "%-12s %6s %17.4g %14.4g %9.3g %8.2f  ", c.model.c_str(), views.c_str(), c.meanPct,
                  c.standardErrorPct, c.predictUs, c.timeUs * 1e-6);
    out += line + c.remark + "\n";
  }
  if (s.leftOut < s.trainingViews)
    out += std::to_string(s.leftOut) + " of " + std::to_string(s.trainingViews) +
           " training views were left out one at a time, evenly spread.\n";
  return out + s.why + "\n" + (s.patches ? s.patches->why + "\n" : "");
}

}  // namespace glint

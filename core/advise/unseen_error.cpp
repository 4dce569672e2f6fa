// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/unseen_error.h"

#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/choice/leave_one_out.h"
#include "core/pipeline/summary.h"

namespace glint {
namespace {

constexpr double kWorthwhile = 0.9;  // of the error before: a change that gains less is not worth a click

const UnseenError::View* same(const UnseenError::View& view, const UnseenError& in) {
  const auto it = std::find_if(in.views.begin(), in.views.end(),
                               [&](const UnseenError::View& v) { return v.frame == view.frame && v.light == view.light; });
  return it == in.views.end() ? nullptr : &*it;
}

UnseenError leftOutError(const Inspection& inspection, const HighlightModel& model, const ProgressFn& progress) {
  std::vector<Fold> folds = foldsOf(inspection, LeaveOut::Place);
  std::vector<Answer> answers;
  RankingSoFar known;
  known.possible.assign(folds.size(), 1);
  tryModel(inspection, model, folds, answers, known, PoorFits::Take, progress);
  UnseenError error;
  error.leftOut = true;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    const Answer& a = answers[i];
    UnseenError::View view{.frame = folds[i].left.frame, .light = folds[i].left.highlight.light};
    if (const UnseenError::View* const other = same(view, error))
      view = *other, std::erase(error.views, view);  // its frame shows several highlights
    ++(a.errorPct ? view.matched : view.missed);
    view.contourPct += a.errorPct.value_or(0);
    view.wrongPct += std::min(kMissedPct, a.errorPct.value_or(kMissedPct));
    error.views.push_back(std::move(view));
  }
  return error;
}

}  // namespace

int UnseenError::sum(int View::*count) const {
  int all = 0;
  for (const View& v : views) all += v.*count;
  return all;
}

double UnseenError::pct() const {
  double sum = 0;
  for (const View& v : views) sum += v.wrongPct;
  return observed() > 0 ? sum / double(observed()) : std::nan("");
}

double UnseenError::contourPct() const {
  double sum = 0;
  for (const View& v : views) sum += v.contourPct;
  return matched() > 0 ? sum / double(matched()) : std::nan("");
}

UnseenError unseenError(const Inspection& inspection, const std::string& model, const ProgressFn& progress) {
  UnseenError error;
  const ModelResult& result = inspection.models.at(model);
  for (const FrameComparison& c : result.frames) {
    if (!inspection.isHeldOut(c.frame)) continue;
    const ComparisonTally t = tallyOf(c);
    if (t.matched + t.missed + t.spurious == 0) continue;
    UnseenError::View view{c.frame, c.light, t.matched, t.missed, t.spurious, 0, t.wrongPct()};
    for (const ComparisonTally::Measured& m : t.measured) view.contourPct += m.contourErrorPct;
    error.views.push_back(std::move(view));
  }
  return error.observed() > 0 ? error : leftOutError(inspection, modelByName(model), progress);
}

bool isAstray(const UnseenError::View& view) {
  return view.missed > 0 || view.contourPct > kLargestExpectedPct * double(view.matched);
}

UnseenError commonViews(const UnseenError& of, const UnseenError& with) {
  UnseenError common = of;
  std::erase_if(common.views, [&](const UnseenError::View& v) { return !same(v, with); });
  return common;
}

bool isBetter(const UnseenError& after, const UnseenError& before) {
  const UnseenError a = commonViews(after, before), b = commonViews(before, after);
  if (a.matched() == 0 || after.leftOut != before.leftOut || after.pct() > before.pct()) return false;
  if (2 * a.observed() < before.observed()) return false;
  if (10 * a.spurious() <= 9 * b.spurious() && b.spurious() > 0 && a.missed() <= b.missed() && a.contourPct() <= b.contourPct())
    return true;
  if (!(b.pct() - a.pct() > kNegligiblePct && a.pct() < kWorthwhile * b.pct())) return false;
  std::vector<double> gains;
  bool fewerAstray = false, othersAstray = false;
  double sum = 0, squares = 0;
  for (const UnseenError::View& v : a.views) {
    const UnseenError::View& earlier = *same(v, b);
    gains.push_back(earlier.wrongPct - v.wrongPct);
    sum += gains.back();
    fewerAstray = fewerAstray || (!isAstray(v) && isAstray(earlier));
    othersAstray = othersAstray || (isAstray(v) && !isAstray(earlier));
  }
  const double n = double(gains.size()), mean = sum / n;
  if (n < 2) return true;
  for (const double g : gains) squares += (g - mean) * (g - mean);
  // One wrong view makes that error as large as the gain: then it counts that fewer go astray, and no other one.
  return mean > std::sqrt(squares / (n - 1) / n) || (fewerAstray && !othersAstray);
}

std::string textOf(const UnseenError& error) {
  const int observed = error.observed(), spurious = error.spurious();
  std::string text = error.matched() > 0 ? formatted("%.3g %%", error.contourPct()) : "no observed highlight predicted";
  if (error.matched() > 0 && error.missed() > 0) text += formatted(", %d of %d highlights missed", error.missed(), observed);
  return spurious > 0 ? text + formatted(", %d spurious", spurious) : text;
}

}  // namespace glint

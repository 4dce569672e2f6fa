// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/row_changes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/base/number_text.h"
#include "core/pipeline/frame_score.h"
#include "core/pipeline/metrics.h"

namespace glint {
namespace {

constexpr double kSame = 1e-9;  // relative: as `glint replay`, nine digits

using Place = std::pair<int, std::string>;  // frame, light

std::map<Place, std::set<int>> observedIn(const std::vector<HighlightRow>& rows) {
  std::map<Place, std::set<int>> all;
  for (const HighlightRow& r : rows)
    if (r.observed >= 0) all[{r.frame, r.light}].insert(r.observed);
  return all;
}

const Highlight& highlightAt(const Inspection& inspection, int frame, int index) {
  return inspection.evidence[std::size_t(frame)].scored()[std::size_t(index)];
}

/// Which observed highlight of `before` each of `after` is, for one light in one frame.
std::map<int, int> pairsAt(const Inspection& before, const std::set<int>& inBefore, const Inspection& after,
                           const std::set<int>& inAfter, int frame) {
  std::map<int, int> pairs;
  std::vector<int> a(inBefore.begin(), inBefore.end()), b;
  for (const int j : inAfter) {
    const auto same = std::find_if(
        a.begin(), a.end(), [&](int i) { return highlightAt(before, frame, i).peak == highlightAt(after, frame, j).peak; });
    if (same == a.end()) {
      b.push_back(j);
    } else {
      pairs[j] = *same;
      a.erase(same);
    }
  }
  if (a.size() == 1 && b.size() == 1) pairs[b[0]] = a[0];
  if (a.empty() || b.empty() || (a.size() == 1 && b.size() == 1)) return pairs;
  const auto contours = [frame](const Inspection& of, const std::vector<int>& which) {
    std::vector<Polyline> lines;
    for (const int i : which) lines.push_back(highlightAt(of, frame, i).contour);
    return lines;
  };
  for (const auto& [i, j] : matchByOverlap(contours(before, a), contours(after, b))) pairs[b[std::size_t(j)]] = a[std::size_t(i)];
  return pairs;
}

bool hasError(const HighlightRow& row) { return std::isfinite(row.value(RowValue::ErrorPct)); }

/// The counts of one side alone.
void countAlone(const std::vector<HighlightRow>& rows, const std::string& model, int& without, int& spurious) {
  for (const HighlightRow& r : rows) {
    if (r.model != model || r.role != RowRole::HeldOut) continue;
    without += r.observed >= 0 && !hasError(r);
    spurious += r.status == RowStatus::Spurious;
  }
}

std::string plural(int count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

}  // namespace

bool sameError(double a, double b) { return a == b || std::abs(a - b) <= kSame * std::max(std::abs(a), std::abs(b)); }

std::vector<int> counterparts(const Inspection& before, const std::vector<HighlightRow>& rowsBefore, const Inspection& after,
                              const std::vector<HighlightRow>& rowsAfter) {
  std::map<std::tuple<int, std::string, std::string, int>, int> known;  // frame, light, model, observed (-1: nothing was)
  for (std::size_t i = 0; i < rowsBefore.size(); ++i) {
    const HighlightRow& r = rowsBefore[i];
    if (r.status != RowStatus::Spurious) known.emplace(std::tuple(r.frame, r.light, r.model, r.observed), int(i));
  }
  const std::map<Place, std::set<int>> a = observedIn(rowsBefore), b = observedIn(rowsAfter);
  std::map<Place, std::map<int, int>> pairs;
  for (const auto& [place, inAfter] : b)
    if (const auto inBefore = a.find(place); inBefore != a.end())
      pairs[place] = pairsAt(before, inBefore->second, after, inAfter, place.first);
  std::vector<int> found(rowsAfter.size(), -1);
  for (std::size_t i = 0; i < rowsAfter.size(); ++i) {
    const HighlightRow& r = rowsAfter[i];
    if (r.status == RowStatus::Spurious) continue;
    int observed = -1;
    if (r.observed >= 0) {
      const std::map<int, int>& here = pairs[{r.frame, r.light}];
      const auto pair = here.find(r.observed);
      if (pair == here.end()) continue;
      observed = pair->second;
    }
    if (const auto at = known.find({r.frame, r.light, r.model, observed}); at != known.end()) found[i] = at->second;
  }
  return found;
}

std::vector<ErrorChange> errorChanges(const Inspection& before, const std::vector<HighlightRow>& rowsBefore,
                                      const Inspection& after, const std::vector<HighlightRow>& rowsAfter) {
  const std::vector<int> pairs = counterparts(before, rowsBefore, after, rowsAfter);
  std::vector<ErrorChange> changes;
  for (const std::string& model : modelsInOrder(after)) {
    if (!before.models.count(model)) continue;
    ErrorChange c;
    c.model = model;
    std::set<int> frames;
    for (std::size_t i = 0; i < rowsAfter.size(); ++i) {
      const HighlightRow& now = rowsAfter[i];
      if (now.model != model || now.observed < 0 || pairs[i] < 0) continue;
      const HighlightRow& then = rowsBefore[std::size_t(pairs[i])];
      const bool both = now.role == RowRole::HeldOut && then.role == RowRole::HeldOut;
      if (both) c.lost += hasError(then) && !hasError(now), c.gained += hasError(now) && !hasError(then);
      if (!hasError(now) || !hasError(then)) continue;
      if (!both) {
        ++c.elsewhere;
        continue;
      }
      const double a = then.value(RowValue::ErrorPct), b = now.value(RowValue::ErrorPct);
      ++c.highlights;
      frames.insert(now.frame);
      c.meanBefore += a;
      c.meanAfter += b;
      if (!sameError(a, b)) ++(b < a ? c.better : c.worse);
    }
    c.frames = static_cast<int>(frames.size());
    c.meanBefore = c.highlights ? c.meanBefore / c.highlights : std::nan("");
    c.meanAfter = c.highlights ? c.meanAfter / c.highlights : std::nan("");
    countAlone(rowsBefore, model, c.withoutBefore, c.spuriousBefore);
    countAlone(rowsAfter, model, c.withoutAfter, c.spuriousAfter);
    changes.push_back(c);
  }
  return changes;
}

std::string textOf(const ErrorChange& c) {
  std::string text = c.highlights == 0 ? "no held-out highlight has an error in both"
                                       : formatted("held-out mean %.3g %% \u2192 %.3g %% (", c.meanBefore, c.meanAfter) +
                                             plural(c.highlights, "highlight in ", "highlights in ") +
                                             plural(c.frames, "frame", "frames") + ": ";
  if (c.highlights > 0) {
    if (c.better + c.worse == 0)
      text += "all the same)";
    else
      text += std::to_string(c.better) + " better, " + std::to_string(c.worse) + " worse" +
              (c.better + c.worse < c.highlights ? ", " + std::to_string(c.highlights - c.better - c.worse) + " the same)" : ")");
  }
  if (c.lost)
    text += "; " + plural(c.lost, "highlight", "highlights") + " lost the prediction and " + (c.lost == 1 ? "is" : "are") +
            " in no mean";
  if (c.gained)
    text += "; " + plural(c.gained, "highlight", "highlights") + " gained a prediction and " + (c.gained == 1 ? "is" : "are") +
            " in no mean";
  if (c.withoutBefore || c.withoutAfter)
    text += "; without prediction " + std::to_string(c.withoutBefore) + " \u2192 " + std::to_string(c.withoutAfter);
  if (c.spuriousBefore || c.spuriousAfter)
    text += "; spurious " + std::to_string(c.spuriousBefore) + " \u2192 " + std::to_string(c.spuriousAfter);
  return text;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <boost/math/distributions/hypergeometric.hpp>
#include <cmath>
#include <functional>
#include <optional>
#include <set>

#include "core/advise/highlight_evidence.h"
#include "core/base/number_text.h"
#include "core/base/words.h"
#include "core/choice/selection.h"

namespace glint {
namespace {

constexpr int kLeastWrong = 3;       // of fewer "most" says nothing
constexpr double kMostWrong = 0.75;  // least share of the wrong ones: "most of them"
constexpr double kFewOthers = 0.1;   // most of the others: "hardly any"
constexpr double kMostChance =
    0.001;  // about 20 splits are tried, each at its best value: see the test of rows that share nothing

/// A thing that a highlight has or has not; empty = not known of this one.
using Known = std::function<std::optional<bool>(const HighlightRow&)>;

struct Split {
  std::vector<const HighlightRow*> wrong, right;
};

double chanceOf(const SharedCause& c) {
  // As few as there can be.
  if (c.wrong <= std::max(0, c.wrong + c.others - c.ofOthers)) return 1;
  const boost::math::hypergeometric_distribution<double> draws(unsigned(c.wrong + c.others), unsigned(c.ofWrong),
                                                               unsigned(c.ofWrong + c.ofOthers));
  return cdf(complement(draws, unsigned(c.wrong - 1)));
}

SharedCause counted(const Split& all, const Known& has) {
  SharedCause c;
  for (const HighlightRow* row : all.wrong)
    if (const std::optional<bool> known = has(*row)) {
      ++c.ofWrong;
      c.wrong += *known;
      if (*known) c.highlights.push_back(keyOf(*row));
    }
  for (const HighlightRow* row : all.right)
    if (const std::optional<bool> known = has(*row)) ++c.ofOthers, c.others += *known;
  return c;
}

bool isStrong(const SharedCause& c) {
  return c.ofWrong >= kLeastWrong && c.ofOthers > 0 && c.wrong >= kMostWrong * c.ofWrong && c.others <= kFewOthers * c.ofOthers &&
         c.chance <= kMostChance;
}

/// The number with the fewest digits in [a, b): what is above it is at least b.
double roundBetween(double a, double b) {
  const double middle = 0.5 * (a + b);
  for (int power = int(std::ceil(std::log10(std::max(std::abs(a), std::abs(b))))); power > -12; --power)
    for (const double unit : {5.0, 1.0}) {
      const double step = unit * std::pow(10.0, power), value = std::round(middle / step) * step;
      if (value >= a && value < b) return value;
    }
  return middle;
}

class Causes {
 public:
  Causes(const Inspection& inspection, const Split& all) : in_(inspection), all_(all) {}

  void tryThing(const std::string& singular, const std::string& plural, const Known& has) {
    SharedCause c = counted(all_, has);
    c.chance = chanceOf(c);
    take(std::move(c), singular, plural);
  }
  /// @param above, below  what follows "have": "an incident angle above %s°"
  void tryNumber(RowValue which, const char* above, const char* below, const std::function<std::string(double)>& text);
  std::vector<SharedCause> finish() {
    std::stable_sort(found_.begin(), found_.end(),
                     [](const SharedCause& a, const SharedCause& b) { return a.chance < b.chance; });
    return std::move(found_);
  }
  const Highlight* observed(const HighlightRow& row) const {
    if (row.observed < 0) return nullptr;
    return &in_.evidence[std::size_t(row.frame)].scored()[std::size_t(row.observed)];
  }

 private:
  void take(SharedCause c, const std::string& singular, const std::string& plural) {
    if (!isStrong(c)) return;
    c.text = std::to_string(c.wrong) + " of " + std::to_string(c.ofWrong) + " " + (c.wrong == 1 ? singular : plural) + "; " +
             std::to_string(c.others) + " of " + std::to_string(c.ofOthers) + " others";
    if (const int unknown = int(all_.wrong.size()) - c.ofWrong; unknown > 0)
      c.text += " (unknown for " + std::to_string(unknown) + " more)";
    found_.push_back(std::move(c));
  }
  const Inspection& in_;
  const Split& all_;
  std::vector<SharedCause> found_;
};

void Causes::tryNumber(RowValue which, const char* above, const char* below, const std::function<std::string(double)>& text) {
  std::vector<std::pair<double, bool>> values;  // and whether it is wrong
  for (const auto* rows : {&all_.wrong, &all_.right})
    for (const HighlightRow* row : *rows)
      if (std::isfinite(row->value(which))) values.emplace_back(row->value(which), rows == &all_.wrong);
  std::sort(values.begin(), values.end());
  SharedCause best;
  best.ofWrong = int(std::count_if(values.begin(), values.end(), [](const auto& v) { return v.second; }));
  best.ofOthers = int(values.size()) - best.ofWrong;
  std::string words;
  double threshold = 0;
  bool isAbove = false;
  int wrongBelow = 0, othersBelow = 0;
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    ++(values[i].second ? wrongBelow : othersBelow);
    if (values[i].first == values[i + 1].first) continue;
    for (const bool up : {true, false}) {
      SharedCause c = best;
      c.wrong = up ? c.ofWrong - wrongBelow : wrongBelow;
      c.others = up ? c.ofOthers - othersBelow : othersBelow;
      c.chance = 0;
      if (!isStrong(c)) continue;  // the chance takes longest
      if (c.chance = chanceOf(c); c.chance >= best.chance) continue;
      best = c;
      isAbove = up;
      threshold = roundBetween(values[i].first, values[i + 1].first);
      words = formatted(up ? above : below, text(threshold).c_str());
    }
  }
  if (words.empty()) return;
  SharedCause c = counted(all_, [&](const HighlightRow& row) -> std::optional<bool> {
    if (!std::isfinite(row.value(which))) return std::nullopt;
    return (row.value(which) > threshold) == isAbove;
  });
  c.chance = best.chance;
  const bool lies = words.rfind("lie ", 0) == 0;
  take(std::move(c), lies ? "lies" + words.substr(3) : "has " + words, lies ? words : "have " + words);
}

}  // namespace

std::vector<SharedCause> sharedCauses(const Inspection& inspection, const std::vector<HighlightRow>& rows,
                                      const std::string& model) {
  Split all;
  std::set<std::string> lights, surfaces;
  const auto surfaceOf = [&](const HighlightRow& r) -> const std::string& {
    return inspection.scene->frames[std::size_t(r.frame)].surface;
  };
  for (const HighlightRow& r : rows) {
    if (r.model != model || r.role == RowRole::Excluded || r.status == RowStatus::NotCompared) continue;
    const bool right =
        r.status == RowStatus::Ok || (r.status == RowStatus::Poor && r.value(RowValue::ErrorPct) <= kLargestExpectedPct);
    (right ? all.right : all.wrong).push_back(&r);
    lights.insert(r.light);
    surfaces.insert(surfaceOf(r));
  }
  if (int(all.wrong.size()) < kLeastWrong || all.right.empty()) return {};
  Causes causes(inspection, all);
  const auto digits = [](double v) { return formatted("%.6g", v); };
  causes.tryNumber(RowValue::IncidentDeg, "an incident angle above %s\u00b0", "an incident angle up to %s\u00b0", digits);
  causes.tryNumber(RowValue::ObservedPx, "an observed diameter above %s px", "an observed diameter up to %s px", digits);
  causes.tryNumber(RowValue::PeakRadiance, "a peak radiance above %s", "a peak radiance up to %s", digits);
  causes.tryNumber(RowValue::ObservedLimitDeg, "an observed limit angle above %s\u00b0", "an observed limit angle up to %s\u00b0",
                   digits);
  const auto frame = [&](double position) { return inspection.scene->frames[std::size_t(std::floor(position))].id; };
  causes.tryNumber(RowValue::Frame, "lie in frames after %s", "lie in frames up to %s", frame);
  for (const std::string& light : lights)
    causes.tryThing("is of " + lightName(light), "are of " + lightName(light),
                    [&](const HighlightRow& r) { return r.light == light; });
  for (const std::string& surface : surfaces)
    causes.tryThing("lies on surface " + surface, "lie on surface " + surface,
                    [&](const HighlightRow& r) { return surfaceOf(r) == surface; });
  const auto ofSeen = [&](bool Highlight::*flag) {
    return [&causes, flag](const HighlightRow& r) -> std::optional<bool> {
      const Highlight* const seen = causes.observed(r);
      return seen ? std::optional(seen->*flag) : std::nullopt;
    };
  };
  causes.tryThing("is cut by the image's border", "are cut by the image's border", ofSeen(&Highlight::touchesBorder));
  causes.tryThing("has a clipped core", "have a clipped core", ofSeen(&Highlight::clipped));
  return causes.finish();
}

}  // namespace glint

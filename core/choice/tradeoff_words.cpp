// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <map>

#include "core/base/number_text.h"
#include "core/base/words.h"
#include "core/choice/tradeoff.h"

namespace glint {
namespace {

constexpr std::array<const char*, 3> kPresets = {"fast", "balanced", "exact"};

/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return text;
}

std::vector<std::string> presetsAt(const Tradeoff& t, int point) {
  std::vector<std::string> names;
  for (const char* name : kPresets)
    if (const auto it = t.presets.find(name); it != t.presets.end() && it->second == point) names.emplace_back(name);
  return names;
}

}  // namespace

const char* const kTradeoffErrors =
    "Error: symmetric mean distance between predicted and observed contour, in percent of the equivalent diameter of the "
    "observed region, mean "
    "over held-out highlights, where each one that was missed or is spurious, and each direction left out, counts as 100 %. "
    "Error of those found: "
    "the mean over the highlights that were found, as glint evaluate gives it.";

std::string trainedOn(const Tradeoff& t) {
  const bool rule = t.trainSpec.find(':') != std::string::npos;
  if (t.trainIds.empty() || t.trainSpec == "per-surface") return t.trainSpec;
  return (rule ? t.trainSpec + ", " : "") + shortList(t.trainIds);
}

std::string foundText(const TradeoffPoint& p) {
  return std::to_string(p.matched) + " of " + std::to_string(static_cast<long long>(p.matched) + p.missed);
}

std::string presetNames(const Tradeoff& t, int point) { return listed(presetsAt(t, point)); }

std::string presetNote(const Tradeoff& t) {
  for (const auto& [name, point] : t.presets) {
    const std::vector<std::string> names = presetsAt(t, point);
    if (names.size() < 2) continue;
    const bool withFast = names.front() == "fast", withExact = names.back() == "exact";
    return "The presets " + listed(names) + " are the same setting: no " +
           (withFast && withExact ? "usable one is faster or more accurate."
            : withFast            ? "slower one is a better compromise."
                                  : "faster one is a better compromise.");
  }
  return "";
}

std::string tradeoffTable(const Tradeoff& t) {
  std::string out =
      "front  us/frame    error %    found   error of found %      IoU  coverage  spurious     fit ms  peak MB  setting\n";
  for (int i = 0; i < static_cast<int>(t.points.size()); ++i) {
    const TradeoffPoint& p = t.points[i];
    const std::string names = presetNames(t, i);
    const std::string marks = (names.empty() ? "" : "  <- " + names) + (t.chosen == i ? "  <- chosen" : "");
    const std::string found = std::to_string(p.matched) + "/" + std::to_string(static_cast<long long>(p.matched) + p.missed);
    out +=
        formatted("%-5s %9.1f %10.3g %8s %18.3g %8.4f %9.3f %9d %10.2f %8.1f  ", p.pareto ? "*" : "", p.predictUs,
                  p.rankedErrorPct, found.c_str(), p.contourErrorPct, p.iou, p.coverage, p.spurious, p.fitUs * 1e-3, p.peakMb) +
        describe(t, p) + (p.poor.empty() ? "" : "  poor: " + p.poor) + marks + "\n";
  }
  std::map<std::string, int> kinds;
  for (const PrunedPoint& p : t.pruned) ++kinds[p.kind];
  out +=
      "error %: missed and spurious highlights and directions left out count as 100 %; error of found %: as evaluate gives "
      "it\n\n" +
      std::to_string(t.points.size()) + " settings measured in full, " + std::to_string(t.trials) + " tried on a few frames, " +
      std::to_string(t.pruned.size()) + " dropped";
  std::string list;
  for (const auto& [kind, count] : kinds) list += (list.empty() ? ": " : ", ") + std::to_string(count) + " " + kind;
  const std::string note = presetNote(t);
  return out + list + ".\n" + t.measurement + "\n" + t.reason + "\n" + (note.empty() ? "" : note + "\n");
}

}  // namespace glint

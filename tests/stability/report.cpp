// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

#include "core/base/json_dom.h"
#include "core/base/number_text.h"
#include "tests/stability/stability.h"

namespace glint {
namespace {

std::string shortNumber(double x) {
  if (x == std::numeric_limits<double>::max()) return "none";
  return formatted("%.3g", x);
}
std::string exponent(double x) { return formatted("%.1e", x); }
/// A failure has no error to show.
std::string errorText(const StabilityResult& r) {
  return r.verdict == CaseVerdict::NamedFailure ? "-" : exponent(r.relativeError);
}
std::string conditionText(const StabilityResult& r) {
  return r.verdict == CaseVerdict::NamedFailure ? "none" : shortNumber(r.condition);
}

std::string totals(const std::vector<StabilityResult>& results) {
  int counts[3] = {0, 0, 0};
  for (const StabilityResult& r : results) ++counts[int(r.verdict)];
  return std::to_string(results.size()) + " cases: " + std::to_string(counts[0]) + " accurate, " + std::to_string(counts[1]) +
         " named failures, " + std::to_string(counts[2]) + " wrong";
}

}  // namespace

const char* nameOf(CaseVerdict verdict) {
  switch (verdict) {
    case CaseVerdict::Accurate: return "accurate";
    case CaseVerdict::NamedFailure: return "named failure";
    case CaseVerdict::Wrong: break;
  }
  return "wrong";
}

std::string stabilityTable(const std::vector<StabilityResult>& results) {
  std::size_t stage = 5, name = 4;
  for (const StabilityResult& r : results) {
    stage = std::max(stage, r.stage.size());
    name = std::max(name, r.name.size());
  }
  std::string out;
  const auto row = [&](const std::string& a, const std::string& b, const std::string& condition, const std::string& error,
                       const std::string& tolerance, const std::string& verdict) {
    out += formatted("%-*s  %-*s  %10s  %9s  %9s  ", int(stage), a.c_str(), int(name), b.c_str(), condition.c_str(),
                     error.c_str(), tolerance.c_str()) +
           verdict + "\n";
  };
  row("stage", "case", "condition", "error", "tolerance", "verdict");
  for (const StabilityResult& r : results)
    row(r.stage, r.name, conditionText(r), errorText(r), exponent(r.tolerance),
        nameOf(r.verdict) + (r.reason.empty() ? std::string() : ": " + r.reason));
  return out + totals(results) + "\n";
}

std::string stabilityMarkdown(const std::vector<StabilityResult>& results) {
  std::string out = "| stage | case | condition | relative error | tolerance | verdict | why |\n|---|---|---|---|---|---|---|\n";
  for (const StabilityResult& r : results)
    out += "| " + r.stage + " | " + r.name + " | " + conditionText(r) + " | " + errorText(r) + " | " + exponent(r.tolerance) +
           " | " + nameOf(r.verdict) + (r.reason.empty() ? "" : ": " + r.reason) + " | " + r.note + " |\n";
  return out + "\n" + totals(results) + "\n";
}

std::string stabilityJson(const std::vector<StabilityResult>& results) {
  nlohmann::ordered_json cases = nlohmann::ordered_json::array();
  for (const StabilityResult& r : results)
    cases.push_back({{"case", r.name},
                     {"stage", r.stage},
                     {"parameter", r.parameter},
                     {"condition", r.condition},
                     {"relative_error", r.relativeError},
                     {"tolerance", r.tolerance},
                     {"verdict", nameOf(r.verdict)},
                     {"reason", r.reason}});
  return json_dom::pretty({{"glint_stability", 1}, {"cases", cases}}) + "\n";
}

}  // namespace glint

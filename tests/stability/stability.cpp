// SPDX-License-Identifier: BSD-3-Clause
#include "tests/stability/stability.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <set>

#include "tests/stability/cases.h"
#include "tests/stability/reflectance_cases.h"

namespace glint {
namespace {

using stability::Case;
using stability::Expect;
using stability::Measured;

constexpr double kLargest = std::numeric_limits<double>::max();  // JSON has no infinity
double finite(double x) { return std::isfinite(x) ? x : kLargest; }

StabilityResult judge(const Case& c, const Outcome<Measured>& outcome) {
  StabilityResult r;
  r.name = c.name;
  r.stage = c.stage;
  r.parameter = c.parameter;
  r.tolerance = c.tolerance;
  r.note = c.note;
  if (!outcome) {
    r.condition = kLargest;
    r.relativeError = 1;
    r.reason = outcome.failure().message();
    const bool allowed = std::find(c.reasons.begin(), c.reasons.end(), outcome.failure().reason) != c.reasons.end();
    r.verdict = c.expect != Expect::Answer && allowed ? CaseVerdict::NamedFailure : CaseVerdict::Wrong;
    return r;
  }
  r.condition = finite(outcome->condition);
  r.relativeError = finite(outcome->error);
  if (c.expect == Expect::Failure) {
    r.reason = "an answer although no unique one exists";
  } else if (outcome->error <= c.tolerance) {  // false for NaN
    r.verdict = CaseVerdict::Accurate;
  } else {
    r.reason = std::isfinite(outcome->error) ? "beyond the tolerance" : "not a number";
  }
  return r;
}

}  // namespace

std::vector<StabilityResult> runStability(const ProgressFn& progress, const std::string& stage) {
  stability::Cases cases;
  stability::addConicCases(cases);
  stability::addCameraCases(cases);
  stability::addAngleCases(cases);
  stability::addSurfaceCases(cases);
  stability::addMeshCases(cases);
  stability::addMeshFileCases(cases);
  stability::addBrightestCases(cases);
  stability::addLightCases(cases);
  stability::addWalkCases(cases);
  stability::addReconstructionCases(cases);
  stability::addPredictionCases(cases);
  stability::addReflectanceCases(cases);
  stability::addLobeCases(cases);
  stability::addBadNumberCases(cases);
  if (!stage.empty()) {
    std::set<std::string> stages;
    for (const Case& c : cases) stages.insert(c.stage);
    std::string all;
    for (const std::string& s : stages) all += (all.empty() ? "" : ", ") + s;
    if (!stages.count(stage)) throw InputError("", "--stage", "must be one of " + all);
    std::erase_if(cases, [&](const Case& c) { return c.stage != stage; });
  }
  std::vector<StabilityResult> results;
  for (const Case& c : cases) {
    if (!report(progress, {"stability", int(results.size()), int(cases.size())})) throw Stopped{};
    try {
      results.push_back(judge(c, c.run()));
    } catch (const std::exception& e) {  // no input of a case may end the program
      StabilityResult r = judge(c, Failure{Reason::NotSupported, e.what()});
      r.verdict = CaseVerdict::Wrong;
      r.reason = std::string("exception: ") + e.what();
      results.push_back(r);
    }
  }
  return results;
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/advise/diagnosis.h"
#include "core/base/json_dom.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/base/version.h"
#include "core/base/words.h"
#include "core/report/report.h"
#include "core/report/texts.h"
#include "core/scene/frame_name.h"

namespace glint {
namespace {

using json_dom::numberOrNull;
using Ordered = nlohmann::ordered_json;

Ordered textOrNull(const std::optional<std::string>& text) { return text ? Ordered(*text) : Ordered(); }

Ordered evidenceJson(const Inspection& inspection, const HighlightEvidence& e) {
  return {{"index", e.frame},
          {"id", inspection.scene->frames[std::size_t(e.frame)].id},
          {"light", e.light},
          {"highlight", e.highlight},
          {"peak", {numberOrNull(e.peak.x()), numberOrNull(e.peak.y())}},
          {"radius_px", numberOrNull(e.radiusPx)},
          {"residual_px", e.residualPx ? numberOrNull(*e.residualPx) : Ordered()},
          {"limit_angle_deg", e.limitAngle ? numberOrNull(degrees(*e.limitAngle)) : Ordered()},
          {"against", e.against}};
}

Ordered errorJson(const UnseenError& error) {
  return {{"error_pct", numberOrNull(error.pct())},
          {"contour_error_pct", numberOrNull(error.contourPct())},
          {"observed", error.observed()},
          {"missed", error.missed()},
          {"spurious", error.spurious()}};
}

Ordered remedyJson(const Remedy& r) {
  return {{"model", textOrNull(r.change.model)},
          {"train", textOrNull(r.change.train)},
          {"set", textOrNull(r.change.set)},
          {"exclude", textOrNull(r.change.exclude)},
          {"also_set", r.change.alsoSet},
          {"flags", flagsOf(r.change)},
          {"words", wordsOf(r.change)},
          {"why", r.why},
          {"effect",
           {{"before_pct", numberOrNull(r.before.pct())},
            {"after_pct", numberOrNull(r.after.pct())},
            {"before", errorJson(r.before)},
            {"after", errorJson(r.after)}}}};
}

Ordered placeJson(const std::optional<Eigen::Vector4d>& place) {
  return place ? Ordered({(*place)(0), (*place)(1), (*place)(2), (*place)(3)}) : Ordered();
}

Ordered fitJson(const FitTrace& fit) {
  Ordered runs = Ordered::array();
  for (const SolverRun& run : fit.runs) {
    Ordered rounds = Ordered::array();
    for (const std::vector<double>& round : run.rounds) {
      Ordered costs = Ordered::array();
      for (const double cost : round) costs.push_back(numberOrNull(cost));
      rounds.push_back(std::move(costs));
    }
    runs.push_back({{"what", run.what},
                    {"start", placeJson(run.start)},
                    {"end", placeJson(run.end)},
                    {"costs", std::move(rounds)},
                    {"unit", run.unit},
                    {"converged", run.converged},
                    {"ending", run.ending},
                    {"taken", run.answer}});
  }
  return {{"light", fit.key.light},
          {"surface", textOrNull(fit.key.surface)},
          {"failure", fit.failure ? Ordered(fit.failure->message()) : Ordered()},
          {"runs", std::move(runs)}};
}

Ordered modelJson(const Inspection& inspection, const ModelDiagnosis& d) {
  Ordered evidence = Ordered::array(), fits = Ordered::array();
  for (const FitTrace& fit : d.fits) fits.push_back(fitJson(fit));
  for (const HighlightEvidence& e : d.evidence) evidence.push_back(evidenceJson(inspection, e));
  return {{"status", d.status}, {"error", errorJson(d.error)},     {"cause", d.causes.empty() ? "" : d.causes.front()},
          {"causes", d.causes}, {"evidence", std::move(evidence)}, {"fits", std::move(fits)}};
}

std::string placeText(const Diagnosis& d) { return d.now.leftOut ? "left-out training frames" : "held-out frames"; }

/// The highlight that contradicts a model most; "" = none does clearly.
std::string worstHighlight(const Inspection& inspection, const ModelDiagnosis& d) {
  const auto worst = std::max_element(d.evidence.begin(), d.evidence.end(), [](auto& a, auto& b) { return a.weight < b.weight; });
  if (worst == d.evidence.end() || worst->weight < 1 || worst->against.empty()) return "";
  return "frame " + inspection.scene->frames[std::size_t(worst->frame)].id + ", " + lightName(worst->light) + ": " +
         worst->against.front();
}

/// The best remedy as a command to paste.
std::string commandText(const Inspection& inspection, const Diagnosis& d) {
  if (d.remedies.empty() || inspection.scene->file.empty()) return "";
  InspectionRequest request = inspection.request;
  request.models = {d.present};
  const Outcome<std::string> command = commandOf(*inspection.scene, with(request, d.remedies.front().change, *inspection.scene));
  return command ? "  as a command: " + *command + "\n" : "";
}

}  // namespace

std::string diagnosisJson(const Inspection& inspection, const Diagnosis& d, const std::string& input) {
  Ordered models = Ordered::object(), remedies = Ordered::array();
  for (const ModelDiagnosis& m : d.models) models[m.model] = modelJson(inspection, m);
  for (const Remedy& r : d.remedies) remedies.push_back(remedyJson(r));
  Ordered measured = Ordered::array();
  for (const Measured& m : d.measured) measured.push_back({{"flags", flagsOf(m.change)}, {"error", errorJson(m.error)}});
  Ordered j = {{"glint_diagnosis", 2},
               {"program", "glint " GLINT_VERSION},
               {"input", input},
               {"train", inspection.train.frames},
               {"train_ids", frameIds(*inspection.scene, inspection.train.frames)},
               {"excluded", inspection.request.excluded},
               {"excluded_ids", frameIds(*inspection.scene, inspection.request.excluded)},
               {"verdict", d.verdict},
               {"present", {{"model", d.present}, {"error", errorJson(d.now)}}},
               {"best_model", d.best.empty() ? Ordered() : Ordered(d.best)},
               {"measured_in", placeText(d)},
               {"remedies", std::move(remedies)},
               {"measured", std::move(measured)},
               {"notes", d.notes},
               {"tried", d.tried},
               {"known", d.known},
               {"models", std::move(models)}};
  return json_dom::pretty(j);
}

std::vector<std::string> adviceOf(const Diagnosis& d) {
  std::vector<std::string> advice{d.verdict};
  for (const Remedy& r : d.remedies) advice.push_back(flagsOf(r.change) + ": " + effectText(r) + " (" + r.why + ").");
  advice.insert(advice.end(), d.notes.begin(), d.notes.end());
  return advice;
}

std::string diagnosisText(const Inspection& inspection, const Diagnosis& d) {
  std::string text = d.verdict + "\n";
  for (const Remedy& r : d.remedies)
    text += formatted("  %-36s %s\n      (%s)\n", flagsOf(r.change).c_str(), effectText(r).c_str(), r.why.c_str());
  text += commandText(inspection, d) + "Evidence, measured in " + placeText(d) + ":\n";
  for (const std::string& note : d.notes) text += "  " + note + "\n";
  for (const Measured& m : d.measured)
    if (!m.change.train && !m.change.set && !m.change.exclude && m.change.alsoSet.empty())
      text += formatted("  %-12s %s\n", m.change.model->c_str(), textOf(m.error).c_str());
  text += formatted("  %d of %d known changes were tried%s.\n", d.tried, d.known,
                    d.tried < d.known ? "; --thorough or --most N tries more" : "");
  for (const ModelDiagnosis& m : d.models) {
    if (!m.causes.empty())
      text += "  " + m.model + " is " + (m.status == "ok" ? "off" : m.status) + " because " + m.causes.front() + "\n";
    if (const std::string worst = worstHighlight(inspection, m); !worst.empty())
      text += "  against " + m.model + ": " + worst + "\n";
  }
  return text;
}

}  // namespace glint

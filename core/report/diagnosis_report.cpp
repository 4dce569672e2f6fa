// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/diagnosis_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/angle.h"
#include "core/base/json_dom.h"
#include "core/base/json_text.h"
#include "core/base/light_name.h"
#include "core/base/number_text.h"
#include "core/base/version.h"
#include "core/report/command_text.h"
#include "core/scene/frame_name.h"
#include "core/selection/selection.h"

namespace glint {
namespace {

using json_dom::numberOrNull;
using Ordered = nlohmann::ordered_json;

constexpr std::size_t kMostLines = 6;  // highlights and remedies that the text lists; --json has all

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

/// What the training views, or the held-out frames alone say; null where there are none.
Ordered partJson(const Remedy& r, bool training) {
  const LeftOutError before = ofTraining(r.before, training), after = ofTraining(r.after, training);
  if (before.views.empty() || after.views.empty()) return {};
  return {{"before_pct", numberOrNull(before.meanPct())}, {"after_pct", numberOrNull(after.meanPct())}};
}

Ordered errorJson(const LeftOutError& error) {
  if (error.views.empty()) return {};
  return {{"error_pct", numberOrNull(error.meanPct())}, {"views", error.views.size()}, {"answered", error.answered()}};
}

Ordered remedyJson(const Remedy& r) {
  return {{"model", textOrNull(r.change.model)},
          {"train", textOrNull(r.change.train)},
          {"set", textOrNull(r.change.set)},
          {"exclude", textOrNull(r.change.exclude)},
          {"flags", flagsOf(r.change)},
          {"why", r.why},
          {"measured", r.measured},
          {"effect",
           {{"before_pct", numberOrNull(r.before.meanPct())},
            {"after_pct", numberOrNull(r.after.meanPct())},
            {"views", r.after.views.size()},
            {"answered_before", r.before.answered()},
            {"answered_after", r.after.answered()},
            {"training", partJson(r, true)},
            {"held_out", partJson(r, false)}}}};
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
  Ordered evidence = Ordered::array(), fits = Ordered::array(), remedies = Ordered::array();
  for (const FitTrace& fit : d.fits) fits.push_back(fitJson(fit));
  for (const HighlightEvidence& e : d.evidence) evidence.push_back(evidenceJson(inspection, e));
  for (const Remedy& r : d.remedies) remedies.push_back(remedyJson(r));
  return {{"status", nameOf(d.status)},
          {"cause", d.causes.empty() ? "" : d.causes.front()},
          {"causes", d.causes},
          {"notes", d.notes},
          {"left_out", errorJson(ofTraining(d.unseen, true))},
          {"held_out", errorJson(ofTraining(d.unseen, false))},
          {"evidence", std::move(evidence)},
          {"fits", std::move(fits)},
          {"remedies", std::move(remedies)},
          {"tried", d.tried},
          {"known", d.known}};
}

std::string errorText(const LeftOutError& error) {
  if (error.views.empty()) return "no view";
  if (error.answered() == 0) return "no prediction";
  std::string text = formatted("%.3g %%", error.meanPct());
  if (error.answered() < static_cast<int>(error.views.size()))
    text += formatted(" (%d of %zu views)", error.answered(), error.views.size());
  return text;
}

void addEvidence(const Inspection& inspection, const ModelDiagnosis& d, std::string& text) {
  std::vector<const HighlightEvidence*> against;
  for (const HighlightEvidence& e : d.evidence)
    if (!e.against.empty()) against.push_back(&e);
  if (against.empty()) return;
  std::stable_sort(against.begin(), against.end(), [](auto* a, auto* b) { return a->weight > b->weight; });
  text += "  highlights that stand against it:\n";
  for (std::size_t i = 0; i < against.size() && i < kMostLines; ++i) {
    const HighlightEvidence& e = *against[i];
    text += "    frame " + inspection.scene->frames[std::size_t(e.frame)].id + ", " + lightName(e.light) + ": ";
    for (const std::string& a : e.against) text += (&a == &e.against.front() ? "" : "; ") + a;
    text += "\n";
  }
  if (against.size() > kMostLines) text += formatted("    and %zu more\n", against.size() - kMostLines);
}

void addRemedies(const ModelDiagnosis& d, std::string& text) {
  if (d.remedies.empty()) {
    text += formatted("  nothing helps: %d changes were tried\n", d.tried);
    return;
  }
  text += "  try (error of views that the fit did not see, before -> after):\n";
  for (std::size_t i = 0; i < d.remedies.size() && i < kMostLines; ++i)
    text += formatted("    %-36s %s\n      (%s)\n", flagsOf(d.remedies[i].change).c_str(), effectText(d.remedies[i]).c_str(),
                      d.remedies[i].why.c_str());
  if (d.remedies.size() > kMostLines) text += formatted("    and %zu more\n", d.remedies.size() - kMostLines);
  if (d.tried < d.known)
    text += formatted("    %d of %d known changes were tried; --thorough or --most N tries more\n", d.tried, d.known);
}

/// The best remedy as a command to paste.
void addCommand(const Inspection& inspection, const ModelDiagnosis& d, std::string& text) {
  if (d.remedies.empty() || inspection.scene->file.empty()) return;
  InspectionRequest request = inspection.request;
  request.models = {d.model};
  if (const Outcome<std::string> command =
          commandOf(*inspection.scene, with(request, d.remedies.front().change, *inspection.scene)))
    text += "  as a command: " + *command + "\n";
}

}  // namespace

std::string effectText(const Remedy& remedy) {
  // Between words and a number an arrow would not be read as "before and after".
  const bool fromNothing = remedy.before.answered() == 0;
  return errorText(remedy.before) + (fromNothing ? " before, " : " -> ") + errorText(remedy.after) +
         (fromNothing ? " after" : "") + (remedy.measured ? "" : ", by leaving frames out of the score");
}

std::string diagnosisJson(const Inspection& inspection, const Diagnosis& diagnosis, const std::string& input) {
  Ordered models = Ordered::object();
  for (const ModelDiagnosis& d : diagnosis.models) models[d.model] = modelJson(inspection, d);
  Ordered j = {{"glint_diagnosis", 1},
               {"program", "glint " GLINT_VERSION},
               {"input", input},
               {"train", inspection.train.frames},
               {"train_ids", frameIds(*inspection.scene, inspection.train.frames)},
               {"excluded", inspection.request.excluded},
               {"excluded_ids", frameIds(*inspection.scene, inspection.request.excluded)},
               {"models", std::move(models)}};
  return prettyJson(j.dump(-1, ' ', false, Ordered::error_handler_t::replace));
}

std::string diagnosisText(const Inspection& inspection, const Diagnosis& diagnosis) {
  std::string text;
  for (const ModelDiagnosis& d : diagnosis.models) {
    text += formatted("%-12s %-7s left-out training views: %s; held-out frames: %s\n", d.model.c_str(), nameOf(d.status),
                      errorText(ofTraining(d.unseen, true)).c_str(), errorText(ofTraining(d.unseen, false)).c_str());
    for (const std::string& note : d.notes) text += "  note: " + note + "\n";
    if (d.status == ModelDiagnosis::Status::Ok) continue;
    for (const std::string& cause : d.causes) text += "  because " + cause + "\n";
    addEvidence(inspection, d, text);
    for (const FitTrace& fit : d.fits)
      for (const std::string& line : textOf(fit)) text += "  fit of " + lightName(textOf(fit.key)) + ": " + line + "\n";
    addRemedies(d, text);
    addCommand(inspection, d, text);
  }
  return text;
}

}  // namespace glint

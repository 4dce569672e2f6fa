// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/advise/highlight_evidence.h"
#include "core/advise/unseen_error.h"
#include "core/base/solver_trace.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/training.h"

namespace glint {

/// How a model was fitted to the highlights of one light: every run of a solver on the way, in order.
struct FitTrace {
  FitKey key;
  std::vector<SolverRun> runs;     ///< none if the model is fitted in closed form, or has no view
  std::optional<Failure> failure;  ///< of the fit
};

/// Fits the model again, light by light, and records it: first the light if the model needs one, and a lobe's fit to pixels.
/// Stopped, within a fit of a lobe to pixels or contours too.
std::vector<FitTrace> traceFits(const Inspection& inspection, const HighlightModel& model, const ProgressFn& progress = {});

/// "light with one limit angle: 3 runs, 41 steps; the one that was taken: cost 812 -> 0.31 px^2 in 12 steps, moved 0.42 m". One
/// line per kind of run; distances are of the light, or the centre of the ellipsoid.
std::vector<std::string> textOf(const FitTrace& trace);

/// What a user could change, as the flags of `glint evaluate` take it: another model, another value, or both.
struct Change {
  std::optional<std::string> model = {};    ///< use this one instead
  std::optional<std::string> train = {};    ///< SPEC
  std::optional<std::string> set = {};      ///< "light.solver=triangulated"
  std::optional<std::string> exclude = {};  ///< SPEC of all frames to exclude, those that are excluded already among them
  std::vector<std::string> alsoSet = {};    ///< further values, each as `set`
  friend bool operator==(const Change&, const Change&) = default;
};
/// "--model limit-angle", "--set light.solver=triangulated".
std::string flagsOf(const Change& change);
/// "use limit-angle", "set light.solver = triangulated".
std::string wordsOf(const Change& change);
/// The request with the change. InputError if the scene does not know a frame.
InspectionRequest with(InspectionRequest request, const Change& change, const Scene& scene);

/// One state that was computed: a model as it is (the model alone is set), or with one change.
struct Measured {
  Change change;    ///< with its model
  std::string why;  ///< why it was tried, one clause
  UnseenError error;
};

/// A change that beats the present state, and by how much: measured, not guessed.
struct Remedy {
  Change change;  ///< of the present state: the model only where it is another one
  std::string why;
  UnseenError before, after;  ///< over the views that both have
};
/// "2.3 %, 147 spurious -> 0.74 %, 24 spurious"
std::string effectText(const Remedy& remedy);

/// Why one model of the inspection is as it is.
struct ModelDiagnosis {
  std::string model;
  std::string status;  ///< of its fits, as every table says it: "ok", "poor", "failed"
  UnseenError error;   ///< as it is now
  /// In words, weightiest first; none if it is ok, misses nothing and is off by at most kLargestExpectedPct.
  std::vector<std::string> causes;
  std::vector<HighlightEvidence> evidence;
  std::vector<FitTrace> fits;  ///< how they went; none if the status is ok
};

/// What to do about a sequence: one verdict, at most three remedies, and the evidence for both.
struct Diagnosis {
  std::string present;                 ///< the model whose state is to be beaten
  UnseenError now;                     ///< of that state
  std::string best;                    ///< the model with the smallest error, settings as they are; "" = none answers
  std::string verdict;                 ///< one sentence
  std::vector<Remedy> remedies;        ///< best first, of different kinds
  std::vector<std::string> notes;      ///< reasons for the verdict, one sentence each
  std::vector<ModelDiagnosis> models;  ///< those of the request, in its order; filled last
  std::vector<Measured> measured;      ///< models as they are first
  bool complete = false;               ///< everything was tried that was to be
  int tried = 0, known = 0;            ///< changes that were run for this, and that could have been
};
/// Makes the advice for another present model from what was measured: at once. A remedy beats the present state, and with more
/// than another model also every model as it is, beyond chance (isBetter).
/// @param present  "" or one that was not measured = as before, at first the best one
void adviseFor(Diagnosis& diagnosis, const std::string& present);
inline constexpr std::size_t kMostRemedies = 3;

struct DiagnoseOptions {
  std::string present;  ///< the model on screen; "" or one that was not computed = the best of those that were
  /// Settings, training frames and exclusions that are measured on the best model, and a third of that on each other one whose
  /// error is at most five times as large: the bound of the work.
  int mostTried = 6;
  bool askAuto = true;  ///< whether the automatic choice is made, too, and compared: a note; takes longest
  /// Called with the diagnosis as far as it is: at once with what the computed models tell, then whenever something was measured.
  std::function<void(const Diagnosis&)> soFar;
};

/// Compares the computed models, then measures others and what helps the best of them, each by a run of its own with everything
/// that the user would see (inspect()). A remedy that was chosen by what held-out frames show makes them less independent:
/// `evaluate` on other frames judges it. Progress counts the trials. Stopped.
/// @param inspection  complete
Diagnosis diagnose(const Inspection& inspection, const DiagnoseOptions& options = {}, const ProgressFn& progress = {});

}  // namespace glint

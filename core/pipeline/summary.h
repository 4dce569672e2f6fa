// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/pipeline/inspection.h"
#include "core/pipeline/metrics.h"

namespace glint {

/// The error, in % of a highlight's diameter, that counts without a contour error: for an observed highlight that is not
/// predicted, and at most for one that is; for one that is predicted where none is observed. That is little, because a filter may
/// take it out, while nothing repairs a contour: it decides between equal contours.
inline constexpr double kMissedPct = 100, kSpuriousPct = 0.1;

/// What `evaluate` prints of one model (docs/formats.md, "evaluate --json"): held-out frames only, except per surface.
struct ModelSummary {
  bool answered = false;                      ///< some frame was predicted
  bool poor = false;                          ///< and a fit explains its training views badly
  std::string reason;                         ///< why not, when it was not; why it is poor, when it is
  int frames = 0;                             ///< (frame, light) pairs that should be predicted
  int predicted = 0;                          ///< of those, pairs with a prediction
  int matched = 0, missed = 0, spurious = 0;  ///< highlights
  int filtered = 0;                           ///< predicted highlights that predict.filter_... took out: none of the above
  Statistic contourErrorPct, contourErrorPx, ellipseErrorPct, hausdorffPx, peakOffsetPx, coverage;  ///< over matched highlights
  Statistic iou;  ///< per (frame, light), over the union of all regions
  Statistic timeUs;
  double timeP99Us = 0;
  /// The one number by which models and settings are compared: ComparisonTally::wrongPct() over all comparisons, per observed
  /// highlight. The mean contour error where nothing is missed or spurious. NaN where nothing was observed.
  double wrongPct = 0;

  const char* status() const { return !answered ? "failed" : poor ? "poor" : "ok"; }
};
ModelSummary summarise(const Inspection& inspection, const ModelResult& result);

/// What one comparison adds to a summary: plain numbers, which another process may have measured.
struct ComparisonTally {
  int frame = -1;
  bool predicted = false, observed = false;
  bool unreadable = false;  ///< a row says why nothing could be compared
  int matched = 0, missed = 0, spurious = 0, filtered = 0;
  double iou = 0, timeUs = 0;
  std::string failure;  ///< of the prediction; "" = none
  struct Measured {
    double contourErrorPct = 0, contourErrorPx = 0, ellipseErrorPct = 0, hausdorffPx = 0, peakOffsetPx = 0, coverage = 0;
  };
  std::vector<Measured> measured;  ///< of each highlight with metrics
  /// Sum over highlights: contour errors of at most kMissedPct, kMissedPct per other observed one, kSpuriousPct per spurious one.
  double wrongPct() const;
  std::vector<BandScore> bands;  ///< of each matched highlight with a band
};
ComparisonTally tallyOf(const FrameComparison& comparison);

/// Frames that count, whatever the model.
struct HeldOutFrames {
  int all = 0, unreadable = 0;
};
/// Held-out frames as the evidence of this inspection shows them; what was not looked at counts nothing.
HeldOutFrames heldOutFrames(const Inspection& inspection);

/// What is wrong with the fits of a model: the first failure and the first reason why one is poor; "" = none.
struct FitReasons {
  std::string failure, poor;
  void add(const std::string& status, const std::string& reason);  ///< of one more fit, as fitStatus() and fitReason() give them
};
FitReasons reasonsOf(const ModelResult& result);
const char* fitStatus(const ModelResult::Fit& fit);  ///< "ok", "poor", "failed"
std::string fitReason(const ModelResult::Fit& fit);  ///< "" if it is ok
/// Why the fit behind a comparison is poor; "" if it is ok, has failed, or does not exist.
std::string poorFit(const ModelResult& result, const FrameComparison& comparison);
/// The model was fitted, and failed for this light on every surface: it says nothing there.
bool failedFor(const Inspection& inspection, const std::string& model, const std::string& light);

/// The same summary from tallies of all comparisons of held-out frames, in the order of the inspection.
ModelSummary summaryOf(const std::vector<ComparisonTally>& tallies, const FitReasons& fits, const HeldOutFrames& heldOut);

/// Tallies of a model's comparisons in held-out frames.
std::vector<ComparisonTally> talliesOf(const Inspection& inspection, const ModelResult& result);

}  // namespace glint

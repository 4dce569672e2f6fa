// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/summary.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

/// Why no frame was predicted.
std::string reasonOf(const std::vector<ComparisonTally>& tallies, const std::string& fitFailure, const HeldOutFrames& heldOut,
                     int frames) {
  if (!fitFailure.empty()) return fitFailure;
  for (const ComparisonTally& t : tallies)
    if (!t.failure.empty()) return t.failure;
  return heldOut.all == 0                    ? "no frame is held out"
         : heldOut.unreadable == heldOut.all ? "no held-out frame can be read"
         : frames == 0                       ? "no held-out frame has a highlight"
                                             : "no frame was predicted";
}

}  // namespace

ComparisonTally tallyOf(const FrameComparison& c) {
  ComparisonTally t;
  t.frame = c.frame;
  t.predicted = !c.prediction.highlights().empty();
  t.iou = c.iou;
  t.timeUs = c.prediction.timeUs;
  t.filtered = static_cast<int>(c.prediction.filtered.size());
  if (c.prediction.failure()) t.failure = c.prediction.failure()->message();
  for (const FrameComparison::Row& row : c.rows) {
    if (row.observed >= 0) t.observed = true;
    if (row.failure && row.observed < 0 && row.predicted < 0) t.unreadable = true;
    if (row.observed >= 0 && row.predicted >= 0)
      ++t.matched;
    else if (row.observed >= 0)
      ++t.missed;
    else if (row.predicted >= 0)
      ++t.spurious;
    if (row.band) t.bands.push_back(*row.band);
    if (!row.metrics) continue;
    const ContourMetrics& m = *row.metrics;
    t.measured.push_back({m.contourErrorPct, m.contourErrorPx, m.ellipseErrorPct, m.hausdorffPx, m.peakOffsetPx,
                          c.prediction.highlights()[row.predicted].coverage});
  }
  return t;
}

double ComparisonTally::wrongPct() const {
  double sum = kMissedPct * double(matched + missed) + kSpuriousPct * double(spurious);
  for (const Measured& m : measured) sum -= std::max(0.0, kMissedPct - m.contourErrorPct);
  return sum;
}

std::vector<ComparisonTally> talliesOf(const Inspection& inspection, const ModelResult& result) {
  std::vector<ComparisonTally> tallies;
  for (const FrameComparison& c : result.frames)
    if (inspection.isHeldOut(c.frame)) tallies.push_back(tallyOf(c));
  return tallies;
}

const char* fitStatus(const ModelResult::Fit& fit) { return fit.fit ? fit.fit->status() : "failed"; }
std::string fitReason(const ModelResult::Fit& fit) { return fit.fit ? fit.fit->poor : fit.failure()->message(); }

std::string poorFit(const ModelResult& result, const FrameComparison& comparison) {
  const int i = comparison.fit;
  if (i < 0 || i >= static_cast<int>(result.fits.size())) return "";
  const ModelResult::Fit& fit = result.fits[static_cast<std::size_t>(i)];
  return fit.fit ? fit.fit->poor : "";
}

void FitReasons::add(const std::string& status, const std::string& reason) {
  if (status == "failed" && failure.empty()) failure = reason;
  if (status == "poor" && poor.empty()) poor = reason;
}

FitReasons reasonsOf(const ModelResult& result) {
  FitReasons reasons;
  for (const ModelResult::Fit& f : result.fits) reasons.add(fitStatus(f), fitReason(f));
  return reasons;
}

HeldOutFrames heldOutFrames(const Inspection& inspection) {
  HeldOutFrames frames;
  for (std::size_t i = 0; i < inspection.evidence.size(); ++i) {
    if (inspection.evidence[i].frame < 0 || !inspection.isHeldOut(static_cast<int>(i))) continue;
    ++frames.all;
    const std::optional<Failure>& failure = inspection.evidence[i].scoringFailure();
    if (failure && failure->reason == Reason::FrameUnreadable) ++frames.unreadable;
  }
  return frames;
}

bool failedFor(const Inspection& inspection, const std::string& model, const std::string& light) {
  const auto result = inspection.models.find(model);
  if (result == inspection.models.end()) return false;
  bool any = false;
  for (const ModelResult::Fit& fit : result->second.fits) {
    if (fit.light != light) continue;
    if (!fit.failure()) return false;
    any = true;
  }
  return any;
}

ModelSummary summaryOf(const std::vector<ComparisonTally>& tallies, const FitReasons& fits, const HeldOutFrames& heldOut) {
  ModelSummary s;
  std::vector<double> pct, px, ellipse, hausdorff, peak, coverage, iou, time;
  for (const ComparisonTally& t : tallies) {
    s.matched += t.matched;
    s.missed += t.missed;
    s.spurious += t.spurious;
    s.filtered += t.filtered;
    s.wrongPct += t.wrongPct();
    for (const ComparisonTally::Measured& m : t.measured) {
      pct.push_back(m.contourErrorPct);
      px.push_back(m.contourErrorPx);
      ellipse.push_back(m.ellipseErrorPct);
      hausdorff.push_back(m.hausdorffPx);
      peak.push_back(m.peakOffsetPx);
      coverage.push_back(m.coverage);
    }
    if (!t.observed && !t.unreadable) continue;  // nothing was there to predict; what was predicted is spurious
    ++s.frames;
    if (t.predicted && t.observed) ++s.predicted;
    if (t.observed) iou.push_back(t.iou);
    time.push_back(t.timeUs);
  }
  s.answered = s.predicted > 0;
  s.wrongPct = s.matched + s.missed > 0 ? s.wrongPct / double(s.matched + s.missed) : std::nan("");
  s.contourErrorPct = statisticOf(pct);
  s.contourErrorPx = statisticOf(px);
  s.ellipseErrorPct = statisticOf(ellipse);
  s.hausdorffPx = statisticOf(hausdorff);
  s.peakOffsetPx = statisticOf(peak);
  s.coverage = statisticOf(coverage);
  s.iou = statisticOf(iou);
  s.timeUs = statisticOf(time);
  std::sort(time.begin(), time.end());
  s.timeP99Us = quantileOf(time, 0.99);
  s.poor = s.answered && !fits.poor.empty();
  s.reason = s.answered ? fits.poor : reasonOf(tallies, fits.failure, heldOut, s.frames);
  return s;
}

ModelSummary summarise(const Inspection& inspection, const ModelResult& result) {
  return summaryOf(talliesOf(inspection, result), reasonsOf(result), heldOutFrames(inspection));
}

}  // namespace glint

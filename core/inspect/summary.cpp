// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/summary.h"

#include <algorithm>

namespace glint {

ModelSummary summarise(const Inspection& inspection, const ModelResult& result) {
  ModelSummary s;
  std::vector<double> pct, px, ellipse, hausdorff, peak, coverage, iou, time;
  for (const FrameComparison& c : result.frames) {
    if (!inspection.isHeldOut(c.frame)) continue;
    const bool predicted = !c.prediction.highlights().empty();
    bool observed = false, unreadable = false;
    for (const FrameComparison::Row& row : c.rows) {
      if (row.observed >= 0) observed = true;
      if (row.failure && row.observed < 0 && row.predicted < 0) unreadable = true;
      if (row.observed >= 0 && row.predicted >= 0)
        ++s.matched;
      else if (row.observed >= 0)
        ++s.missed;
      else if (row.predicted >= 0)
        ++s.spurious;
      if (!row.metrics) continue;
      pct.push_back(row.metrics->contourErrorPct);
      px.push_back(row.metrics->contourErrorPx);
      ellipse.push_back(row.metrics->ellipseErrorPct);
      hausdorff.push_back(row.metrics->hausdorffPx);
      peak.push_back(row.metrics->peakOffsetPx);
      coverage.push_back(c.prediction.highlights()[row.predicted].coverage);
    }
    if (!observed && !unreadable) continue;  // nothing was there to predict; what was predicted is spurious
    ++s.frames;
    if (predicted && observed) ++s.predicted;
    if (observed) iou.push_back(c.iou);
    time.push_back(c.prediction.timeUs);
  }
  s.answered = s.predicted > 0;
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
  if (!s.answered) {
    for (const ModelResult::Fit& f : result.fits)
      if (f.failure()) {
        s.reason = f.failure()->message();
        return s;
      }
    for (const FrameComparison& c : result.frames)
      if (inspection.isHeldOut(c.frame) && c.prediction.failure()) {
        s.reason = c.prediction.failure()->message();
        return s;
      }
    int heldOut = 0, unreadable = 0;
    for (std::size_t i = 0; i < inspection.evidence.size(); ++i) {
      if (!inspection.isHeldOut(static_cast<int>(i))) continue;
      ++heldOut;
      const std::optional<Failure>& failure = inspection.evidence[i].scoringFailure();
      if (failure && failure->reason == Reason::FrameUnreadable) ++unreadable;
    }
    s.reason = heldOut == 0            ? "no frame is held out"
               : unreadable == heldOut ? "no held-out frame can be read"
               : s.frames == 0         ? "no held-out frame has a highlight"
                                       : "no frame was predicted";
  }
  return s;
}

}  // namespace glint

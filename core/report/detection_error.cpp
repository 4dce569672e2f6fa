// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/detection_error.h"

#include "core/score/metrics.h"

namespace glint {

std::optional<DetectionError> detectionError(const Inspection& inspection) {
  DetectionError error;
  std::vector<double> percent, pixels;
  for (const FrameEvidence& e : inspection.evidence) {
    if (e.frame < 0 || !e.againstTruth || e.truthFailure || e.truth.empty()) continue;
    std::vector<Polyline> truth, found;
    for (const Highlight& h : e.truth) truth.push_back(h.contour);
    for (const Highlight& h : e.highlights) found.push_back(h.contour);
    const std::vector<std::pair<int, int>> pairs = matchByOverlap(truth, found);
    ++error.frames;
    error.missed += static_cast<int>(truth.size() - pairs.size());
    for (const auto& [t, f] : pairs) {
      const Highlight& own = e.highlights[static_cast<std::size_t>(f)];
      const ContourMetrics m = compareContours(truth[static_cast<std::size_t>(t)], own.contour, {}, own.ellipse,
                                               e.truth[static_cast<std::size_t>(t)].peak, own.peak);
      percent.push_back(m.contourErrorPct);
      pixels.push_back(m.contourErrorPx);
    }
  }
  if (percent.empty()) return std::nullopt;
  error.contourErrorPct = statisticOf(percent);
  error.contourErrorPx = statisticOf(pixels);
  return error;
}

}  // namespace glint

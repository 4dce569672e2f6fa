// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/detection_error.h"

#include <iterator>

#include "core/score/metrics.h"

namespace glint {

std::optional<FrameDetection> detectionOf(const FrameEvidence& e) {
  if (e.frame < 0 || !e.againstTruth || e.truthFailure || e.truth.empty()) return std::nullopt;
  FrameDetection frame;
  std::vector<Polyline> truth, found;
  for (const Highlight& h : e.truth) truth.push_back(h.contour);
  for (const Highlight& h : e.highlights) found.push_back(h.contour);
  const std::vector<std::pair<int, int>> pairs = matchByOverlap(truth, found);
  frame.missed = static_cast<int>(truth.size() - pairs.size());
  for (const auto& [t, f] : pairs) {
    const Highlight& own = e.highlights[static_cast<std::size_t>(f)];
    const ContourMetrics m = compareContours(truth[static_cast<std::size_t>(t)], own.contour, {}, own.ellipse,
                                             e.truth[static_cast<std::size_t>(t)].peak, own.peak);
    frame.percent.push_back(m.contourErrorPct);
    frame.pixels.push_back(m.contourErrorPx);
  }
  return frame;
}

std::optional<DetectionError> detectionError(const std::vector<FrameDetection>& frames) {
  DetectionError error;
  std::vector<double> percent, pixels;
  for (const FrameDetection& frame : frames) {
    ++error.frames;
    error.missed += frame.missed;
    percent.insert(percent.end(), frame.percent.begin(), frame.percent.end());
    pixels.insert(pixels.end(), frame.pixels.begin(), frame.pixels.end());
  }
  if (error.frames == 0 || percent.empty()) return std::nullopt;
  error.contourErrorPct = statisticOf(percent);
  error.contourErrorPx = statisticOf(pixels);
  return error;
}

std::optional<DetectionError> detectionError(const Inspection& inspection) {
  std::vector<FrameDetection> frames;
  for (const FrameEvidence& e : inspection.evidence)
    if (std::optional<FrameDetection> frame = detectionOf(e)) frames.push_back(*std::move(frame));
  return detectionError(frames);
}

}  // namespace glint

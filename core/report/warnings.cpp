// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/warnings.h"

#include <algorithm>

namespace glint {
namespace {

/// Clipping takes the peak away to which the contour's level refers.
void warnOfClipped(const Inspection& inspection, std::vector<std::string>& warnings) {
  std::vector<int> training, others;
  bool known = true;  // a lobe says what was cut off
  for (const FrameEvidence& e : inspection.evidence) {
    const auto clipped = [](const Highlight& h) { return h.clipped; };
    if (e.frame < 0 || std::none_of(e.highlights.begin(), e.highlights.end(), clipped)) continue;
    if (std::find(inspection.request.excluded.begin(), inspection.request.excluded.end(), e.frame) !=
        inspection.request.excluded.end())
      continue;
    for (const Highlight& h : e.highlights) known = known && (!h.clipped || h.trueLevel);
    (inspection.isTraining(e.frame) ? training : others).push_back(e.frame);
  }
  if (training.empty() && others.empty()) return;
  std::string text = "clipped (saturated) highlights in ";
  if (!training.empty()) text += "training frames " + frameList(training);
  if (!others.empty()) text += (training.empty() ? "frames " : " and other frames ") + frameList(others);
  warnings.push_back(text +
                     (known ? ": the peak, and so the level of the contour, comes from the lobe fitted around the clipped pixels"
                            : ": the peak is unknown, so a contour lies at a smaller fraction of it than the stated level"));
}

}  // namespace

std::string frameList(const std::vector<int>& frames) {
  constexpr std::size_t kNamed = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(kNamed, frames.size()); ++i) text += (i ? ", " : "") + std::to_string(frames[i]);
  if (frames.size() > kNamed) text += " and " + std::to_string(frames.size() - kNamed) + " more";
  return text;
}

std::vector<std::string> warningsOf(const Inspection& inspection) {
  std::vector<std::string> warnings;
  warnOfClipped(inspection, warnings);
  for (const std::string& name : inspection.request.models) {
    const auto model = inspection.models.find(name);
    if (model == inspection.models.end()) continue;
    for (const ModelResult::Fit& fit : model->second.fits)
      if (fit.fit)
        for (const std::string& remark : fit.fit->remarks)
          warnings.push_back(name + ", light " + fit.light + (fit.surface ? ", surface " + *fit.surface : "") + ": " + remark);
  }
  return warnings;
}

std::string scoredAgainst(const Inspection& inspection) {
  if (!inspection.request.truthFolder.empty()) return "truth";
  bool any = false;
  for (const FrameEvidence& e : inspection.evidence) {
    if (e.frame < 0 || !inspection.isHeldOut(e.frame)) continue;
    for (const Highlight& h : e.scored()) {
      if (!h.fromScene) return "own detection";
      any = true;
    }
  }
  return any ? "given contours" : "own detection";
}

}  // namespace glint

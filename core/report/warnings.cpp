// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/warnings.h"

#include <algorithm>
#include <map>

#include "core/base/light_name.h"
#include "core/scene/frame_name.h"

namespace glint {
namespace {

/// Frames that the inspection looked at and that train or are scored.
bool counts(const Inspection& inspection, const FrameEvidence& e) {
  return e.frame >= 0 && (inspection.isTraining(e.frame) || inspection.isHeldOut(e.frame));
}

/// The warning about clipped highlights with their frames; "" without any. Clipping takes the peak away to which the contour's
/// level refers.
std::string clippedWarning(const Inspection& inspection) {
  std::vector<std::string> training, others;
  bool known = true;  // a lobe says what was cut off
  for (const FrameEvidence& e : inspection.evidence) {
    const auto clipped = [](const Highlight& h) { return h.clipped; };
    if (!counts(inspection, e) || std::none_of(e.highlights.begin(), e.highlights.end(), clipped)) continue;
    for (const Highlight& h : e.highlights) known = known && (!h.clipped || h.trueLevel);
    (inspection.isTraining(e.frame) ? training : others).push_back(frameName(*inspection.scene, e.frame));
  }
  if (training.empty() && others.empty()) return "";
  std::string text = "clipped (saturated) highlights in ";
  if (!training.empty()) text += "training " + framesText(training);
  if (!others.empty()) text += (training.empty() ? "" : " and other ") + framesText(others);
  return text + (known ? ": the peak, and so the level of the contour, comes from the lobe fitted around the clipped pixels"
                       : ": the peak is unknown, so a contour lies at a smaller fraction of it than the stated level");
}

/// The warning about frames whose colours do not tell what is specular (detect.background = colours), with reasons; or "".
std::string notSeparatedWarning(const Inspection& inspection) {
  std::map<std::string, std::vector<std::string>> frames;
  for (const FrameEvidence& e : inspection.evidence)
    if (counts(inspection, e) && !e.notSeparated.empty()) frames[e.notSeparated].push_back(frameName(*inspection.scene, e.frame));
  std::string text;
  for (const auto& [reason, which] : frames) text += (text.empty() ? "" : "; ") + framesText(which) + " (" + reason + ")";
  return text.empty() ? "" : "colours do not tell what is specular, and the smooth background is used, in " + text;
}

}  // namespace

std::string fitWarning(const std::string& model, const std::string& light, const std::optional<std::string>& surface,
                       const std::string& remark) {
  return model + ", " + lightName(light) + (surface ? ", surface " + *surface : "") + ": " + remark;
}

std::string poorWarning(const std::string& reason) { return "poor: " + reason; }

std::vector<std::string> warningsOf(const Inspection& inspection) {
  std::vector<std::string> warnings;
  for (std::string warning : {clippedWarning(inspection), notSeparatedWarning(inspection)})
    if (!warning.empty()) warnings.push_back(std::move(warning));
  for (const std::string& name : inspection.request.models) {
    const auto model = inspection.models.find(name);
    if (model == inspection.models.end()) continue;
    for (const ModelResult::Fit& fit : model->second.fits) {
      if (!fit.fit) continue;
      if (!fit.fit->poor.empty()) warnings.push_back(fitWarning(name, fit.light, fit.surface, poorWarning(fit.fit->poor)));
      for (const std::string& remark : fit.fit->remarks) warnings.push_back(fitWarning(name, fit.light, fit.surface, remark));
    }
  }
  return warnings;
}

std::string scoredAgainst(const Inspection& inspection) {
  if (!inspection.request.truthFolder.empty()) return "truth";
  bool given = false, detected = false;
  for (const FrameEvidence& e : inspection.evidence)
    if (e.frame >= 0 && inspection.isHeldOut(e.frame))
      for (const Highlight& h : e.scored()) (h.fromScene ? given : detected) = true;
  return given && !detected ? "given contours" : "own detection";
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/evaluation_notes.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/scene/frame_name.h"

namespace glint {

FrameNote noteOf(const Inspection& inspection, int frame) {
  const FrameEvidence& e = inspection.evidence[static_cast<std::size_t>(frame)];
  FrameNote note;
  note.frame = frame;
  note.id = frameName(*inspection.scene, frame);
  note.training = inspection.isTraining(frame);
  note.heldOut = inspection.isHeldOut(frame);
  for (const Highlight& h : e.highlights) {
    note.clipped = note.clipped || h.clipped;
    note.levelKnown = note.levelKnown && (!h.clipped || h.trueLevel);
  }
  for (const Highlight& h : e.scored()) (h.fromScene ? note.given : note.detected) = true;
  note.unreadable = e.scoringFailure() && e.scoringFailure()->reason == Reason::FrameUnreadable;
  note.notParted = e.notParted;
  return note;
}

std::vector<FrameNote> notesOf(const Inspection& inspection) {
  std::vector<FrameNote> notes;
  for (const FrameEvidence& e : inspection.evidence)
    if (e.frame >= 0) notes.push_back(noteOf(inspection, e.frame));
  return notes;
}

/// Clipping takes the peak away to which the contour's level refers.
std::string clippedWarning(const std::vector<FrameNote>& notes) {
  std::vector<std::string> training, others;
  bool known = true;  // a lobe says what was cut off
  for (const FrameNote& n : notes) {
    if (!n.clipped || !(n.training || n.heldOut)) continue;
    known = known && n.levelKnown;
    (n.training ? training : others).push_back(n.id);
  }
  if (training.empty() && others.empty()) return "";
  std::string text = "clipped (saturated) highlights in ";
  if (!training.empty()) text += "training " + framesText(training);
  if (!others.empty()) text += (training.empty() ? "" : " and other ") + framesText(others);
  return text + (known ? ": the peak, and so the level of the contour, comes from the lobe fitted around the clipped pixels"
                       : ": the peak is unknown, so a contour lies at a smaller fraction of it than the stated level");
}

std::string notPartedWarning(const std::vector<FrameNote>& notes) {
  std::map<std::string, std::vector<std::string>> frames;
  for (const FrameNote& n : notes)
    if (!n.notParted.empty() && (n.training || n.heldOut)) frames[n.notParted].push_back(n.id);
  std::string text;
  for (const auto& [reason, which] : frames) text += (text.empty() ? "" : "; ") + framesText(which) + " (" + reason + ")";
  return text.empty() ? "" : "colours do not tell what is specular, and the smooth background is used, in " + text;
}

std::vector<std::string> evidenceWarnings(const std::vector<FrameNote>& notes) {
  std::vector<std::string> warnings;
  for (std::string warning : {clippedWarning(notes), notPartedWarning(notes)})
    if (!warning.empty()) warnings.push_back(std::move(warning));
  return warnings;
}

std::string scoredAgainst(const std::vector<FrameNote>& notes) {
  const auto any = [&](bool FrameNote::*which) {
    return std::any_of(notes.begin(), notes.end(), [&](const FrameNote& n) { return n.heldOut && n.*which; });
  };
  return any(&FrameNote::given) && !any(&FrameNote::detected) ? "given contours" : "own detection";
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/fit_remarks.h"

#include <algorithm>
#include <map>

namespace glint {

bool isSeen(const Inspection& r, const std::string& light) {
  return std::any_of(r.evidence.begin(), r.evidence.end(), [&](const FrameEvidence& e) {
    return std::any_of(e.highlights.begin(), e.highlights.end(), [&](const Highlight& h) { return h.light == light; });
  });
}

std::string mergedRemark(const Inspection& r, const ModelFit& fit) {
  std::map<std::string, int> on;
  for (const int frame : fit.frames)
    for (const std::string& light : r.scene->frames[std::size_t(frame)].lightsOn)
      if (light != fit.light && isOn(*r.scene, r.request.whatIf, frame, light)) ++on[light];
  std::string names;
  int most = 0;
  for (const auto& [light, frames] : on) {
    if (2 * frames < static_cast<int>(fit.frames.size()) || isSeen(r, light)) continue;
    names += (names.empty() ? "" : ", ") + light;
    most = std::max(most, frames);
  }
  if (names.empty()) return "";
  return "also on in " + std::to_string(most) + " of " + std::to_string(fit.frames.size()) +
         " training frames, without a separate highlight: " + names +
         "; where highlights of several lights merge, the estimated light lies between these lights";
}

std::string repeatedRemark(const Inspection& r, const ModelFit& fit) {
  std::string names;
  int count = 0;
  for (const int frame : r.train.frames) {
    const std::vector<int>& excluded = r.request.excluded;
    if (std::find(excluded.begin(), excluded.end(), frame) != excluded.end()) continue;
    if (r.keyFor(frame, fit.light).surface != fit.surface) continue;
    const std::vector<Highlight>& highlights = r.evidence[std::size_t(frame)].highlights;
    if (std::none_of(highlights.begin(), highlights.end(), [&](const Highlight& h) { return h.light == fit.light; })) continue;
    if (std::any_of(r.views.begin(), r.views.end(), [&](const TrainingView& v) { return v.frame == frame; })) continue;
    names += (count++ == 0 ? "" : ", ") + r.scene->frames[std::size_t(frame)].id;
  }
  if (count == 0) return "";
  return std::to_string(count) + (count == 1 ? " training frame repeats" : " training frames repeat") +
         " another one exactly and count once: " + names;
}

std::string byHandRemark(const Inspection& r, const ModelFit& fit) {
  std::string names;
  for (const TrainingView& v : r.views) {
    if (v.highlight.byHand.empty() || !v.seen || v.highlight.light != fit.light) continue;
    if (std::find(fit.frames.begin(), fit.frames.end(), v.frame) == fit.frames.end()) continue;
    names += (names.empty() ? "" : "; ") + ("frame " + r.scene->frames[std::size_t(v.frame)].id + ": " + v.highlight.byHand);
  }
  return names;
}

}  // namespace glint

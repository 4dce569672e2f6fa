// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/texture_stage.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/base/number_text.h"
#include "core/base/parallel.h"
#include "core/fit/depth_motion.h"

namespace glint {
namespace {

using Verdicts = std::map<int, std::vector<MotionVerdict>>;

bool waits(const std::vector<MotionVerdict>& verdicts) {
  return std::any_of(verdicts.begin(), verdicts.end(),
                     [](const MotionVerdict& v) { return v.kind == MotionVerdict::Kind::Waiting; });
}

/// Null if it cannot be read: its user reports that.
std::shared_ptr<const Surface> surfaceIfAny(const SurfaceOfFrame& surfaceOf, int frame) {
  try {
    return surfaceOf(frame);
  } catch (const InputError&) {
    return nullptr;
  }
}

}  // namespace

void rejectTextures(Inspection& r, std::vector<int> frames, const SurfaceOfFrame& surfaceOf,
                    const std::function<void(const std::vector<int>&)>& gather, const ProgressFn& progress) {
  if (motionUse(r.request.settings) != MotionUse::Reject || r.request.whatIf.synthesise) return;
  const std::vector<std::vector<int>> panels = motionPanels(*r.scene, *r.surfaces);
  std::erase_if(frames, [&](int f) { return panels[static_cast<std::size_t>(f)].empty(); });
  const PanelDepths depths(*r.scene, r.request.settings);
  Verdicts verdicts;
  while (!frames.empty()) {
    std::vector<std::vector<MotionVerdict>> judged(frames.size());
    parallelFor(
        static_cast<int>(frames.size()),
        [&](int n) {
          const int f = frames[static_cast<std::size_t>(n)];
          judged[static_cast<std::size_t>(n)] = judgedByMotion(
              *r.scene, f, panels[static_cast<std::size_t>(f)], r.evidence, [&] { return surfaceIfAny(surfaceOf, f); }, depths,
              r.request.settings);
        },
        progress, "motion");
    std::set<int> missing, again;
    for (std::size_t n = 0; n < frames.size(); ++n) {
      const int f = frames[n];
      if (waits(judged[n])) {
        again.insert(f);
        for (const int other : panels[static_cast<std::size_t>(f)])
          if (r.evidence[static_cast<std::size_t>(other)].frame < 0) missing.insert(other);
      }
      verdicts[f] = std::move(judged[n]);
    }
    if (!missing.empty()) gather({missing.begin(), missing.end()});
    again.insert(missing.begin(), missing.end());
    frames.assign(again.begin(), again.end());
  }
  // Textures go only now, because every frame was judged by the full evidence of the others.
  for (const auto& [f, said] : verdicts)
    if (!said.empty())
      withholdTextures(r.evidence[static_cast<std::size_t>(f)], said, r.scene->frames[static_cast<std::size_t>(f)].camera);
}

std::string textureRemark(const Inspection& r) {
  std::string names;
  std::size_t frames = 0, spots = 0;
  for (const int f : r.train.frames) {
    const std::size_t here = r.evidence[static_cast<std::size_t>(f)].textures.size();
    if (here == 0 || !r.isTraining(f)) continue;
    names += (frames++ == 0 ? "" : ", ") + r.scene->frames[static_cast<std::size_t>(f)].id;
    spots += here;
  }
  if (frames == 0) return "";
  return formatted(
             "%zu bright spot%s of %zu training frame%s %s on the surface while highlights move, and %s no evidence "
             "(texture, detect.motion): ",
             spots, spots == 1 ? "" : "s", frames, frames == 1 ? "" : "s", spots == 1 ? "stays" : "stay",
             spots == 1 ? "is" : "are") +
         names;
}

}  // namespace glint

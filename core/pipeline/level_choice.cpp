// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/level_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/base/progress.h"
#include "core/pipeline/evidence.h"

namespace glint {
namespace {

constexpr std::array kTriedLevels{0.5, 0.4, 0.6, 0.3, 0.7};  // low ones lie in the tail, high ones on the noise of the top
constexpr std::size_t kMostFrames = 6;  // looked at: a level is for all, and each costs fifteen detections at most
constexpr double kLevelStep = 0.1;      // of the level
constexpr double kCentreShare = 0.02;   // of the longer semi-axis: the ellipse's centre is then fixed to one part in fifty
constexpr double kLobeMargin = 1.15;    // over an ideal lobe's change of its axes: pixels, noise and bent surfaces add to it
constexpr double kMostNoisePx = 0.5;    // on a single point of the contour

struct FrameAtLevel {
  bool found = false, stable = false, clipped = false;
  double noisePx = 0;
};

/// Relative change of a contour's radius with the level: the larger of a Gaussian's and GGX's, q = (1 + (2^(1/2) - 1) r^2)^-2.
double lobeChange(double level, double factor) {
  const auto ggx = [](double q) { return std::sqrt(1 / std::sqrt(q) - 1); };
  return std::max(std::abs(std::sqrt(std::log(factor * level) / std::log(level)) - 1),
                  std::abs(ggx(factor * level) / ggx(level) - 1));
}

const Highlight* largestOf(const FrameEvidence& evidence) {
  const auto largest = std::max_element(evidence.highlights.begin(), evidence.highlights.end(),
                                        [](const Highlight& a, const Highlight& b) { return a.areaPx2 < b.areaPx2; });
  return largest == evidence.highlights.end() || !largest->ellipse ? nullptr : &*largest;
}

FrameEvidence at(const Scene& scene, int frame, FrameSource source, const DetectSettings& settings, double level) {
  return gatherEvidence(scene, frame, source, settings.at(level));
}

FrameAtLevel lookAt(const Scene& scene, int frame, FrameSource source, const DetectSettings& settings, double level) {
  FrameAtLevel result;
  const FrameEvidence here = at(scene, frame, source, settings, level);
  const Highlight* const h = largestOf(here);
  if (!h) return result;
  result.found = true;
  result.clipped = h->clipped;
  const Outcome<LinearPixels> pixels = pixelsOf(scene.frames[static_cast<std::size_t>(frame)], source, settings);
  if (pixels)
    result.noisePx =
        highlightQualities(scene.frames[static_cast<std::size_t>(frame)], *pixels, nullptr, {}, {*h}).front().noisePx;
  result.stable = result.noisePx <= kMostNoisePx;
  for (const double factor : {1 - kLevelStep, 1 + kLevelStep}) {
    const FrameEvidence evidence = at(scene, frame, source, settings, factor * level);
    const Highlight* const other = largestOf(evidence);
    if (!other) {
      result.stable = false;
      break;
    }
    const double lobe = lobeChange(level, factor) * kLobeMargin;
    result.stable =
        result.stable && (other->ellipse->centre - h->ellipse->centre).norm() <= kCentreShare * h->ellipse->semiAxes.x();
    for (int axis = 0; axis < 2; ++axis)
      result.stable = result.stable && std::abs(other->ellipse->semiAxes[axis] / h->ellipse->semiAxes[axis] - 1) <= lobe;
  }
  return result;
}

/// The level of most contours that the scene gives.
std::optional<LevelChoice> givenLevel(const Scene& scene, const std::vector<int>& frames) {
  std::map<double, int> counts;
  for (const int f : frames)
    for (const Highlight& h : scene.frames[static_cast<std::size_t>(f)].highlights) ++counts[h.level];
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most == counts.end()) return std::nullopt;
  LevelChoice choice;
  choice.level = most->first;
  choice.reason = formatted("level %g: the scene gives its contours at this level", choice.level);
  return choice;
}

LevelChoice summaryOf(const std::vector<FrameAtLevel>& seen, double level) {
  LevelChoice choice;
  choice.level = level;
  std::vector<double> noise;
  int clipped = 0;
  for (const FrameAtLevel& f : seen) {
    choice.looked += f.found;
    choice.stable += f.stable;
    clipped += f.clipped;
    if (f.found) noise.push_back(f.noisePx);
  }
  if (!noise.empty()) choice.noisePx = upperMedian(noise);
  choice.reason = formatted(
      "level %g: the largest contour is stable in %d of %d frames when the level changes by a tenth, and noise moves "
      "its points by %.2g px",
      level, choice.stable, choice.looked, choice.noisePx);
  if (clipped > 0)
    choice.reason +=
        formatted("; clipped in %d of them: there it is the fraction of the clip value, and the true one is lower", clipped);
  return choice;
}

}  // namespace

Outcome<LevelChoice> chooseLevel(const Scene& scene, const std::vector<int>& frames, FrameSource source,
                                 const DetectSettings& settings, const ProgressFn& progress) {
  require(!frames.empty(), "chooseLevel: no frames");
  if (std::optional<LevelChoice> given = givenLevel(scene, frames)) return *std::move(given);
  std::vector<int> looked;
  const std::size_t n = std::min(kMostFrames, frames.size());
  for (std::size_t i = 0; i < n; ++i) looked.push_back(frames[i * frames.size() / n]);
  std::optional<LevelChoice> best;
  for (const double level : kTriedLevels) {
    std::vector<FrameAtLevel> seen(n);
    parallelFor(
        static_cast<int>(n),
        [&](int i) {
          const auto k = static_cast<std::size_t>(i);
          seen[k] = lookAt(scene, looked[k], source, settings, level);
        },
        progress, "level");
    LevelChoice choice = summaryOf(seen, level);
    if (choice.looked == 0 && level == kTriedLevels.front()) {
      const FrameEvidence first = at(scene, looked.front(), source, settings, level);
      return first.failure.value_or(Failure{Reason::NoHighlight, "no frame shows a highlight with an ellipse"});
    }
    const bool all = choice.looked > 0 && choice.stable == choice.looked;
    if (!best || choice.stable > best->stable) best = std::move(choice);
    if (all) return *std::move(best);
  }
  best->reason += "; at no level tried (0.3 to 0.7) is it stable in all of them";
  return *std::move(best);
}

}  // namespace glint

// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/number_text.h"
#include "core/draw/frame_overlay.h"
#include "core/draw/plot_text.h"
#include "core/draw/plots.h"

namespace glint::draw {
namespace {

void addContours(const FrameSamples::Lobe& lobe, std::size_t place, double level, double width, std::vector<OverlayLine>& lines) {
  const LobeComparison& comparison = *lobe.comparison;
  for (Polyline& run : lobeContours(lobe.samples->grid, comparison.matches[place], level)) {
    OverlayLine line;
    line.role = OverlayRole::Lobes;
    line.points = std::move(run.points);
    line.closed = run.closed;
    line.colour = lobeStyle(place).colour;
    line.dash = lobeStyle(place).dash;
    line.width = width;
    line.light = lobe.light;
    line.highlight = lobe.observed;
    line.label = lobeText(comparison, place) + formatted("\ncontour at %.3g of the peak", level);
    lines.push_back(std::move(line));
  }
}

}  // namespace

void addLobes(const FrameSamples& samples, int highlight, FrameOverlay& overlay) {
  const auto say = [&](const Colour& colour, const std::string& text, bool problem) {
    overlay.captions.push_back({colour, "", text, problem, {}});
  };
  const FrameSamples::Lobe* const lobe = lobeOfHighlight(samples, highlight);
  if (!lobe || !lobe->comparison)
    return say(kObserved,
               "every lobe: " + (!samples.failure.empty()  ? samples.failure
                                 : !lobe                   ? std::string("no highlight in this frame")
                                 : lobe->failure           ? lobe->failure->message()
                                 : lobe->comparisonFailure ? lobe->comparisonFailure->message()
                                                           : std::string("nothing sampled")),
               true);
  for (std::size_t k = 0; k < lobe->comparison->matches.size(); ++k) {
    const bool best = int(k) == lobe->comparison->best;
    if (lobe->samples && lobe->level > 0 && lobe->level < 1) {
      addContours(*lobe, k, lobe->level, best ? 2.2 : 1.5, overlay.lines);
      addContours(*lobe, k, kTailShare * lobe->level, best ? 1.4 : 1, overlay.lines);
    }
    say(lobeStyle(k).colour, lobeText(*lobe->comparison, k), false);
  }
}

}  // namespace glint::draw

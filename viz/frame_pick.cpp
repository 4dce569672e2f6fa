// SPDX-License-Identifier: BSD-3-Clause
#include "viz/frame_pick.h"

#include <cmath>

#include "core/geometry/polyline.h"
#include "viz/frame_details.h"

namespace glint::viz {
namespace {

/// The nearest line that `counts`, if it is near enough. Later lines lie on top, so they win a tie.
const OverlayLine* nearest(const FrameOverlay& shown, const Pixel& at, double nearPx, bool contoursOnly) {
  const OverlayLine* best = nullptr;
  double bestPx = nearPx;
  for (const OverlayLine& line : shown.lines) {
    if (contoursOnly && line.role != OverlayRole::ObservedContour && line.role != OverlayRole::PredictedContour) continue;
    const double px = distance({line.points, line.closed}, at);
    if (px > bestPx) continue;
    bestPx = px;
    best = &line;
  }
  return best;
}

}  // namespace

Selection pickInFrame(const Inspection& inspection, const Selection& now, const FrameOverlay& shown, const Pixel& clicked,
                      double nearPx) {
  require(inspection.scene && now.frame >= 0 && now.frame < static_cast<int>(inspection.scene->frames.size()),
          "pickInFrame: no such frame");
  Selection picked = now;
  picked.highlight = -1;
  picked.direction.reset();
  picked.light.clear();
  const Pixel ideal = inspection.scene->frames[static_cast<std::size_t>(now.frame)].camera.undistorted(clicked);
  if (const OverlayLine* line = nearest(shown, clicked, nearPx, true)) {
    picked.light = line->light;
    if (line->role == OverlayRole::ObservedContour) {
      picked.highlight = line->highlight;
    } else {
      picked.model = line->model;
      for (const FrameComparison& comparison : inspection.models.at(line->model).frames)
        if (comparison.frame == now.frame && comparison.light == line->light)
          picked.highlight = observedOf(comparison, line->highlight);
    }
    if (const std::optional<Pixel> origin = directionOrigin(inspection, now.frame, picked.highlight); origin && ideal.allFinite())
      picked.direction = std::atan2(ideal.y() - origin->y(), ideal.x() - origin->x());
    return picked;
  }
  if (static_cast<std::size_t>(now.frame) >= inspection.evidence.size()) return picked;
  const std::vector<Highlight>& observed = inspection.evidence[static_cast<std::size_t>(now.frame)].scored();
  for (std::size_t i = 0; i < observed.size() && picked.highlight < 0; ++i) {
    if (observed[i].contour.points.empty() || !contains(observed[i].contour, ideal)) continue;
    picked.highlight = static_cast<int>(i);
    picked.light = observed[i].light;
  }
  return picked;
}

std::string labelAt(const FrameOverlay& shown, const Pixel& at, double nearPx) {
  for (auto mark = shown.marks.rbegin(); mark != shown.marks.rend(); ++mark)
    if ((mark->at - at).norm() <= nearPx && !mark->label.empty()) return mark->label;
  const OverlayLine* line = nearest(shown, at, nearPx, false);
  return line ? line->label : std::string();
}

}  // namespace glint::viz

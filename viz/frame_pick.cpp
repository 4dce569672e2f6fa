// SPDX-License-Identifier: BSD-3-Clause
#include "viz/frame_pick.h"

#include <cmath>

#include "core/draw/frame_details.h"
#include "core/draw/selection.h"
#include "core/geometry/polyline.h"
#include "viz/style.h"

namespace glint::viz {
namespace {

/// The nearest line that `counts`, if it is near enough. Later lines lie on top, so they win a tie.
/// @param model  "" = all lines; else only this model's predictions
const OverlayLine* nearest(const FrameOverlay& shown, const Pixel& at, double nearPx, bool contoursOnly,
                           const std::string& model = "") {
  const OverlayLine* best = nullptr;
  double bestPx = nearPx;
  for (const OverlayLine& line : shown.lines) {
    if (contoursOnly && line.highlight < 0) continue;  // filtered, or ignored by hand
    if (contoursOnly && line.role != OverlayRole::ObservedContour && line.role != OverlayRole::PredictedContour) continue;
    if (!model.empty() && (line.role != OverlayRole::PredictedContour || line.model != model)) continue;
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
  picked.highlight = picked.predicted = -1;
  picked.direction.reset();
  picked.light.clear();
  const Pixel ideal = inspection.scene->frames[static_cast<std::size_t>(now.frame)].camera.undistorted(clicked);
  const OverlayLine* line = nearest(shown, clicked, nearPx, true);
  // Where contours lie on one another the selected model stays, whichever of them is drawn on top.
  if (line && line->role == OverlayRole::PredictedContour && !now.model.empty() && line->model != now.model)
    if (const OverlayLine* own = nearest(shown, clicked, nearPx, true, now.model)) line = own;
  if (line) {
    picked.light = line->light;
    if (line->role == OverlayRole::ObservedContour) {
      picked.highlight = line->highlight;
    } else {
      picked.model = line->model;
      for (const FrameComparison& comparison : inspection.models.at(line->model).frames)
        if (comparison.frame == now.frame && comparison.light == line->light) {
          picked.highlight = observedOf(comparison, line->highlight);
          picked.predicted = picked.highlight < 0 && draw::isSpurious(comparison, line->highlight) ? line->highlight : -1;
        }
      if (picked.predicted >= 0) return picked;  // directions are about an observed highlight
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

std::optional<Grip> gripAt(const Inspection& inspection, int frame, const Pixel& at, double nearPx) {
  if (frame < 0 || static_cast<std::size_t>(frame) >= inspection.evidence.size()) return std::nullopt;
  const FrameEvidence& evidence = inspection.evidence[static_cast<std::size_t>(frame)];
  if (evidence.againstTruth) return std::nullopt;
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(frame)].camera;
  std::optional<Grip> best;
  double bestPx = nearPx;
  const auto offer = [&](double px, int highlight, bool peak) {
    if (!(px <= bestPx)) return;
    bestPx = px;
    best = Grip{highlight, peak};
  };
  for (std::size_t i = 0; i < evidence.highlights.size(); ++i)
    offer((camera.distorted(evidence.highlights[i].peak) - at).norm(), static_cast<int>(i), true);
  if (best) return best;  // small next to its contour, so it comes first
  for (std::size_t i = 0; i < evidence.highlights.size(); ++i) {
    Polyline contour = evidence.highlights[i].contour;
    if (contour.points.empty()) continue;
    for (Pixel& p : contour.points) p = camera.distorted(p);
    offer(distance(contour, at), static_cast<int>(i), false);
  }
  return best;
}

std::string labelAt(const FrameOverlay& shown, const Pixel& at, double nearPx) {
  for (auto mark = shown.marks.rbegin(); mark != shown.marks.rend(); ++mark)
    if ((mark->at - at).norm() <= nearPx && !mark->label.empty()) return mark->label;
  const OverlayLine* line = nearest(shown, at, nearPx, false);
  return line ? line->label : std::string();
}

}  // namespace glint::viz

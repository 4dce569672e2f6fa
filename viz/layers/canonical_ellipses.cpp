// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/summary.h"
#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {

constexpr double kEllipsePx = 4;  // see Drawn::nearerPx: above its tangent plane

LayerContent canonicalEllipsesLayer(const LayerInput& in) {
  LayerContent content;
  const auto add = [&](const Camera& camera, const Plane& plane, const Ellipse& ellipse, bool strong, int frame,
                       const std::string& model) {
    Picked info;
    info.layer = "canonical-ellipses";
    info.frame = frame;
    info.model = model;
    info.text = line(model.empty() ? "canonical ellipse of frame" : "predicted canonical ellipse of frame", in.frame(frame).id) +
                line("centre x", ellipse.centre.x(), "px") + line("centre y", ellipse.centre.y(), "px") +
                line("semi-axis a", ellipse.semiAxes.x(), "px") + line("semi-axis b", ellipse.semiAxes.y(), "px") +
                line("angle", ellipse.angle * 57.29577951308232, "deg");
    const double width = strong ? 3.0 : 2.0;
    content.addOnSurface(lineActor(ellipseOnPlane(camera, plane, ellipse, 0), canonicalColour(), width), info, width, kEllipsePx);
  };
  for (const TrainingView* view : in.views()) {
    if (!view->seen || !view->canonical || !view->canonical->ellipse) continue;
    if (!in.solo && failedFor(*in.inspection, canonicalModel().id(), view->highlight.light)) continue;  // fitted to nothing
    add(view->camera, view->seen->tangentPlane, *view->canonical->ellipse, view->frame == in.selection.frame, view->frame, "");
  }
  // Shows the selected frame alone: what was observed in it, whether it trains or not. A predicted ellipse beside it would look
  // as if both came from the one contour.
  if (in.solo) {
    for (const TrainingView& view : in.ownViews(true))
      if (view.canonical->ellipse) add(view.camera, view.seen->tangentPlane, *view.canonical->ellipse, true, view.frame, "");
    if (!content.drawn.empty()) return content;
  }
  for (const std::string& model : in.models) {
    for (const FrameComparison* comparison : in.comparisons(model)) {
      for (const PredictedHighlight& h : comparison->prediction.highlights()) {
        if (!h.tangentPlane || !h.canonical || !h.canonical->ellipse) continue;
        add(in.frame(in.selection.frame).camera, *h.tangentPlane, *h.canonical->ellipse, true, in.selection.frame, model);
      }
    }
  }
  return content;
}

}  // namespace glint::viz

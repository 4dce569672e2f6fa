// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include "viz/glyphs.h"
#include "viz/layers.h"
#include "viz/lit_parts.h"

namespace glint::viz {
namespace {

Picked brightestInfo(const LayerInput& in, const BrightestPoint& b, int frame, const std::string& model, int highlight,
                     const std::string& light) {
  Picked info;
  info.highlight = highlight;
  info.light = light;
  info.layer = "peaks";
  info.frame = frame;
  info.model = model;
  info.text = line(model.empty() ? "observed brightest point, frame" : model + " brightest point, frame", in.frame(frame).id) +
              line("P", b.point.position, "m") + line("N", b.point.normal) +
              line("pixel", Eigen::Vector3d(b.pixel.x(), b.pixel.y(), 1), "px") +
              line("alpha", b.alpha * 180 / std::numbers::pi, "deg");
  return info;
}

}  // namespace

LayerContent peaksLayer(const LayerInput& in) {
  LayerContent content;
  const auto add = [&](const BrightestPoint& b, const Camera& camera, double size, const Colour& colour, const Picked& info) {
    const SurfacePoint p = facing(b.point, camera.centreInWorld());
    content.add(named(sphereActor({p.position}, size * in.scale.point, colour), "point"), info);
    const Eigen::Vector3d tip = p.position + size * in.scale.arrow * p.normal;
    content.add(named(arrowActor({{p.position, tip}}, 0.22 * size * in.scale.point,
                                 info.model.empty() ? in.ink() : colour),  // white would not be seen on a light ground
                      "normal"),
                info);
    if (in.solo && info.model.empty()) content.labels.push_back({tip, "N", in.ink(), p.position});
  };
  for (const TrainingView* view : in.views()) {
    if (!view->seen) continue;
    const bool selected = view->frame == in.selection.frame;
    add(view->seen->brightest, view->camera, selected ? 1.3 : 0.8, kObserved,
        brightestInfo(in, view->seen->brightest, view->frame, "", in.highlightOf(*view), view->highlight.light));
  }
  // Where training has no view of the selected frame, its peaks are cast here.
  const bool inTraining = in.inspection->isTraining(in.selection.frame);
  const auto selected = static_cast<std::size_t>(in.selection.frame);
  if (!inTraining && in.shows(in.selection.frame) && in.surface && selected < in.inspection->evidence.size()) {
    const Camera& camera = in.frame(in.selection.frame).camera;
    int index = 0;
    for (const Highlight& h : in.inspection->evidence[selected].highlights) {
      const Outcome<BrightestPoint> b = observedBrightestPoint(*in.surface, camera, h.peak);
      if (b) add(*b, camera, 1.3, kObserved, brightestInfo(in, *b, in.selection.frame, "", index, h.light));
      ++index;
    }
  }
  // What each model predicts is not derived from the frame: over its own normal it would be a bundle of arrows.
  if (in.solo && !content.drawn.empty()) return content;
  for (const std::string& model : in.models) {
    for (const FrameComparison* comparison : in.comparisons(model)) {
      for (const PredictedHighlight& h : comparison->prediction.highlights()) {
        // Without a tangent plane it is no point of the surface: primal has the middle of its ellipsoid there.
        if (!h.tangentPlane || !h.brightest.point.position.allFinite() || h.brightest.point.normal.norm() < 0.5) continue;
        add(h.brightest, in.frame(in.selection.frame).camera, 1.0, draw::modelColour(model, in.isPoor(model, *comparison)),
            brightestInfo(in, h.brightest, in.selection.frame, model, -1, comparison->light));
      }
    }
  }
  return content;
}

}  // namespace glint::viz

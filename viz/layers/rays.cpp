// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {

LayerContent raysLayer(const LayerInput& in) {
  LayerContent content;
  for (const TrainingView* view : in.views()) {
    if (!view->brightest) continue;
    const Eigen::Vector3d eye = view->camera.centreInWorld();
    const SurfacePoint p = facing(view->brightest->point, eye);
    const Eigen::Vector3d r = reflect((eye - p.position).normalized(), p.normal);
    // As far as the light where there is one in reach, so that one sees how well the rays meet there.
    double reach = 0.6 * in.scale.sceneSize;
    for (const auto& [key, estimate] : in.inspection->lights) {
      const Light& light = estimate.light;
      if (light.atInfinity() || key.rfind(view->highlight.light, 0) != 0) continue;
      const double along = r.dot(light.position() - p.position);
      if (along > 0) reach = std::min(1.1 * along, 4 * in.scale.sceneSize);
    }
    const bool selected = view->frame == in.selection.frame;
    const double width = selected ? 2.5 : 1.2;
    Picked info;
    info.layer = "rays";
    info.frame = view->frame;
    info.highlight = in.highlightOf(*view);
    info.light = view->highlight.light;
    info.text = line("reflected ray of frame", in.frame(view->frame).id) + line("P", p.position, "m") + line("r", r) +
                line("N", p.normal);
    content.add(segmentActor(dashed(eye, p.position, 0.015 * in.scale.sceneSize), kHeldOut, 1.0), info, 1.0);
    content.add(segmentActor({{p.position, p.position + reach * r}}, kLightColour, width), info, width);
  }
  return content;
}

}  // namespace glint::viz

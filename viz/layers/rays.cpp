// SPDX-License-Identifier: BSD-3-Clause
#include <vtkActor.h>
#include <vtkProperty.h>

#include <algorithm>

#include "viz/glyphs.h"
#include "viz/layers.h"
#include "viz/lit_parts.h"

namespace glint::viz {
namespace {

constexpr double kUnit = 1.3;        // length of V and L, as peaksLayer() draws N of the selected frame
constexpr double kElsewhere = 0.35;  // opacity of rays that left a surface which is not shown

void addRay(LayerContent& content, const LayerInput& in, const TrainingView& view, bool elsewhere) {
  const Eigen::Vector3d eye = view.camera.centreInWorld();
  const SurfacePoint p = facing(view.seen->brightest.point, eye);
  const Eigen::Vector3d v = (eye - p.position).normalized(), r = reflect(v, p.normal);
  const bool selected = view.frame == in.selection.frame;
  const double width = selected ? 2.5 : 1.2;
  Picked info;
  info.layer = "rays";
  info.frame = view.frame;
  info.highlight = in.highlightOf(view);
  info.light = view.highlight.light;
  info.text =
      line("reflected ray of frame", in.frame(view.frame).id) + line("P", p.position, "m") + line("r", r) + line("N", p.normal);
  const auto add = [&](const vtkSmartPointer<vtkActor>& actor, double widthPx) {
    if (elsewhere) actor->GetProperty()->SetOpacity(kElsewhere);
    content.add(actor, info, widthPx);
  };
  const std::vector<SceneThing> rays = rayThings(*in.inspection, view, in.scale);
  add(named(segmentActor(dashed(eye, p.position, 0.015 * in.scale.sceneSize), colourOf(rays[0]), 1.0), "view"), 1.0);
  add(named(lineActor(rays[1].chains, colourOf(rays[1]), width), "reflected"), width);
  if (!in.solo || !selected) return;
  // As long as the normal, so that the three are seen as one figure, each letter at the tip of its own.
  const auto addUnit = [&](const Eigen::Vector3d& direction, const char* letter, const Colour& colour, const char* part) {
    const Eigen::Vector3d tip = p.position + kUnit * in.scale.arrow * direction;
    add(named(arrowActor({{p.position, tip}}, 0.22 * kUnit * in.scale.point, colour), part), 0);
    content.labels.push_back({tip, letter, in.ink(), p.position});
  };
  addUnit(v, "V", kHeldOut, "view");
  addUnit(r, "L", kLightColour, "reflected");
}

}  // namespace

LayerContent raysLayer(const LayerInput& in) {
  LayerContent content;
  int elsewhere = 0;
  for (const TrainingView& view : in.inspection->views) {
    if (!view.seen || view.frame < 0 || !in.shows(view.frame)) continue;
    const bool here = in.onSurface(view.frame);
    // The light was found by the rays of all surfaces, unless each of them has a light of its own.
    if (!here && in.inspection->train.perSurface) continue;
    if (!here) ++elsewhere;
    addRay(content, in, view, !here);
  }
  for (const TrainingView& view : in.ownViews()) addRay(content, in, view, false);
  if (elsewhere > 0)
    content.remarks.push_back(
        "rays: " + std::to_string(elsewhere) + (elsewhere == 1 ? " starts" : " start") +
        (standsStill(*in.inspection->scene) ? " on another surface (faded)" : " where the surface stood then (faded)"));
  return content;
}

}  // namespace glint::viz

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

constexpr double kPlanePx = 2;  // see Drawn::nearerPx: below what lies on the plane

/// What the plane has to reach: three highlights, and where it is looked at alone the canonical contour, which lies on it and is
/// several times as large where the surface bulges. The planes of all frames together would hide the surface.
double radiusOf(const LayerInput& in, const Camera& camera, const Plane& plane, const Eigen::Vector3d& at,
                const std::vector<Pixel>& contour, const std::optional<CanonicalContour>& canonical) {
  const double own = planeRadius(camera, plane, at, contour, in.scale);
  if (!in.solo || !canonical) return own;
  return std::max(own, planeRadius(camera, plane, at, canonical->pixels, in.scale, kAboutCanonical));
}

void addPlane(LayerContent& content, const SceneThing& disc, bool strong, bool filled, const Picked& info) {
  const double width = strong ? 2.0 : 1.0;
  const Colour colour = colourOf(disc);
  if (filled)
    content.addOnSurface(discActor(disc.position(), disc.normal, disc.radius, colour, strong ? 0.32 : 0.18), info, 0, kPlanePx);
  content.addOnSurface(lineActor(disc.chains, colour, width), info, width, kPlanePx + 0.5);
}

}  // namespace

LayerContent tangentPlanesLayer(const LayerInput& in) {
  LayerContent content;
  const auto describe = [&](const Plane& plane, const Eigen::Vector3d& at, int frame, const std::string& model) {
    Picked info;
    info.layer = "tangent-planes";
    info.frame = frame;
    info.model = model;
    info.text = line("tangent plane of frame", in.frame(frame).id) + line("P", at, "m") + line("n", plane.normal) +
                line("offset d", plane.offset, "m");
    return info;
  };
  const auto addObserved = [&](const TrainingView& view) {
    if (!view.seen) return;
    const Eigen::Vector3d& at = view.seen->brightest.point.position;
    const Plane& plane = view.seen->tangentPlane;
    const double radius = radiusOf(in, view.camera, plane, at, view.highlight.contour.points, view.canonical);
    addPlane(content, tangentPlaneThing(plane, at, radius), view.frame == in.selection.frame, true,
             describe(plane, at, view.frame, ""));
  };
  bool trains = false;
  for (const TrainingView* view : in.views()) {
    trains = trains || view->frame == in.selection.frame;
    addObserved(*view);
  }
  if (trains) return content;
  // A held-out frame: the planes at its peaks, and those that the models predicted. Two sheets in almost one place would flicker
  // through each other, so of these then only the selected model's, as a ring.
  const std::vector<TrainingView> own = in.ownViews();
  for (const TrainingView& view : own) addObserved(view);
  if (in.solo && !own.empty()) return content;  // what is predicted is not derived from the frame
  for (const std::string& model : in.models) {
    const bool shown = std::find(in.models.begin(), in.models.end(), in.selection.model) != in.models.end();
    if (in.selection.model != model && (shown || !own.empty())) continue;
    for (const FrameComparison* comparison : in.comparisons(model)) {
      for (const PredictedHighlight& h : comparison->prediction.highlights()) {
        if (!h.tangentPlane) continue;
        const Eigen::Vector3d& at = h.brightest.point.position;
        const double radius =
            radiusOf(in, in.frame(in.selection.frame).camera, *h.tangentPlane, at, h.contour.points, h.canonical);
        SceneThing disc = tangentPlaneThing(*h.tangentPlane, at, radius);
        disc.model = model;
        disc.poor = in.isPoor(model, *comparison);
        addPlane(content, disc, true, own.empty(), describe(*h.tangentPlane, at, in.selection.frame, model));
      }
    }
  }
  return content;
}

}  // namespace glint::viz

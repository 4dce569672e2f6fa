// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

void addPlane(LayerContent& content, const LayerInput& in, const Camera& camera, const Plane& plane, const Eigen::Vector3d& at,
              const std::vector<Pixel>& contour, bool strong, const Colour& colour, const Picked& info) {
  const double side = plane.signedDistance(camera.centreInWorld()) < 0 ? -1 : 1;
  const double radius = planeRadius(camera, plane, at, contour, in.scale);
  const Eigen::Vector3d centre = at + side * in.scale.lift * plane.normal;
  const Eigen::Matrix<double, 3, 2> basis = tangentBasis(plane.normal);
  const double width = strong ? 2.0 : 1.0;
  content.add(discActor(centre, plane.normal, radius, colour, strong ? 0.32 : 0.18), info);
  content.add(lineActor({circle(centre, radius * basis.col(0), radius * basis.col(1))}, colour, width), info, width);
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
  bool observed = false;
  for (const TrainingView* view : in.views()) {
    if (!view->tangentPlane || !view->brightest) continue;
    const Eigen::Vector3d& at = view->brightest->point.position;
    const bool selected = view->frame == in.selection.frame;
    observed = observed || selected;
    addPlane(content, in, view->camera, *view->tangentPlane, at, view->highlight.contour.points, selected, kVirtualCamera,
             describe(*view->tangentPlane, at, view->frame, ""));
  }
  if (observed) return content;
  // A held-out frame: the planes that the models predicted. They agree but for their light, so one colour each.
  for (const std::string& model : in.models) {
    const bool another = !in.selection.model.empty() && in.selection.model != model;
    if (another && std::find(in.models.begin(), in.models.end(), in.selection.model) != in.models.end()) continue;
    for (const FrameComparison* comparison : in.comparisons(model)) {
      for (const PredictedHighlight& h : comparison->prediction.highlights) {
        if (!h.tangentPlane) continue;
        addPlane(content, in, in.frame(in.selection.frame).camera, *h.tangentPlane, h.brightest.point.position, h.contour.points,
                 true, modelColour(model), describe(*h.tangentPlane, h.brightest.point.position, in.selection.frame, model));
      }
    }
  }
  return content;
}

}  // namespace glint::viz

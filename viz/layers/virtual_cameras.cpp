// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <set>

#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {

namespace {

void addPair(LayerContent& content, const LayerInput& in, int frame, const LayerInput::Mirror& mirror, bool labelled) {
  const Camera& camera = in.frame(frame).camera;
  const Plane& plane = mirror.plane;
  // One cannot see the camera that one looks through.
  if (frame == in.selection.frame && in.eyeMirror && in.eyeMirror->normal == plane.normal && in.eyeMirror->offset == plane.offset)
    return;
  const SceneThing drawn = virtualCameraThing(camera, plane, in.scale.cameraDepth);
  const Eigen::Vector3d eye = camera.centreInWorld(), mirrored = drawn.position();
  const double width = frame == in.selection.frame ? 3.0 : 1.5;
  Picked info;
  info.layer = "virtual-cameras";
  info.frame = frame;
  info.highlight = mirror.highlight;
  info.light = mirror.light;
  info.text = line("virtual camera of frame", in.frame(frame).id) + line("centre", mirrored, "m") +
              line("tangent plane n", plane.normal) + line("tangent plane offset d", plane.offset, "m") +
              line("distance to the plane", std::abs(plane.signedDistance(eye)), "m");
  content.add(lineActor(drawn.chains, kVirtualCamera, width), info, width);
  if (content.glyphs.size() < kMostGlyphs) {  // centre, image plane, tip of the tick
    content.glyphs.push_back({mirrored, drawn.chains[5][1]});
    content.glyphs.back().insert(content.glyphs.back().end(), drawn.chains[0].begin(), drawn.chains[0].end() - 1);
  }
  // The pair, joined square through the tangent plane; seen from one of them the lines would only run across the photograph.
  if (in.eye == Eye::Outside) {
    content.add(segmentActor(dashed(eye, mirrored, 0.02 * in.scale.sceneSize), kVirtualCamera, 1.0), info, 1.0);
    content.add(sphereActor({plane.projected(eye)}, 0.7 * in.scale.point, kVirtualCamera), info);
  }
  content.extent.push_back(mirrored);
  if (labelled) content.labels.push_back({mirrored, "virtual camera " + in.frame(frame).id, kVirtualCamera});
}

/// How one sees in the mirror: the camera the brightest point, and the virtual camera the lamp, in a straight line through it.
void addSight(LayerContent& content, const LayerInput& in, const TrainingView& view) {
  if (!view.seen || in.eye != Eye::Outside) return;
  const Eigen::Vector3d eye = view.camera.centreInWorld(), mirrored = view.seen->tangentPlane.reflected(eye);
  const Eigen::Vector3d& at = view.seen->brightest.point.position;
  const Eigen::Vector3d on = (at - mirrored).normalized();
  double reach = 0.6 * in.scale.sceneSize;
  const LightEstimate* const estimate = in.inspection->lightFor(view.frame, view.highlight.light);
  if (estimate && !estimate->light.atInfinity()) {
    const double along = on.dot(estimate->light.position() - at);
    if (along > 0) reach = std::min(along, 4 * in.scale.sceneSize);
  }
  Picked info;
  info.layer = "virtual-cameras";
  info.frame = view.frame;
  info.highlight = in.highlightOf(view);
  info.light = view.highlight.light;
  info.text = line("line of sight of virtual camera", in.frame(view.frame).id) + line("P", at, "m") + line("direction", on);
  content.add(segmentActor({{mirrored, at}}, kVirtualCamera, 2.5), info, 2.5);
  content.add(segmentActor({{at, at + reach * on}}, kLightColour, 2.5), info, 2.5);
  content.add(segmentActor({{eye, at}}, in.ink(), 1.5), info, 1.5);
}

}  // namespace

LayerContent virtualCamerasLayer(const LayerInput& in) {
  LayerContent content;
  std::set<int> done;
  std::vector<int> frames;
  if (in.shows(in.selection.frame)) frames.push_back(in.selection.frame);  // which need not be a training frame
  for (const TrainingView* view : in.views()) frames.push_back(view->frame);
  for (const int frame : frames) {
    if (!done.insert(frame).second) continue;
    bool first = frame == in.selection.frame;
    for (const LayerInput::Mirror& mirror : in.mirrors(frame)) {
      addPair(content, in, frame, mirror, first);
      first = false;
    }
  }
  for (const TrainingView* view : in.views())
    if (view->frame == in.selection.frame) addSight(content, in, *view);
  for (const TrainingView& view : in.ownViews()) addSight(content, in, view);
  return content;
}

}  // namespace glint::viz

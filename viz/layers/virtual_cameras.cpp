// SPDX-License-Identifier: BSD-3-Clause
#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {

namespace {

void addPair(LayerContent& content, const LayerInput& in, int frame, const Camera& camera, const Plane& plane, bool labelled) {
  const std::array<Eigen::Vector3d, 4> real = imagePlane(camera, in.scale.cameraDepth);
  std::array<Eigen::Vector3d, 4> c;
  for (std::size_t i = 0; i < 4; ++i) c[i] = plane.reflected(real[i]);
  const Eigen::Vector3d eye = camera.centreInWorld(), mirrored = plane.reflected(eye);
  const Eigen::Vector3d up = 0.16 * (c[0] - c[3]), top = 0.5 * (c[0] + c[1]);
  const double width = frame == in.selection.frame ? 3.0 : 1.5;
  Picked info;
  info.layer = "virtual-cameras";
  info.frame = frame;
  info.text = line("virtual camera of frame", in.frame(frame).id) + line("centre", mirrored, "m") +
              line("tangent plane n", plane.normal) + line("tangent plane offset d", plane.offset, "m") +
              line("distance to the plane", std::abs(plane.signedDistance(eye)), "m");
  content.add(lineActor({{c[0], c[1], c[2], c[3], c[0]},
                         {mirrored, c[0]},
                         {mirrored, c[1]},
                         {mirrored, c[2]},
                         {mirrored, c[3]},
                         {top + 0.18 * (c[0] - c[1]), top + up, top + 0.18 * (c[1] - c[0])}},
                        kVirtualCamera, width),
              info, width);
  // The pair, joined square through the tangent plane.
  content.add(segmentActor(dashed(eye, mirrored, 0.02 * in.scale.sceneSize), kVirtualCamera, 1.0), info, 1.0);
  content.add(sphereActor({plane.projected(eye)}, 0.7 * in.scale.point, kVirtualCamera), info);
  content.extent.push_back(mirrored);
  if (labelled) content.labels.push_back({mirrored, "virtual camera " + in.frame(frame).id, kVirtualCamera});
}

}  // namespace

LayerContent virtualCamerasLayer(const LayerInput& in) {
  LayerContent content;
  bool selected = false;
  for (const TrainingView* view : in.views()) {
    if (!view->tangentPlane) continue;
    const bool first = view->frame == in.selection.frame && !selected;
    addPair(content, in, view->frame, view->camera, *view->tangentPlane, first);
    selected = selected || first;
  }
  if (selected || !in.surface) return content;
  // A held-out frame has no training view: its mirror is the tangent plane at the observed peak.
  const auto frame = static_cast<std::size_t>(in.selection.frame);
  if (frame >= in.inspection->evidence.size()) return content;
  const Camera& camera = in.frame(in.selection.frame).camera;
  for (const Highlight& highlight : in.inspection->evidence[frame].highlights) {
    const Outcome<BrightestPoint> b = observedBrightestPoint(*in.surface, camera, highlight.peak);
    if (!b) continue;
    addPair(content, in, in.selection.frame, camera, Plane::through(b->point.position, b->point.normal), !selected);
    selected = true;
  }
  return content;
}

}  // namespace glint::viz

// SPDX-License-Identifier: BSD-3-Clause
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
  const std::array<Eigen::Vector3d, 4> real = imagePlane(camera, in.scale.cameraDepth);
  std::array<Eigen::Vector3d, 4> c;
  for (std::size_t i = 0; i < 4; ++i) c[i] = plane.reflected(real[i]);
  const Eigen::Vector3d eye = camera.centreInWorld(), mirrored = plane.reflected(eye);
  const Eigen::Vector3d up = 0.16 * (c[0] - c[3]), top = 0.5 * (c[0] + c[1]);
  const double width = frame == in.selection.frame ? 3.0 : 1.5;
  Picked info;
  info.layer = "virtual-cameras";
  info.frame = frame;
  info.highlight = mirror.highlight;
  info.light = mirror.light;
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
  if (content.glyphs.size() < kMostGlyphs) content.glyphs.push_back({mirrored, c[0], c[1], c[2], c[3], top + up});
  // The pair, joined square through the tangent plane; seen from one of them the lines would only run across the photograph.
  if (in.eye == Eye::Outside) {
    content.add(segmentActor(dashed(eye, mirrored, 0.02 * in.scale.sceneSize), kVirtualCamera, 1.0), info, 1.0);
    content.add(sphereActor({plane.projected(eye)}, 0.7 * in.scale.point, kVirtualCamera), info);
  }
  content.extent.push_back(mirrored);
  if (labelled) content.labels.push_back({mirrored, "virtual camera " + in.frame(frame).id, kVirtualCamera});
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
  return content;
}

}  // namespace glint::viz

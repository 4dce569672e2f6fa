// SPDX-License-Identifier: BSD-3-Clause
#include <vtkProperty.h>

#include "viz/frame_overlay.h"
#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

std::string cameraText(const LayerInput& in, int index) {
  const Inspection& inspection = *in.inspection;
  const Frame& frame = in.frame(index);
  std::string text = line("frame", frame.id) + line("index", std::to_string(index));
  text += line("use", inspection.isTraining(index) ? "training" : inspection.isHeldOut(index) ? "held out" : "excluded");
  text += line("centre", frame.camera.centreInWorld(), "m");
  text += line("axis", Eigen::Vector3d(frame.camera.camFromWorld.linear().row(2).transpose()));
  for (const std::string& model : in.models) {
    const FrameScore score = frameScore(inspection.models.at(model), index);
    if (score.errorPct) {
      text += line(model + " contour error", *score.errorPct, "%");
    } else if (!score.reason.empty()) {
      text += line(model, score.reason);
    }
  }
  return text;
}

}  // namespace

LayerContent camerasLayer(const LayerInput& in) {
  LayerContent content;
  for (const int index : in.frames) {
    const Camera& camera = in.frame(index).camera;
    const bool selected = index == in.selection.frame;
    const Eigen::Vector3d eye = camera.centreInWorld();
    const std::array<Eigen::Vector3d, 4> c = imagePlane(camera, in.scale.cameraDepth);
    // The tick over the upper edge shows which side of the image is up.
    const Eigen::Vector3d up = 0.16 * (c[0] - c[3]), top = 0.5 * (c[0] + c[1]);
    const std::vector<Points> chains{{c[0], c[1], c[2], c[3], c[0]},
                                     {eye, c[0]},
                                     {eye, c[1]},
                                     {eye, c[2]},
                                     {eye, c[3]},
                                     {top + 0.18 * (c[0] - c[1]), top + up, top + 0.18 * (c[1] - c[0])}};
    const bool training = in.inspection->isTraining(index);
    const Colour colour = selected ? in.ink() : training ? kTraining : kHeldOut;
    const double width = selected ? 3.0 : training ? 2.0 : 1.0;
    Picked info;
    info.layer = "cameras";
    info.frame = index;
    info.text = cameraText(in, index);
    content.add(lineActor(chains, colour, width), info, width);
    if (selected) content.labels.push_back({top + 1.6 * up, "frame " + in.frame(index).id, in.ink()});
  }
  return content;
}

}  // namespace glint::viz

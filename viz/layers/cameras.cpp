// SPDX-License-Identifier: BSD-3-Clause
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <cmath>

#include "core/draw/frame_overlay.h"
#include "core/pipeline/frame_score.h"
#include "viz/camera_colours.h"
#include "viz/glyphs.h"
#include "viz/layers.h"
#include "viz/scene_questions.h"

namespace glint::viz {
namespace {

std::string cameraText(const Inspection& inspection, const std::vector<std::string>& models, int index) {
  const Frame& frame = inspection.scene->frames[static_cast<std::size_t>(index)];
  std::string text = line("frame", frame.id);
  text += line("role", inspection.isTraining(index) ? "training" : inspection.isHeldOut(index) ? "held out" : "excluded");
  text += line("centre", frame.camera.centreInWorld(), "m");
  text += line("axis", Eigen::Vector3d(frame.camera.camFromWorld.linear().row(2).transpose()));
  for (const std::string& model : models) {
    const FrameScore score = frameScore(inspection.models.at(model), index);
    if (score.missed > 0) {
      text += line(model, missedText(score));
    } else if (score.errorPct) {
      text += line(model + " contour error", *score.errorPct, "%");
    } else if (!score.reason.empty()) {
      text += line(model, score.reason);
    }
  }
  return text;
}

Picked cameraInfo(int index) {
  Picked info;
  info.layer = "cameras";
  info.frame = index;
  return info;
}

}  // namespace

Picked cameraPicked(const Inspection& inspection, const std::vector<std::string>& models, int frame) {
  Picked info = cameraInfo(frame);
  info.text = cameraText(inspection, models, frame);
  return info;
}

namespace {

/// Many cameras of one line width in one actor: a thousand actors would take longer to draw than all the rest.
class Bundle {
 public:
  void add(const std::vector<Points>& chains, const Colour& colour, int frame) {
    for (const Points& chain : chains) {
      chains_.push_back(chain);
      colours_->InsertNextTuple3(255 * colour[0], 255 * colour[1], 255 * colour[2]);
      frames_.push_back(frame);
    }
  }
  void finish(LayerContent& content, const LayerInput& in, double width) {
    if (chains_.empty()) return;
    vtkSmartPointer<vtkPolyData> data = toPolyData(chains_);
    data->GetCellData()->SetScalars(colours_);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->SetLineWidth(static_cast<float>(width));
    content.addMany(
        actor.Get(),
        [frames = frames_, inspection = in.inspection, models = in.models](vtkIdType cell) {
          if (cell < 0 || cell >= static_cast<vtkIdType>(frames.size())) return cameraInfo(-1);
          return cameraPicked(*inspection, models, frames[static_cast<std::size_t>(cell)]);
        },
        width);
  }

 private:
  struct Colours : vtkSmartPointer<vtkUnsignedCharArray> {
    Colours() : vtkSmartPointer<vtkUnsignedCharArray>(vtkSmartPointer<vtkUnsignedCharArray>::New()) {
      (*this)->SetNumberOfComponents(3);
    }
  };
  std::vector<Points> chains_;
  Colours colours_;
  std::vector<int> frames_;
};

}  // namespace

LayerContent camerasLayer(const LayerInput& in) {
  LayerContent content;
  Bundle training, others;
  for (const int index : in.frames) {
    const Camera& camera = in.frame(index).camera;
    const bool selected = index == in.selection.frame;
    if (selected && in.eye != Eye::Outside) {
      // One cannot see the camera that one looks through; its frame would only double the photograph's edge.
      if (in.eye == Eye::Camera) continue;
    }
    const Colour colour = cameraColour(in, index).colour;
    const std::vector<Points> chains = frustum(camera, in.scale.cameraDepth);
    if (!selected && besideEye(in, index)) continue;
    if (selected || content.glyphs.size() < kMostGlyphs) {
      content.glyphs.push_back({camera.centreInWorld()});
      content.glyphs.back().insert(content.glyphs.back().end(), chains[0].begin(), chains[0].end() - 1);
    }
    if (!selected) {
      (in.inspection->isTraining(index) ? training : others).add(chains, colour, index);
      continue;
    }
    const Picked info = cameraPicked(*in.inspection, in.models, index);
    // Its own colour inside the ink, so that the selection hides neither role nor error.
    content.add(lineActor({chains[0], chains[5]}, in.ink(), 4.0), info, 4.0);
    content.add(lineActor({chains[1], chains[2], chains[3], chains[4]},
                          in.colours.by == CameraColours::By::Role ? in.ink() : colour, 3.0),
                info, 3.0);
    const Points& tick = chains[5];
    content.labels.push_back({tick[1] + 0.6 * (tick[1] - 0.5 * (tick[0] + tick[2])), "frame " + in.frame(index).id, in.ink()});
  }
  training.finish(content, in, 2.0);
  others.finish(content, in, in.colours.by == CameraColours::By::Role ? 1.0 : 2.0);
  return content;
}

}  // namespace glint::viz

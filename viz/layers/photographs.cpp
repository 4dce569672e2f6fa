// SPDX-License-Identifier: BSD-3-Clause
#include <vtkActor.h>
#include <vtkImageData.h>
#include <vtkPlaneSource.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <algorithm>

#include "core/pipeline/photograph.h"
#include "viz/layers.h"
#include "viz/scene_questions.h"

namespace glint::viz {
namespace {

constexpr std::size_t kMostPhotographs = 24;  ///< more are too small to see and slow to load
constexpr std::size_t kMostNamed = 5;         ///< in the note about those that cannot be read
constexpr int kThumbnail = 256, kSelected = 640;

}  // namespace

LayerContent photographsLayer(const LayerInput& in) {
  LayerContent content;
  const bool synthesised = picturesAreSynthesised(*in.inspection);
  std::vector<int> chosen;
  const std::size_t n = in.frames.size(), count = std::min(n, kMostPhotographs);
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(in.frames[i * n / count]);
  if (in.shows(in.selection.frame) && std::find(chosen.begin(), chosen.end(), in.selection.frame) == chosen.end())
    chosen.push_back(in.selection.frame);
  if (count < n)
    content.remarks.push_back("photographs: " + std::to_string(chosen.size()) + " of " + std::to_string(n) + " cameras");
  std::vector<std::string> unreadable;
  for (const int index : chosen) {
    if (!hasPhotograph(*in.inspection, index)) continue;                  // nothing to read, so nothing that cannot be read
    if (in.eye != Eye::Outside && index == in.selection.frame) continue;  // it is drawn over the whole picture
    if (besideEye(in, index)) continue;
    const Frame& frame = in.frame(index);
    LayerCache::Photograph photograph =
        in.cache->photograph(*in.inspection, index, index == in.selection.frame ? kSelected : kThumbnail);
    if (photograph.arriving && index == in.selection.frame)
      photograph = in.cache->photograph(*in.inspection, index, kThumbnail);  // perhaps the small one is there
    if (!photograph.texture) {
      if (!photograph.arriving) unreadable.push_back(frame.id);
      continue;
    }
    const vtkSmartPointer<vtkImageData> image = photograph.texture;
    const std::array<Eigen::Vector3d, 4> c = imagePlane(frame.camera, in.scale.cameraDepth);
    // Texture row 0 is the photograph's bottom row: the plane starts at the bottom left corner.
    vtkNew<vtkPlaneSource> plane;
    plane->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    plane->SetOrigin(c[3].x(), c[3].y(), c[3].z());
    plane->SetPoint1(c[2].x(), c[2].y(), c[2].z());
    plane->SetPoint2(c[0].x(), c[0].y(), c[0].z());
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(plane->GetOutputPort());
    mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(2, 2);  // behind its own frame
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->SetTexture(in.cache->textureOf(image));
    actor->GetProperty()->LightingOff();
    Picked info;
    info.layer = "photographs";
    info.frame = index;
    info.text = line("frame", frame.id) +
                line("photograph",
                     synthesised ? "synthesised" : (frame.image.empty() ? frame.radiance : frame.image).filename().string());
    content.add(actor.Get(), info);
  }
  if (!unreadable.empty()) {
    std::string names;
    for (std::size_t i = 0; i < std::min(unreadable.size(), kMostNamed); ++i) names += (i > 0 ? ", " : " ") + unreadable[i];
    if (unreadable.size() > kMostNamed) names += " and " + std::to_string(unreadable.size() - kMostNamed) + " more";
    content.notes.push_back("unreadable photographs:" + names);
  }
  return content;
}

}  // namespace glint::viz

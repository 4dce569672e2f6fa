// SPDX-License-Identifier: BSD-3-Clause
// A plugin that adds one of everything: glint --plugin example.so --version lists it.
#include "core/app/plugin.h"
#include "plugins/example/camera_table.h"
#include "plugins/example/flat_mirror.h"
#include "plugins/example/student_lobe.h"
#include "plugins/example/superellipsoid.h"
#include "viz/added_layer.h"
#include "viz/glyphs.h"

namespace {

/// The way of the camera, frame by frame.
glint::viz::LayerContent cameraPath(const glint::viz::LayerInput& in) {
  glint::viz::Points path;
  for (int frame = 0; frame < static_cast<int>(in.inspection->scene->frames.size()); ++frame)
    if (in.shows(frame)) path.push_back(in.frame(frame).camera.centreInWorld());
  glint::viz::LayerContent content;
  glint::viz::Picked info;
  info.layer = "camera-path";
  if (path.size() > 1) content.add(glint::viz::lineActor({path}, in.ink(), 1.5), info, 1.5);
  return content;
}

void add(glint::PluginRegistry& glint) {
  glint.add(std::make_unique<glint::example::FlatMirror>());
  glint.add(std::make_unique<glint::example::StudentLobe>());
  glint.add(std::make_unique<glint::example::SuperellipsoidKind>());
  glint.add(std::make_unique<glint::example::CameraTable>());
}

void addLayers(glint::viz::LayerRegistry& layers) {
  layers.add({{"camera-path", "Camera path", false},
              glint::viz::kOnScene | glint::viz::kOnSolo | glint::viz::kOnHidden | glint::viz::kOnTheme,
              cameraPath});
}

}  // namespace

GLINT_PLUGIN_WITH_LAYERS("example", "1.0", "Adds one of everything, as an example", add, addLayers)

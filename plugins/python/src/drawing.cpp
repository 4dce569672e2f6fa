// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "core/draw/scene_drawing.h"
#include "core/surface/mesh_policy.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

py::dict thingDict(const draw::SceneThing& t) {
  py::dict out;
  out["role"] = draw::nameOf(t.role);
  out["frame"] = t.frame;
  out["highlight"] = t.highlight;
  out["light"] = t.light;
  out["model"] = t.model;
  out["surface"] = t.surface;
  out["poor"] = t.poor;
  out["shared"] = t.shared;
  out["gap"] = t.gap;
  out["label"] = t.label;
  out["problem"] = t.problem;
  out["colour"] = draw::colourOf(t);
  out["place"] = arrayOrNone(t.place);
  out["normal"] = t.normal.isZero() ? py::object(py::none()) : py::object(copyOf(t.normal));
  out["radius"] = t.radius;
  py::list chains;
  for (const draw::WorldChain& chain : t.chains) chains.append(ownedBy(chain));
  out["chains"] = chains;
  out["world_from_ball"] = t.body ? py::object(copyOf(draw::ballOf(*t.body, 0).matrix())) : py::object(py::none());
  out["arrow"] = t.arrow ? py::object(ownedBy(draw::WorldChain{t.arrow->first, t.arrow->second})) : py::object(py::none());
  if (t.mesh) out["mesh"] = SurfaceHandle{t.mesh};
  return out;
}

}  // namespace

py::list drawingOf(const InspectionHandle& handle, const py::object& frame) {
  const Inspection& inspection = *handle.inspection;
  std::vector<int> frames;
  for (int f = 0; f < static_cast<int>(inspection.scene->frames.size()); ++f) frames.push_back(f);
  draw::DrawingOptions options;
  draw::SceneDrawing things;
  std::optional<std::string> key;
  std::shared_ptr<const Surface> surface;
  const int index = frame.is_none() ? -1 : SceneHandle{inspection.scene, nullptr, handle.context.input}.frameOf(frame);
  if (inspection.surfaces) {
    const auto found = inspection.surfaces->surfaceOf(std::max(index, 0), meshPolicy(inspection.request.settings));
    if (found) surface = *found;
    if (index >= 0) key = inspection.surfaces->keyOf(index);
  }
  options.scale = draw::sceneScale(inspection, surface.get(), frames, 1);
  if (index >= 0) things = draw::frameThings(inspection, index, surface, options);
  for (draw::SceneThing& thing : draw::sceneThings(inspection, options))
    if (!key || !thing.surface || thing.surface == key) things.push_back(std::move(thing));
  py::list out;
  for (const draw::SceneThing& thing : things) out.append(thingDict(thing));
  return out;
}

}  // namespace glint::python

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>

#include "core/geometry/conic.h"
#include "core/pipeline/inspection.h"
#include "core/reflectance/lamp.h"
#include "core/report/report.h"
#include "core/scene/scene.h"
#include "core/surface/surface.h"

// What Python holds where core shares constant objects.
namespace glint::python {

namespace py = pybind11;

/// A frame by its number or its id; so named in signatures and stubs.
inline int isAnyObject(PyObject*) { return 1; }
class FrameName : public py::object {
  PYBIND11_OBJECT_DEFAULT(FrameName, py::object, isAnyObject)
};

struct SurfaceHandle {
  std::shared_ptr<const Surface> surface;
};

struct SceneHandle {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const SurfaceCache> surfaces;  ///< of queries; an inspection has its own
  std::string input;                             ///< as the caller named it
  /// InputError if there is no such frame.
  int frameOf(py::handle indexOrId) const;
};

/// How a scene is inspected, as a session keeps it or a caller asks for it.
struct RequestHandle {
  InspectionRequest request;
};

struct InspectionHandle {
  std::shared_ptr<const Inspection> inspection;
  ReportContext context;
  std::optional<Failure> failure;  ///< why no model answered
};

/// A part of `owner`, which it keeps alive; None if there is no such part.
template <class T>
py::object partOrNone(const T* part, py::handle owner) {
  return part ? py::cast(part, py::return_value_policy::reference_internal, owner) : py::none();
}

/// What a 3D picture shows of a frame, and of the scene on its surface; of the scene alone where the frame is None: one
/// dictionary for each draw::SceneThing. InputError for a frame that does not exist.
py::list drawingOf(const InspectionHandle& handle, const py::object& frame);

void declareGeometry(py::module_& module);
void declareCameras(py::module_& module);
void declareSurfaces(py::module_& module);
void declareScenes(py::module_& module);
void declareEvidence(py::module_& module);
void declareModels(py::module_& module);
void declareFits(py::module_& module);
void declareMetrics(py::module_& module);
void declareInspections(py::module_& module);
void declareSessions(py::module_& module);
void declareLamps(py::module_& module);
void declareRetexture(py::module_& module);
void declareTradeoff(py::module_& module);
void declareSynth(py::module_& module);

/// What fieldsOf() says of a lamp, as keys of a dict; "radius" always.
void addLamp(const Lamp& lamp, py::dict& out);

}  // namespace glint::python

namespace pybind11::detail {
template <>
struct handle_type_name<glint::python::FrameName> {
  static constexpr auto name = const_name("Union[int, str]");
};
}  // namespace pybind11::detail

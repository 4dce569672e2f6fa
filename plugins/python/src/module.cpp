// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "core/app/load_plugins.h"
#include "core/base/limits.h"
#include "core/base/version.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/options.h"
#include "plugins/python/src/types.h"

namespace {

namespace py = pybind11;

/// pybind11 aborts if Python's old pickle protocols make an object without its constructor, so each class refuses itself.
void refusePickling(const py::module_& module) {
  const py::handle ours(reinterpret_cast<PyObject*>(py::detail::get_internals().default_metaclass));
  for (const auto& [name, value] : py::reinterpret_borrow<py::dict>(module.attr("__dict__"))) {
    if (!py::isinstance(value, ours)) continue;
    const auto refuse = [](const py::object& self, const py::args&) -> py::object {
      throw py::type_error("cannot pickle or copy '" + py::str(py::type::of(self).attr("__name__")).cast<std::string>() +
                           "' object");
    };
    for (const char* method : {"__reduce__", "__reduce_ex__"})
      py::setattr(value, method, py::cpp_function(refuse, py::name(method), py::is_method(value)));
  }
}

newfunc newOfRegistered = nullptr;

/// TypeError where pybind11 aborts the process: for its own base class, and for classes of Python derived from that alone.
PyObject* newOrRefuse(PyTypeObject* type, PyObject* args, PyObject* named) {
  try {
    if (!py::detail::all_type_info(type).empty()) return newOfRegistered(type, args, named);
    PyErr_Format(PyExc_TypeError, "cannot create '%.200s' instances", type->tp_name);
  } catch (const std::exception& e) {
    PyErr_SetString(PyExc_RuntimeError, e.what());
  }
  return nullptr;
}

/// Before the classes are declared, which take it over from their base. Another module of pybind11 may have the same base.
void refuseBareObjects() {
  auto* const base = reinterpret_cast<PyTypeObject*>(py::detail::get_internals().instance_base);
  if (base->tp_new == newOrRefuse) return;
  newOfRegistered = base->tp_new;
  base->tp_new = newOrRefuse;
}

}  // namespace

PYBIND11_MODULE(_glint, module) {
  using namespace glint::python;
  module.doc() = "Glint's computing core. Use the package `glint`, which adds the functions that take keyword arguments.";
  module.attr("__version__") = GLINT_VERSION;
  refuseBareObjects();
  declareFailures(module);
  declareSettings(module);
  declareGeometry(module);
  declareCameras(module);
  declareSurfaces(module);
  declareEvidence(module);
  declareModels(module);
  declareFits(module);
  declareMetrics(module);
  declareScenes(module);
  declareInspections(module);
  declareSessions(module);
  declareLamps(module);
  declareRetexture(module);
  declareTradeoff(module);
  declareSynth(module);
  refusePickling(module);
  module.def(
      "set_limit", [](const std::string& nameAndValue) { glint::setLimit(nameAndValue); }, py::arg("name_and_value"),
      "Raises a limit on the size of inputs for this process: \"mesh-megabytes=4096\". InputError, with the known names.");
  module.def(
      "load_plugin", [](const std::string& file) { glint::loadPlugin(file); }, py::arg("file"),
      "Loads a plugin, as `--plugin FILE`: call it before anything else. InputError where it is refused; then nothing of it is "
      "kept.");
  module.def(
      "plugins",
      [] {
        std::vector<std::string> lines;
        for (const glint::LoadedPlugin& p : glint::loadedPlugins()) {
          std::string added;
          for (const std::string& what : p.added) added += (added.empty() ? "" : ", ") + what;
          lines.push_back(p.name + " " + p.version + " (" + added + "; " + p.file.string() + ")");
        }
        return lines;
      },
      "Loaded plugins, one line each.");
}

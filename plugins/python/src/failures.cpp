// SPDX-License-Identifier: BSD-3-Clause
#include "plugins/python/src/failures.h"

#include <exception>
#include <string>
#include <utility>
#include <vector>

namespace glint::python {
namespace {

PyObject *theError = nullptr, *theCannotAnswer = nullptr, *theInputError = nullptr, *theStopped = nullptr;

PyObject* declare(py::module_& module, const char* name, PyObject* base, const char* doc) {
  PyObject* const made = PyErr_NewExceptionWithDoc((std::string("glint.") + name).c_str(), doc, base, nullptr);
  if (!made) throw py::error_already_set();
  module.attr(name) = py::reinterpret_borrow<py::object>(made);
  return made;  // never freed: translators use it until the interpreter ends
}

void raise(PyObject* type, const std::string& message, std::initializer_list<std::pair<const char*, std::string>> attributes) {
  py::object exception = py::reinterpret_borrow<py::object>(type)(message);
  for (const auto& [name, value] : attributes) exception.attr(name) = value;
  PyErr_SetObject(type, exception.ptr());
}

/// InputError keeps file and place; the reason is what follows them in its line.
std::string reasonOf(const InputError& e) {
  std::string line = e.what();
  for (const std::string& part : {e.file(), e.place()})
    if (!part.empty() && line.rfind(part + ": ", 0) == 0) line = line.substr(part.size() + 2);
  return line;
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& e) {
    raise(theInputError, e.what(), {{"file", e.file()}, {"place", e.place()}, {"reason", reasonOf(e)}});
  } catch (const CannotAnswer& e) {
    raise(theCannotAnswer, e.failure.message(), {{"reason", nameOf(e.failure.reason)}, {"detail", e.failure.detail}});
  } catch (const StoppedByCaller&) {
    raise(theStopped, "stopped: the progress function returned False", {});
  }
}

}  // namespace

py::object partsOrNone(const std::optional<Failure>& failure) {
  if (!failure) return py::none();
  return py::make_tuple(failure->message(), nameOf(failure->reason), failure->detail);
}

std::optional<std::string> messageOrNone(const Failure* failure) {
  if (!failure) return std::nullopt;
  return failure->message();
}

void declareFailures(py::module_& module) {
  theError = declare(module, "Error", PyExc_Exception,
                     "What Glint raises besides ValueError and TypeError, which are the caller's bugs.");
  theCannotAnswer =
      declare(module, "CannotAnswer", theError,
              "The data cannot answer.\n\nAttributes\n----------\nreason : str\n    Stable name, such as \"too few views\".\n"
              "detail : str\n    One line for a person; may be empty.");
  theInputError =
      declare(module, "InputError", theError,
              "A file, a setting or a disk is wrong.\n\nAttributes\n----------\nfile : str\n    As the caller gave it; may be "
              "empty.\nplace : str\n    Where in it (\"frames[3].camera_from_world\"), or which argument of the command line "
              "(\"--train\"); may be empty.\nreason : str\n    One line.");
  theStopped = declare(module, "Stopped", theError, "A progress function returned False.");
  // On the classes too, so that stubs and editors know them.
  for (const auto& [type, names] : {std::pair(theCannotAnswer, std::vector{"reason", "detail"}),
                                    std::pair(theInputError, std::vector{"file", "place", "reason"})})
    for (const char* const name : names) py::reinterpret_borrow<py::object>(type).attr(name) = "";
  py::register_exception_translator(translate);
}

}  // namespace glint::python

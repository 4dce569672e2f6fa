// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include "core/base/settings.h"

namespace glint::python {

namespace py = pybind11;

/// Sets what a dictionary says: names as `--set` takes them ("predict.directions"), or with an underscore for the point
/// ("predict_directions"), as keyword arguments must be written. InputError, as on the command line.
void applySettings(py::handle dictionary, Settings& settings);
Settings settingsFrom(py::handle dictionary);
/// Every setting with its value in force, by dotted name.
py::dict dictOf(const Settings& settings);

void declareSettings(py::module_& module);

}  // namespace glint::python

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <utility>

#include "core/base/outcome.h"

// The three kinds of failure (docs/architecture.md, "Failures") as Python's exceptions: a caller's bug is a ValueError or
// TypeError, data that cannot answer are glint.CannotAnswer, the outside world is glint.InputError. Both are glint.Error, and so
// is glint.Stopped.
namespace glint::python {

namespace py = pybind11;

/// Becomes glint.CannotAnswer.
struct CannotAnswer {
  Failure failure;
};
/// Becomes glint.Stopped: a progress function returned False.
struct StoppedByCaller {};

template <class T>
T valueOf(Outcome<T> outcome) {
  if (!outcome) throw CannotAnswer{outcome.failure()};
  return *std::move(outcome);
}

/// None, or the message of the failure: "too few views: need 3, have 2".
std::optional<std::string> messageOrNone(const Failure* failure);

/// None, or what the package raises CannotAnswer of: (message, reason, detail).
py::object partsOrNone(const std::optional<Failure>& failure);

void declareFailures(py::module_& module);

}  // namespace glint::python

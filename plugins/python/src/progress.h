// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

#include "core/base/progress.h"
#include "plugins/python/src/failures.h"

namespace glint::python {

/// Reports of long work to a Python function, from whichever thread they come, and the ways to stop it: the function returns
/// False or raises, or a signal arrives (Ctrl-C).
class Progress {
 public:
  /// @param callback  None, or called with (stage, done, total). TypeError for anything else.
  explicit Progress(py::object callback);
  ProgressFn function();
  /// After Stopped, with the interpreter's lock: what the function raised, else StoppedByCaller.
  [[noreturn]] void raise();

 private:
  bool report(const StageEvent& event);

  py::object callback_;
  const std::thread::id caller_ = std::this_thread::get_id();
  std::mutex mutex_;
  std::exception_ptr error_;
  bool stopped_ = false;
  std::chrono::steady_clock::time_point asked_{};
};

/// work(ProgressFn) without the interpreter's lock: other threads of Python go on meanwhile.
template <class Work>
auto withProgress(py::object callback, Work&& work) {
  Progress progress(std::move(callback));
  try {
    const py::gil_scoped_release release;
    return work(progress.function());
  } catch (const Stopped&) {
    progress.raise();
  }
}

}  // namespace glint::python

// SPDX-License-Identifier: BSD-3-Clause
#include "plugins/python/src/progress.h"

namespace glint::python {
namespace {
// Without a function to call, the lock is asked for this often, to see whether a signal came: far below what a person notices.
constexpr std::chrono::milliseconds kSignalsEvery{20};
}  // namespace

Progress::Progress(py::object callback) : callback_(std::move(callback)) {
  if (!callback_.is_none() && !PyCallable_Check(callback_.ptr())) throw py::type_error("progress: expected a function or None");
}

ProgressFn Progress::function() {
  return [this](const StageEvent& event) { return report(event); };
}

bool Progress::report(const StageEvent& event) {
  {
    // Loops inside of others report from several threads at once. Never held while the interpreter's lock is waited for.
    const std::scoped_lock lock(mutex_);
    if (stopped_) return false;
    const auto now = std::chrono::steady_clock::now();
    if (callback_.ptr() == Py_None) {
      // Python handles signals in its main thread alone, so a thread of the work has nothing to ask for.
      if (std::this_thread::get_id() != caller_ || now - asked_ < kSignalsEvery) return true;
      asked_ = now;
    }
  }
  const py::gil_scoped_acquire acquire;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (callback_.is_none()) return true;
    // Only False stops: a function that returns nothing goes on.
    if (callback_(event.stage, event.done, event.total).ptr() != Py_False) return true;
  } catch (...) {
    const std::scoped_lock lock(mutex_);
    if (!error_) error_ = std::current_exception();
  }
  const std::scoped_lock lock(mutex_);
  stopped_ = true;
  return false;
}

void Progress::raise() {
  if (error_) std::rethrow_exception(error_);
  throw StoppedByCaller{};
}

}  // namespace glint::python

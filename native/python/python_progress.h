#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <utility>

#include "base/progress.h"
#include "python/released_gil.h"

namespace snowbough::python {

namespace py = pybind11;

/// Calls Python's progress(share) with the GIL; a false return or a pending Ctrl-C stops the work.
/// A Python exception is kept and raised again once the C++ work has unwound.
class PythonProgress {
 public:
  explicit PythonProgress(py::object callback) : callback_(std::move(callback)) {}

  bool operator()(float share) {
    std::optional<py::gil_scoped_acquire> gil;
    take_gil([&gil] { gil.emplace(); });
    if (PyErr_CheckSignals() != 0) {
      raised_ = std::make_unique<py::error_already_set>();
      return false;
    }
    if (callback_.is_none()) return true;
    try {
      const py::object answer = callback_(share);
      return answer.is_none() || py::cast<bool>(py::bool_(answer));
    } catch (py::error_already_set& error) {
      raised_ = std::make_unique<py::error_already_set>(error);
      return false;
    }
  }

  /// Call with the GIL when the work ended with Cancelled.
  [[noreturn]] void raise() {
    if (raised_) throw py::error_already_set(*raised_);
    PyErr_SetString(PyExc_KeyboardInterrupt, "cancelled");
    throw py::error_already_set();
  }

 private:
  py::object callback_;
  std::unique_ptr<py::error_already_set> raised_;
};

/// Runs work(tree::Progress) without the GIL and returns its result. Between steps it calls
/// Python's progress(share), or only checks for Ctrl-C if that is None.
template <typename Work>
auto run_cancellable(const py::object& callback, const Work& work) {
  PythonProgress progress(callback);
  const base::Progress asked = [&progress](float share) { return progress(share); };
  std::optional<decltype(work(asked))> result;
  {
    ReleasedGil release;
    try {
      result.emplace(work(asked));
    } catch (const base::Cancelled&) {
      // Raised below, with the GIL.
    }
  }
  if (!result) progress.raise();
  return std::move(*result);
}

}  // namespace snowbough::python

#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <thread>

namespace snowbough::python {

/// Calls `take`, which acquires the GIL. While Python shuts down, a daemon thread that acquires it
/// is ended by unwinding its stack, which crashes C++ code whose work other threads wait for. Such
/// a thread stops here instead until the process ends.
template <typename Take>
void take_gil(const Take& take) {
  struct StopWhenUnwound {
    bool has_gil = false;
    ~StopWhenUnwound() noexcept(false) {
      while (!has_gil) std::this_thread::sleep_for(std::chrono::hours(1));
    }
  } guard;
  take();
  guard.has_gil = true;
}

/// Releases the GIL while it lives, as pybind11's own guard does.
class ReleasedGil {
 public:
  ReleasedGil() : state_(PyEval_SaveThread()) {}
  ~ReleasedGil() noexcept(false) {
    take_gil([this] { PyEval_RestoreThread(state_); });
  }
  ReleasedGil(const ReleasedGil&) = delete;
  ReleasedGil& operator=(const ReleasedGil&) = delete;

 private:
  PyThreadState* state_;
};

}  // namespace snowbough::python

#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <thread>

namespace snowbough::python {

/// Calls `take`, which takes Python's lock. While Python ends, a daemon thread that does so is
/// ended by unwinding its stack, which C++ does not survive where others wait for its work: it
/// stops here instead, until the process is gone.
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

/// Lets other threads of Python's run while it lives, as pybind11's own guard does.
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

#pragma once
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <utility>

#include "bindings.hpp"
#include "vbond/observe/table_text.hpp"

/// What a run has to do with the interpreter while it computes: its lock, its signals, its end.
namespace vbond::python {

/// A daemon thread that still computes as the interpreter ends may not take its lock any more, which would
/// end the process through our frames: it waits for the end here, as in newer versions of Python.
inline void wait_if_python_ends() {
#if PY_VERSION_HEX >= 0x030D0000
  while (Py_IsFinalizing()) pause();
#else
  while (_Py_IsFinalizing()) pause();
#endif
}

/// The lock of the interpreter is let go.
class WithoutLock {
 public:
  WithoutLock() : thread_(PyEval_SaveThread()) {}
  ~WithoutLock() {
    wait_if_python_ends();
    PyEval_RestoreThread(thread_);
  }
  WithoutLock(const WithoutLock&) = delete;
  WithoutLock& operator=(const WithoutLock&) = delete;

 private:
  PyThreadState* thread_;
};

/// Asks Python about ten times a second, from a step loop without its lock, whether Ctrl-C was pressed.
class Interruption {
 public:
  bool asked() {
    if (++steps_ < interval_) return false;
    const auto now = std::chrono::steady_clock::now();
    interval_ = progress_interval(steps_, std::chrono::duration<double>(now - looked_).count());
    steps_ = 0, looked_ = now;
    wait_if_python_ends();
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() == 0) return false;
    error_ = std::make_unique<py::error_already_set>();
    return true;
  }
  /// Before steps that may take longer than those before.
  void begin_anew() { steps_ = 0, interval_ = 1; }
  /// Throws what a signal has raised, if one has.
  void raise() {
    if (error_) throw py::error_already_set(*std::exchange(error_, nullptr));
  }

 private:
  std::int64_t steps_ = 0, interval_ = 1;
  std::chrono::steady_clock::time_point looked_ = std::chrono::steady_clock::now();
  std::unique_ptr<py::error_already_set> error_;
};

}  // namespace vbond::python

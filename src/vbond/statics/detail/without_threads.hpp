#pragma once
#include <dlfcn.h>

#include "vbond/statics/detail/one_blas_thread.hpp"

namespace vbond {

/// As long as it lives, CHOLMOD and OpenBLAS do their loops alone. CHOLMOD would share out every small front
/// of a matrix among four threads of OpenMP, whose waiting takes longer than the work: a shell of 2,700
/// unknowns took three times as long. The runtime is the one that CHOLMOD was built with, so it is asked for
/// by name.
class WithoutThreads {
 public:
  WithoutThreads() {
    if (get_ == nullptr || set_ == nullptr) return;
    before_ = get_();
    set_(0);
  }
  ~WithoutThreads() {
    if (get_ != nullptr && set_ != nullptr) set_(before_);
  }
  WithoutThreads(const WithoutThreads&) = delete;
  WithoutThreads& operator=(const WithoutThreads&) = delete;

 private:
  template <class F>
  static F* found(const char* name) {
    return reinterpret_cast<F*>(dlsym(RTLD_DEFAULT, name));
  }
  int (*get_)() = found<int()>("omp_get_max_active_levels");
  void (*set_)(int) = found<void(int)>("omp_set_max_active_levels");
  OneBlasThread blas_;
  int before_ = 0;
};

}  // namespace vbond

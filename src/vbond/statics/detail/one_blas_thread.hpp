#pragma once
#include <mutex>

// OpenBLAS's own, declared here since <cblas.h> may be that of another BLAS.
extern "C" void openblas_set_num_threads(int);
extern "C" int openblas_get_num_threads();

namespace vbond {

/// As long as one lives, in whichever thread of the process, OpenBLAS works with one thread; after the last
/// it has as many as before the first. The number is one for the whole process, which may be somebody else's.
/// To change it costs more than a small factor takes: stages hold one while they run.
class OneBlasThread {
 public:
  OneBlasThread() {
    const std::lock_guard lock(mutex_);
    if (users_++ > 0) return;
    before_ = openblas_get_num_threads();
    openblas_set_num_threads(1);
  }
  ~OneBlasThread() {
    const std::lock_guard lock(mutex_);
    if (--users_ == 0) openblas_set_num_threads(before_);
  }
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

 private:
  static inline std::mutex mutex_;
  static inline int users_ = 0, before_ = 1;
};

}  // namespace vbond

// The threads of OpenBLAS, which the module shares with NumPy.
#pragma once

#include <cblas.h>

#include <mutex>

namespace isosyrk::python {

/// Keeps OpenBLAS to one thread while any object of this class lives; the last one restores the
/// number that the first one found.
class OneBlasThread {
 public:
  OneBlasThread() {
    const std::scoped_lock lock(mutex_);
    if (users_++ > 0) return;
    found_ = openblas_get_num_threads();
    if (found_ != 1) openblas_set_num_threads(1);
  }
  ~OneBlasThread() {
    const std::scoped_lock lock(mutex_);
    if (--users_ == 0 && found_ != 1) openblas_set_num_threads(found_);
  }
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

 private:
  inline static std::mutex mutex_;
  inline static int users_ = 0;
  inline static int found_ = 1;
};

}  // namespace isosyrk::python

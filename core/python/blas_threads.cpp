#include "blas_threads.h"

#include <cblas.h>

#include <mutex>

namespace isosyrk::python {
namespace {

std::mutex mutex;
int users = 0;
int found = 1;

}  // namespace

OneBlasThread::OneBlasThread() {
  const std::scoped_lock lock(mutex);
  if (users++ > 0) return;
  found = openblas_get_num_threads();
  if (found != 1) openblas_set_num_threads(1);
}

OneBlasThread::~OneBlasThread() {
  const std::scoped_lock lock(mutex);
  if (--users == 0 && found != 1) openblas_set_num_threads(found);
}

}  // namespace isosyrk::python

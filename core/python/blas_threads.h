// The threads of OpenBLAS, which the module shares with NumPy.
#pragma once

namespace isosyrk::python {

/// Keeps OpenBLAS to one thread while any object of this class lives; the last one restores the
/// number that the first one found.
class OneBlasThread {
 public:
  OneBlasThread();
  ~OneBlasThread();
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;
};

}  // namespace isosyrk::python

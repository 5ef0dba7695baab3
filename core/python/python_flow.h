// A flow whose generator B is a Python function.
#pragma once

#include <pybind11/pybind11.h>

#include "isosyrk/flows/flow.h"

namespace isosyrk::python {

/// The flow W' = [B(W), W] on u(n) with B and H given as Python functions of a complex128 array of
/// shape (n, n).  Each call takes the GIL.  There is no B in split storage: published forms only.
class PythonFlow final : public Flow {
 public:
  /// `hamiltonian` may be None: H is then NaN.
  PythonFlow(Index n, pybind11::object generator, pybind11::object hamiltonian);
  ~PythonFlow() override;

  /// Throws pybind11::error_already_set for an exception of the function, and for a result that is
  /// not an array of shape (n, n) of numbers.
  void generator(const Matrix& W, Matrix& B) const override;
  double hamiltonian(const Matrix& W) const override;

 private:
  pybind11::object generator_;
  pybind11::object hamiltonian_;
};

}  // namespace isosyrk::python

// A flow whose generator B is a Python function.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>

#include "isosyrk/flows/flow.h"

namespace isosyrk::python {

/// The flow W' = [B(W), W] on u(n) with B given as a Python function of a complex128 array of shape
/// (n, n).  Each call takes the GIL.  There is no B in split storage: published forms only.
class PythonFlow final : public Flow {
 public:
  /// Borrows the function, which must outlive the flow: the Python half holds it, where the garbage
  /// collector sees cycles.  `size` is the Frobenius norm of states.
  PythonFlow(Index n, double size, pybind11::handle generator);

  /// W is projected onto u(n) by the caller, as Flow::generator has it.
  /// Throws pybind11::error_already_set for an exception of the function, and TypeError or
  /// ValueError for a result that is not a skew-Hermitian array of shape (n, n), to 1e-10 relative.
  /// A result that is not finite is passed on: the iteration then diverges.
  void generator(const Matrix& W, Matrix& B) const override;
  /// Returns NaN: energies are computed in Python.
  double hamiltonian(const Matrix& W) const override;
  bool has_quadratic_hamiltonian() const override { return false; }
  /// Returns whether the function is linear and self-adjoint to 1e-10 on seeded matrices of the
  /// given norm.  Three calls of the function the first time that this is asked, and none after
  /// that. Throws as generator().
  bool has_self_adjoint_generator() const override;

 private:
  bool is_self_adjoint_on_samples() const;

  double size_;
  pybind11::handle generator_;
  mutable std::optional<bool> is_self_adjoint_;
};

}  // namespace isosyrk::python

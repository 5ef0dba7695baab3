#include "python_flow.h"

#include <fmt/format.h>

#include <limits>
#include <random>
#include <string_view>

#include "arrays.h"
#include "isosyrk/linalg/spectrum.h"

namespace isosyrk::python {

namespace py = pybind11;

namespace {

// A skew-Hermitian matrix of this Frobenius norm, the same everywhere.
Matrix sample(Index n, double size, unsigned seed) {
  std::mt19937 numbers(seed);
  const auto next = [&] {
    return static_cast<double>(numbers()) / static_cast<double>(std::mt19937::max()) - 0.5;
  };
  Matrix X(n, n);
  for (Complex& entry : X.reshaped()) {
    const double re = next();
    entry = {re, next()};
  }
  const Matrix W = X - X.adjoint();
  return size / W.norm() * W;
}

// -tr(AB), for skew-Hermitian matrices.
double pairing(const Matrix& A, const Matrix& B) {
  return A.conjugate().cwiseProduct(B).sum().real();
}

}  // namespace

PythonFlow::PythonFlow(Index n, double size, py::handle generator)
    : Flow(QuadraticAlgebra::skew_hermitian(n)), size_(size), generator_(generator) {}

bool PythonFlow::has_self_adjoint_generator() const {
  if (!is_self_adjoint_) is_self_adjoint_ = is_self_adjoint_on_samples();
  return *is_self_adjoint_;
}

bool PythonFlow::is_self_adjoint_on_samples() const {
  constexpr double tolerance = 1e-10;
  const Index n = size();
  const Matrix A = sample(n, size_, 1), C = sample(n, size_, 2);
  const Matrix sum = 0.6 * A - 0.8 * C;
  Matrix BA(n, n), BC(n, n), B_of_sum(n, n);
  generator(A, BA);
  generator(C, BC);
  generator(sum, B_of_sum);
  // Norms that do not overflow, and A and C of norm 1 in the pairings: W may be of any norm.
  const double size_of_B = BA.stableNorm() + BC.stableNorm();
  const double not_linear = (B_of_sum - (0.6 * BA - 0.8 * BC)).stableNorm();
  const double not_adjoint = std::abs(pairing(A / size_, BC) - pairing(BA, C / size_));
  return not_linear <= tolerance * size_of_B && not_adjoint <= tolerance * size_of_B;
}

void PythonFlow::generator(const Matrix& W, Matrix& B) const {
  constexpr double largest_defect = 1e-10;
  const py::gil_scoped_acquire gil;
  const py::object result = generator_(copy_of(W));
  const auto found = py::array::ensure(result);
  const bool numbers =
      found && std::string_view("biufc").find(found.dtype().kind()) != std::string_view::npos;
  if (!numbers) {
    throw py::type_error(py::str("generator: returned a {}, must be an array of numbers")
                             .format(py::type::of(result).attr("__name__")));
  }
  if (found.ndim() != 2 || found.shape(0) != size() || found.shape(1) != size()) {
    throw py::value_error(py::str("generator: returned shape {}, must be ({}, {})")
                              .format(found.attr("shape"), size(), size()));
  }
  B = matrix_of(py::array_t<Complex, py::array::c_style | py::array::forcecast>(found));
  if (!B.allFinite()) return;
  const double defect = skew_defect(B) / B.cwiseAbs().maxCoeff();
  if (defect > largest_defect) {
    throw py::value_error(fmt::format(
        "generator: the largest entry of |B + B†| is {:.3g} of the largest of |B|; must "
        "be at most {:.0e} (skew-Hermitian)",
        defect, largest_defect));
  }
}

double PythonFlow::hamiltonian(const Matrix&) const {
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace isosyrk::python

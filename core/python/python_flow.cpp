#include "python_flow.h"

#include <fmt/format.h>

#include <limits>
#include <string_view>

#include "arrays.h"
#include "isosyrk/linalg/spectrum.h"

namespace isosyrk::python {

namespace py = pybind11;

PythonFlow::PythonFlow(Index n, py::handle generator)
    : Flow(QuadraticAlgebra::skew_hermitian(n)), generator_(generator) {}

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

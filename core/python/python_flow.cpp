#include "python_flow.h"

#include <pybind11/complex.h>
#include <pybind11/numpy.h>

#include <limits>

#include "arrays.h"

namespace isosyrk::python {

namespace py = pybind11;

PythonFlow::PythonFlow(Index n, py::object generator, py::object hamiltonian)
    : Flow(QuadraticAlgebra::skew_hermitian(n)),
      generator_(std::move(generator)),
      hamiltonian_(std::move(hamiltonian)) {}

PythonFlow::~PythonFlow() {
  const py::gil_scoped_acquire gil;
  generator_ = {};
  hamiltonian_ = {};
}

void PythonFlow::generator(const Matrix& W, Matrix& B) const {
  const py::gil_scoped_acquire gil;
  const py::object result = generator_(copy_of(W));
  const auto array =
      py::array_t<Complex, py::array::c_style | py::array::forcecast>::ensure(result);
  if (!array) {
    throw py::type_error(py::str("generator: returned a {}, must be an array of numbers")
                             .format(py::type::of(result).attr("__name__")));
  }
  if (array.ndim() != 2 || array.shape(0) != size() || array.shape(1) != size()) {
    py::list shape;
    for (py::ssize_t k = 0; k < array.ndim(); ++k) shape.append(array.shape(k));
    throw py::value_error(py::str("generator: returned shape {}, must be ({}, {})")
                              .format(py::tuple(shape), size(), size()));
  }
  B = Eigen::Map<const Matrix>(array.data(), size(), size());
}

double PythonFlow::hamiltonian(const Matrix& W) const {
  const py::gil_scoped_acquire gil;
  if (hamiltonian_.is_none()) return std::numeric_limits<double>::quiet_NaN();
  return hamiltonian_(copy_of(W)).cast<double>();
}

}  // namespace isosyrk::python

// The NumPy module's extension that measures: the conditions of a measurement, and product rates.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "benchmarks/conditions.h"
#include "core/python/blas_threads.h"
#include "isosyrk/catalogue/solver.h"

namespace isosyrk::python {
namespace {

namespace py = pybind11;

/// Lets other threads run Python meanwhile.
using Aside = py::call_guard<py::gil_scoped_release, OneBlasThread>;

Conditions conditions(const std::string& products, const std::vector<Index>& sizes) {
  const BackendChoice choice = backend_choice_from_name(products);
  std::vector<BackendRates> rates;
  for (const Index n : sizes) rates.push_back(choose_backend(choice, n));
  return machine_conditions("python module", choice, rates);
}

ProductBackend fastest_products(Index n) { return choose_backend({}, n).chosen; }

double rate_of(Index n, const std::string& solver) {
  constexpr double seconds = 0.05;
  return solver_from_name(solver) == Solver::fast ? split_product_rate(n, seconds)
                                                  : product_rate(fastest_products(n), n, seconds);
}

}  // namespace

PYBIND11_MODULE(_conditions, module) {
  module.def("conditions", &conditions, Aside());
  module.def("product_rate", &rate_of, Aside());
  module.def(
      "fastest_products", [](Index n) { return name(fastest_products(n)); }, Aside());
}

}  // namespace isosyrk::python

// How fast matrix products are here, measured.
#pragma once

#include <optional>
#include <vector>

#include "isosyrk/linalg/products.h"

namespace isosyrk {

/// The backend a user asked for; none means the faster one by measurement.
using BackendChoice = std::optional<ProductBackend>;

/// Returns the choice with this name, "fastest" or that of a backend.  Throws
/// std::invalid_argument, naming all names, for another one.
BackendChoice backend_choice_from_name(std::string_view name);

/// Products of n x n matrices per second of CPU time: the median over blocks that take about
/// `seconds` together, of one product repeated, with operands in the fastest cache that holds them.
double product_rate(ProductBackend backend, Index n, double seconds);

/// The same of split products, with the kernel of split_products.h that runs here.
double split_product_rate(Index n, double seconds);

/// Rates of every backend at one n, measured in turn, and the one chosen.
struct BackendRates {
  Index n = 0;                ///< size measured at
  std::vector<double> rates;  ///< products per second, in the order of product_backends()
  ProductBackend chosen = ProductBackend::openblas;
};

/// Measures every backend at n, or at 257 for larger n (where the order no longer changes), and
/// takes the choice, or else the fastest.
BackendRates choose_backend(BackendChoice choice, Index n);

/// Keeps BLAS to one thread, as every benchmark here wants that is not about threads.
void use_one_blas_thread();

}  // namespace isosyrk

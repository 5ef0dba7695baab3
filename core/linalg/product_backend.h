// The backends for products of complex matrices.
#pragma once

#include <string_view>
#include <vector>

namespace isosyrk {

/// The library whose kernels form a product.
enum class ProductBackend {
  openblas,  ///< cblas_zgemm
  eigen,     ///< Eigen's complex kernels, without Eigen's dispatch to a BLAS
};

/// Returns all backends, in the order in which a user sees them.
const std::vector<ProductBackend>& product_backends();

/// Returns "openblas" or "eigen".
std::string_view name(ProductBackend backend);

}  // namespace isosyrk

// The kernels that a matrix product can be formed with.
#pragma once

#include <string_view>
#include <vector>

namespace isosyrk {

/// Whose kernels form a product.
enum class ProductBackend {
  openblas,  ///< cblas_zgemm
  eigen,     ///< Eigen's own complex kernels, without its dispatch to a BLAS
};

/// All backends, in the order in which they are listed to a user.
const std::vector<ProductBackend>& product_backends();

/// "openblas", "eigen".
std::string_view name(ProductBackend backend);

}  // namespace isosyrk

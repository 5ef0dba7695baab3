// Interface of the GEMM kernels for split-complex matrices, one kernel set for each vector unit.
//
// The kernel sources are compiled for different vector units. An inline function emitted by two of
// them would be merged by the linker, and the surviving copy might not run on this processor.
// Therefore this header includes no header that defines functions, and its own function is always
// inlined.
#pragma once

#include <cstddef>

namespace isosyrk {

/// Largest n at which the kernels read a factor in place. Beyond it the factor is packed.
struct PackingLimits {
  std::ptrdiff_t B;
  std::ptrdiff_t adjoint_A;  ///< applies only where B is packed
};

/// The product C = scale A B or C = scale A† B of n x n matrices, Real double or float.
///
/// Split-complex storage: each row holds its real parts, then its imaginary parts. Rows are
/// `stride` numbers apart. Each half of a row has `stride` / 2 numbers, at least n and a multiple
/// of 64 bytes. The numbers from n on are padding; they are 0 and stay 0.
///
/// A call forms a range of rows of C. Each entry is the same bit for bit whatever the range.
template <class Real>
struct SplitProduct {
  std::ptrdiff_t n;
  std::ptrdiff_t stride;
  const Real* A_re;
  const Real* A_im;
  bool adjoint;  ///< A† in place of A
  const Real* B_re;
  const Real* B_im;
  Real scale;
  Real* C_re;
  Real* C_im;
  bool upper;  ///< only the upper triangle of C is needed; entries below it are unspecified
  std::ptrdiff_t A_band;  ///< A(r, c) = 0 where |r - c| > A_band; n - 1 for a full matrix
  std::ptrdiff_t B_band;  ///< the same bound for B
  std::ptrdiff_t C_band;  ///< only |r - c| <= C_band is needed; entries beyond are unspecified
  Real* packed_B;         ///< n * stride numbers, or null where B is read in place
  bool packs_adjoint_A;   ///< only if B is packed
  bool is_B_near;         ///< the packed B stays in the caches of a processor
};

/// Rows of C that share each packed panel of a B that is not near, a multiple of every tile's.
constexpr std::ptrdiff_t rows_together = 24;

/// Workspace of a range of rows, in numbers: three columns, and the packed rows of A†.
[[gnu::always_inline]] constexpr std::ptrdiff_t gemm_scratch(std::ptrdiff_t n,
                                                             std::ptrdiff_t stride) {
  return 3 * stride / 2 + 2 * rows_together * n;
}

/// Forms rows first ... end - 1 of C, from the packed B if there is one.  `scratch` has
/// gemm_scratch(n, stride) numbers, which no other call uses meanwhile.
template <class Real>
using FormRows = void (*)(const SplitProduct<Real>&, std::ptrdiff_t first, std::ptrdiff_t end,
                          Real* scratch);
/// Packs the panels of B that begin at the columns first ... end - 1.
template <class Real>
using PackColumns = void (*)(const SplitProduct<Real>&, std::ptrdiff_t first, std::ptrdiff_t end);

/// The kernels of one vector unit in one precision.
template <class Real>
struct GemmFunctions {
  FormRows<Real> form;
  PackColumns<Real> pack;
  PackingLimits limits;  ///< tuned by timing
};

/// The kernels of one vector unit.
struct GemmKernel {
  const char* name;  ///< "avx512", "avx2", "portable"
  GemmFunctions<double> doubles;
  GemmFunctions<float> singles;
};

GemmKernel gemm_kernel_avx512();
GemmKernel gemm_kernel_avx2();
GemmKernel gemm_kernel_portable();

}  // namespace isosyrk

// The inner loops of products of planar matrices, once for each vector unit.
//
// No header with functions in it is included here, and what is here is evaluated by the compiler:
// the files that include this one are compiled for different units, and the linker takes any of the
// copies of an inline function.
#pragma once

#include <cstddef>

namespace isosyrk {

/// The largest n for which factors are read where they stand; those of larger ones are copied
/// together first.
struct PackingLimits {
  std::ptrdiff_t B;
  std::ptrdiff_t adjoint_A;  ///< where B is copied
};

/// C = scale A B, or scale A† B, all n x n, their rows `stride` numbers apart: real parts in the
/// first half of each, imaginary parts in the second, a multiple of 64 bytes that is at least n
/// long; what fills the halves up is 0 and stays so.  Real is double or float.
template <class Real>
struct SplitProduct {
  std::ptrdiff_t n;
  std::ptrdiff_t stride;
  const Real* A_re;
  const Real* A_im;
  bool adjoint;
  const Real* B_re;
  const Real* B_im;
  Real scale;
  Real* C_re;
  Real* C_im;
  bool upper;  ///< only what lies on and above the diagonal is wanted; below it anything may be
  std::ptrdiff_t A_band;  ///< entries (r, c) of A with |r - c| > A_band are 0; n - 1 for the whole
  std::ptrdiff_t B_band;
  std::ptrdiff_t C_band;  ///< only |r - c| <= C_band is wanted; beyond it anything may be
  std::ptrdiff_t part;  ///< of the rows of C this share is formed, part of `parts` with equal work
  std::ptrdiff_t parts;
  bool copies_B;
  bool copies_adjoint_A;  ///< if it copies B
  Real* scratch;          ///< gemm_scratch(n, stride, copies_B) numbers
};

/// Numbers of workspace that a product takes: three columns, the copy of B, and rows of A.
constexpr std::ptrdiff_t gemm_scratch(std::ptrdiff_t n, std::ptrdiff_t stride, bool copies_B) {
  return 3 * stride / 2 + (copies_B ? n * stride + 12 * n : 0);
}

/// The kernels of one vector unit.
struct GemmKernel {
  const char* name;  ///< "avx512", "avx2", "portable"
  void (*multiply)(const SplitProduct<double>&);
  void (*multiply_singles)(const SplitProduct<float>&);
  PackingLimits limits;  ///< measured, as the others
  PackingLimits single_limits;
};

GemmKernel gemm_kernel_avx512();
GemmKernel gemm_kernel_avx2();
GemmKernel gemm_kernel_portable();

}  // namespace isosyrk

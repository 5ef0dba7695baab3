// The inner loops of products of planar matrices, once for each vector unit.
//
// No header with functions in it is included here, and what is here is evaluated by the compiler:
// the files that include this one are compiled for different units, and the linker takes any of the
// copies of an inline function.
#pragma once

#include <cstddef>

namespace isosyrk {

/// Up to here B is read where it stands, for larger n from a copy (measured).
template <class Real>
constexpr std::ptrdiff_t planar_largest_in_place = sizeof(Real) == sizeof(float) ? 104 : 72;

/// C = scale A B, or scale A† B, all n x n, as planes whose rows are `stride` numbers apart, a
/// multiple of 64 bytes that is at least n; what fills the rows up is 0 and stays so.  Real is
/// double or float.
template <class Real>
struct PlanarProduct {
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
  std::ptrdiff_t C_band;     ///< only |r - c| <= C_band is wanted; beyond it anything may be
  std::ptrdiff_t first_row;  ///< of those of C that are formed
  std::ptrdiff_t end_row;
  Real* scratch;  ///< planar_scratch(n, stride) numbers
};

/// Numbers of workspace that a product takes: two columns, the copy of B, and rows of A.
template <class Real>
constexpr std::ptrdiff_t planar_scratch(std::ptrdiff_t n, std::ptrdiff_t stride) {
  return 2 * stride + (n > planar_largest_in_place<Real> ? 2 * n * stride + 12 * n : 0);
}

/// The kernels of one vector unit.
struct PlanarKernel {
  const char* name;  ///< "avx512", "avx2", "portable"
  void (*multiply)(const PlanarProduct<double>&);
  void (*multiply_singles)(const PlanarProduct<float>&);
};

PlanarKernel planar_kernel_avx512();
PlanarKernel planar_kernel_avx2();
PlanarKernel planar_kernel_portable();

}  // namespace isosyrk

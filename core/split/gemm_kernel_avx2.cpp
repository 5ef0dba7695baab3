// Intrinsics are always inlined. The linker sees no copy of them to merge between vector units.
#include <immintrin.h>

#include "isosyrk/split/gemm_kernel.h"

namespace isosyrk {
namespace {
constexpr int vector_bytes = 32;
constexpr int tile_rows = 6;
constexpr int tile_vectors = 1;

inline __m256d half_twice(const double* at) {
  return _mm256_broadcast_pd(reinterpret_cast<const __m128d*>(at));
}
inline __m256 half_twice(const float* at) {
  return _mm256_broadcast_ps(reinterpret_cast<const __m128*>(at));
}
}  // namespace
}  // namespace isosyrk

#include "isosyrk/split/gemm_macro_kernel.h"

namespace isosyrk {

GemmKernel gemm_kernel_avx2() {
  return {"avx2",
          {form_rows<double>, pack_columns<double>, {72, 160}},
          {form_rows<float>, pack_columns<float>, {104, 160}}};
}

}  // namespace isosyrk

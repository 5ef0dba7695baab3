// Intrinsics are always inlined. The linker sees no copy of them to merge between vector units.
#include <immintrin.h>

#include "isosyrk/split/gemm_kernel.h"

namespace isosyrk {
namespace {
constexpr int vector_bytes = 64;
constexpr int tile_rows = 6;
constexpr int tile_vectors = 2;

inline __m512d half_twice(const double* at) { return _mm512_broadcast_f64x4(_mm256_loadu_pd(at)); }
inline __m512 half_twice(const float* at) {
  return _mm512_castpd_ps(_mm512_broadcast_f64x4(_mm256_castps_pd(_mm256_loadu_ps(at))));
}
}  // namespace
}  // namespace isosyrk

#include "isosyrk/split/gemm_macro_kernel.h"

namespace isosyrk {

GemmKernel gemm_kernel_avx512() {
  return {"avx512",
          {form_rows<double>, pack_columns<double>, {200, 200}},
          {form_rows<float>, pack_columns<float>, {400, 400}}};
}

}  // namespace isosyrk

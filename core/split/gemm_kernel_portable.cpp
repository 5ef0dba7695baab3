#include "isosyrk/split/gemm_kernel.h"

namespace isosyrk {
namespace {
constexpr int vector_bytes = 16;
constexpr int tile_rows = 4;
constexpr int tile_vectors = 1;

typedef double TwoDoubles __attribute__((vector_size(16), aligned(8)));
typedef float FourFloats __attribute__((vector_size(16), aligned(4)));

inline TwoDoubles half_twice(const double* at) { return TwoDoubles{at[0], at[0]}; }
inline FourFloats half_twice(const float* at) { return FourFloats{at[0], at[1], at[0], at[1]}; }
}  // namespace
}  // namespace isosyrk

#include "isosyrk/split/gemm_macro_kernel.h"

namespace isosyrk {

GemmKernel gemm_kernel_portable() {
  return {"portable",
          {form_rows<double>, pack_columns<double>, {72, 160}},
          {form_rows<float>, pack_columns<float>, {104, 160}}};
}

}  // namespace isosyrk

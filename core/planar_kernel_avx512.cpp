#include "core/planar_kernel.h"

namespace isosyrk {
namespace {
constexpr int vector_bytes = 64;
constexpr int tile_rows = 6;
constexpr int tile_vectors = 2;
}  // namespace
}  // namespace isosyrk

#include "core/planar_kernel_tiles.h"

namespace isosyrk {

PlanarKernel planar_kernel_avx512() {
  return {"avx512", multiply_planar<double>, multiply_planar<float>, {200, 200}, {400, 400}};
}

}  // namespace isosyrk

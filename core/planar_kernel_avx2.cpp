#include "core/planar_kernel.h"

namespace isosyrk {
namespace {
constexpr int vector_bytes = 32;
constexpr int tile_rows = 6;
constexpr int tile_vectors = 1;
}  // namespace
}  // namespace isosyrk

#include "core/planar_kernel_tiles.h"

namespace isosyrk {

PlanarKernel planar_kernel_avx2() {
  return {"avx2", multiply_planar<double>, multiply_planar<float>, {72, 160}, {104, 160}};
}

}  // namespace isosyrk

// A method of the user's, that of core/README.md: its order, and that it keeps the spectrum, with
// real and with complex matrices.
#include <isosyrk/linalg/spectrum.h>
#include <isosyrk/scenes/euler_zeitlin_scenes.h>
#include <isosyrk/scenes/scene_list.h>
#include <isosyrk/simulation/run.h>

#include <cmath>
#include <cstdio>

#include "cayley_midpoint.h"

using isosyrk::Matrix;

namespace {

bool keeps_the_spectrum_and_has_order_2(const isosyrk::Scene& scene) {
  const auto at_one = [&](long steps) {
    const auto method = isosyrk::make_in_arithmetic_of<isosyrk::CayleyMidpoint>(
        scene.flow, isosyrk::IterationOptions{}, isosyrk::ProductBackend::openblas);
    Matrix W = scene.initial;
    if (!isosyrk::run(*method, W, 1.0 / static_cast<double>(steps), steps).converged()) W.setZero();
    return W;
  };
  const Matrix coarse = at_one(10), medium = at_one(20), fine = at_one(40);
  const double order = std::log2((coarse - medium).norm() / (medium - fine).norm());
  // 40 steps of tolerance 1e-13, and a margin of 10.
  return std::abs(order - 2.0) < 0.1 && isosyrk::spectrum_error(fine, scene.initial) < 4e-11;
}

}  // namespace

int main() {
  const bool both = keeps_the_spectrum_and_has_order_2(isosyrk::smooth_scene(9)) &&
                    keeps_the_spectrum_and_has_order_2(isosyrk::scene_by_name("rigid_body", 6));
  std::printf("%s\n", both ? "order 2" : "another order");
  return 0;
}

#include "isosyrk/fast/exponential_step.h"

#include <cmath>

#include "isosyrk/solver/tuning.h"

namespace isosyrk {

void ExponentialStep::bind(const SplitMatrix& state, double step, double to_tolerance,
                           ExponentialMemory& of_steps, SplitOperations& operations) {
  W0 = &state;
  h = step;
  tolerance = to_tolerance;
  memory = &of_steps;
  size_of_W0 = norm(state);
  rotation = std::abs(h) * operations.generator.rotation_left_out(state);
  least_unit = least_unit_of_exponent(rotation, tolerance);
  round_to_single(W0_single, state);
  operations.bands.truncate_symmetric_to_part(W0_single, tuning.single_roundoff);
}

}  // namespace isosyrk

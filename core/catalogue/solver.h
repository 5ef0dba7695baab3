// The two implementations of an integrator.
#pragma once

#include <string_view>

namespace isosyrk {

/// Implementation of an integrator.  Both give the same answer to the tolerance.
enum class Solver {
  published,  ///< the published equations, solved by Picard sweeps
  fast,       ///< predictor, inexact Newton, band truncation, split-complex storage
};

/// Returns "published" or "fast".
std::string_view name(Solver solver);
/// Returns the solver with this name.  Throws std::invalid_argument, naming both names, for another
/// one.
Solver solver_from_name(std::string_view name);

}  // namespace isosyrk

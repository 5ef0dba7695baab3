// Makes an integrator by its name.
#pragma once

#include <memory>
#include <string_view>

#include "isosyrk/integrators/integrator.h"

namespace isosyrk {

/// Implementation of an integrator.  Both give the same answer to the tolerance.
enum class Solver {
  published,  ///< the published equations, solved by Picard sweeps
  fast,       ///< predictor, inexact Newton, band truncation, split-complex storage
};

/// Options of an integrator.
struct IntegratorOptions {
  Solver solver = Solver::published;
  SolverOptions iteration = {};
  int threads = 1;  ///< 1 if published, 1 to 64 if fast
};

/// Returns the integrator with this name of integrators(), such as "group2", or a published control
/// (two_products_entry).  The integrator
/// shares the flow.  Throws std::invalid_argument for a null flow, for a name that is not in the
/// list, for a fast form that the integrator or the flow does not have, and for a number of threads
/// out of range.
std::unique_ptr<Integrator> make_integrator(const SharedFlow& flow, std::string_view name,
                                            const IntegratorOptions& options = {});

}  // namespace isosyrk

// Makes an integrator by its name.
#pragma once

#include <memory>
#include <string_view>

#include "isosyrk/catalogue/solver.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/iteration/iteration_options.h"

namespace isosyrk {

/// Options of an integrator.
struct IntegratorOptions {
  Solver solver = Solver::published;
  IterationOptions iteration = {};
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

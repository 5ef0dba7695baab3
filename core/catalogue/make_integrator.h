// An integrator by its name: what a user of the library asks for.
#pragma once

#include <memory>
#include <string_view>

#include "isosyrk/integrators/integrator.h"

namespace isosyrk {

/// Which implementation of an integrator: the same answer to the tolerance.
enum class Solver {
  published,  ///< as its equations read
  fast,       ///< with start values, Newton corrections and split-complex storage
};

/// What else an integrator is made with.
struct IntegratorOptions {
  Solver solver = Solver::published;
  SolverOptions iteration = {};
  int threads = 1;  ///< of a fast integrator
};

/// The integrator of the list with this name, such as "group2"; integrators() lists them all.
/// `flow` must outlive it.  Throws std::invalid_argument for a name that is not in the list, for a
/// fast form where the integrator has none, and for a number of threads that is not allowed.
std::unique_ptr<Integrator> make_integrator(const Flow& flow, std::string_view name,
                                            const IntegratorOptions& options = {});

}  // namespace isosyrk

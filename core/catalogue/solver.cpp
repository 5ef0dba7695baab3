#include "isosyrk/catalogue/solver.h"

#include <fmt/format.h>

#include <stdexcept>

namespace isosyrk {

std::string_view name(Solver solver) { return solver == Solver::fast ? "fast" : "published"; }

Solver solver_from_name(std::string_view wanted) {
  for (const Solver solver : {Solver::published, Solver::fast}) {
    if (name(solver) == wanted) return solver;
  }
  throw std::invalid_argument(fmt::format("solver '{}': must be published or fast", wanted));
}

}  // namespace isosyrk

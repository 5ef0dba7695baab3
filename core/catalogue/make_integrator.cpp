#include "isosyrk/catalogue/make_integrator.h"

#include <fmt/format.h>

#include <stdexcept>

#include "isosyrk/catalogue/fast_forms.h"

namespace isosyrk {

std::unique_ptr<Integrator> make_integrator(const SharedFlow& flow, std::string_view wanted,
                                            const IntegratorOptions& options) {
  constexpr ProductBackend backend = ProductBackend::openblas;
  if (flow == nullptr) throw std::invalid_argument("integrator: flow is null");
  const IntegratorEntry entry =
      integrator_entry(wanted, options.solver, {.threads = options.threads});
  if (options.solver == Solver::published && options.threads != 1) {
    throw std::invalid_argument(
        fmt::format("threads {}: published integrators have 1 thread", options.threads));
  }
  return entry.make(flow, options.iteration, backend);
}

}  // namespace isosyrk

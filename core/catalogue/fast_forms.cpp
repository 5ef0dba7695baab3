#include "isosyrk/catalogue/fast_forms.h"

#include <fmt/format.h>

#include "isosyrk/catalogue/workspace_bytes.h"
#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/fast/fast_algebra.h"
#include "isosyrk/fast/fast_cotangent.h"
#include "isosyrk/fast/fast_group.h"
#include "isosyrk/fast/fast_midpoint.h"
#include "isosyrk/tableaux/gauss_tableau.h"

namespace isosyrk {

std::unique_ptr<Integrator> make_fast_gauss(Formulation formulation, int s, const Flow& flow,
                                            const FastOptions& options, ProductBackend backend) {
  const auto* euler_zeitlin = dynamic_cast<const EulerZeitlin*>(&flow);
  if (euler_zeitlin == nullptr) {
    return gauss_entry(formulation, s).make(flow, options.solver, backend);
  }
  const Tableau tableau = gauss_tableau(s);
  switch (formulation) {
    case Formulation::cotangent:
      return std::make_unique<FastCotangent>(*euler_zeitlin, tableau, options);
    case Formulation::group:
      return std::make_unique<FastGroup>(*euler_zeitlin, tableau, options);
    case Formulation::algebra:
      break;
  }
  if (s == 1) return std::make_unique<FastMidpoint>(*euler_zeitlin, options);
  return std::make_unique<FastAlgebra>(*euler_zeitlin, tableau, options);
}

IntegratorEntry fast_gauss_entry(Formulation formulation, int s) {
  IntegratorEntry entry = gauss_entry(formulation, s);
  entry.name = fmt::format("fast_{}", entry.name);
  entry.make = [formulation, s](const Flow& flow, const SolverOptions& solver,
                                ProductBackend backend) {
    return make_fast_gauss(formulation, s, flow, {.solver = solver}, backend);
  };
  entry.bytes = [formulation, s](Index n) {
    return fast_workspace_bytes(formulation, s, n, default_start_order(n));
  };
  return entry;
}

}  // namespace isosyrk

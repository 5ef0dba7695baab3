#include "isosyrk/integrators/formulation.h"

#include <fmt/format.h>

#include <stdexcept>

#include "isosyrk/integrators/algebra_form.h"
#include "isosyrk/integrators/cotangent_form.h"
#include "isosyrk/integrators/group_form.h"
#include "isosyrk/integrators/isospectral_midpoint.h"

namespace isosyrk {

const std::vector<Formulation>& formulations() {
  static const std::vector<Formulation> all = {Formulation::cotangent, Formulation::group,
                                               Formulation::algebra};
  return all;
}

std::string_view name(Formulation formulation) {
  switch (formulation) {
    case Formulation::cotangent:
      return "cotangent";
    case Formulation::group:
      return "group";
    case Formulation::algebra:
      return "algebra";
  }
  return "unknown";
}

Formulation formulation_from_name(std::string_view wanted) {
  for (const Formulation formulation : formulations()) {
    if (name(formulation) == wanted) return formulation;
  }
  throw std::invalid_argument(
      fmt::format("formulation '{}': must be cotangent, group or algebra", wanted));
}

std::unique_ptr<Integrator> make_formulation(Formulation formulation, const Flow& flow,
                                             const Tableau& tableau, const SolverOptions& options,
                                             ProductBackend backend) {
  switch (formulation) {
    case Formulation::cotangent:
      return std::make_unique<CotangentForm>(flow, tableau, options, backend);
    case Formulation::group:
      return std::make_unique<GroupForm>(flow, tableau, options, backend);
    case Formulation::algebra:
      require_consistent(tableau);
      if (tableau.stages() == 1 && tableau.a(0, 0) == 0.5 && tableau.b(0) == 1.0) {  // the midpoint
        return std::make_unique<IsospectralMidpoint>(flow, options, backend);
      }
      return std::make_unique<AlgebraForm>(flow, tableau, options, backend);
  }
  throw std::invalid_argument("make_formulation: unknown formulation");
}

}  // namespace isosyrk

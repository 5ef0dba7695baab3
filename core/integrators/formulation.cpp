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

template <class Scalar>
std::unique_ptr<IntegratorIn<Scalar>> make_formulation_in(Formulation formulation,
                                                          SharedFlowIn<Scalar> flow,
                                                          const Tableau& tableau,
                                                          const IterationOptions& options,
                                                          ProductBackend backend) {
  switch (formulation) {
    case Formulation::cotangent:
      return std::make_unique<CotangentForm<Scalar>>(std::move(flow), tableau, options, backend);
    case Formulation::group:
      return std::make_unique<GroupForm<Scalar>>(std::move(flow), tableau, options, backend);
    case Formulation::algebra:
      require_consistent(tableau);
      if (tableau.stages() == 1 && tableau.a(0, 0) == 0.5 && tableau.b(0) == 1.0) {  // the midpoint
        return std::make_unique<IsospectralMidpoint<Scalar>>(std::move(flow), options, backend);
      }
      return std::make_unique<AlgebraForm<Scalar>>(std::move(flow), tableau, options, backend);
  }
  throw std::invalid_argument("make_formulation: unknown formulation");
}

template std::unique_ptr<IntegratorIn<double>> make_formulation_in<double>(
    Formulation, SharedFlowIn<double>, const Tableau&, const IterationOptions&, ProductBackend);
template std::unique_ptr<IntegratorIn<Complex>> make_formulation_in<Complex>(
    Formulation, SharedFlowIn<Complex>, const Tableau&, const IterationOptions&, ProductBackend);

std::unique_ptr<Integrator> make_formulation(Formulation formulation, const SharedFlow& flow,
                                             const Tableau& tableau,
                                             const IterationOptions& options,
                                             ProductBackend backend) {
  if (const auto real_flow = std::dynamic_pointer_cast<const RealFlow>(flow)) {
    return make_formulation_in<double>(formulation, real_flow, tableau, options, backend);
  }
  return make_formulation_in<Complex>(formulation, flow, tableau, options, backend);
}

}  // namespace isosyrk

#include "isosyrk/catalogue/fast_forms.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "isosyrk/catalogue/workspace_bytes.h"
#include "isosyrk/fast/algebra_system.h"
#include "isosyrk/fast/cotangent_system.h"
#include "isosyrk/fast/fast_integrator.h"
#include "isosyrk/fast/group_system.h"
#include "isosyrk/fast/midpoint_system.h"
#include "isosyrk/tableaux/gauss_tableau.h"

namespace isosyrk {
namespace {

std::unique_ptr<StageSystem> gauss_system(Formulation formulation, int s, const Flow& flow,
                                          int threads, bool truncates) {
  const Tableau tableau = gauss_tableau(s);
  switch (formulation) {
    case Formulation::cotangent:
      return std::make_unique<CotangentSystem>(flow, tableau, threads, truncates);
    case Formulation::group:
      return std::make_unique<GroupSystem>(flow, tableau, threads, truncates);
    case Formulation::algebra:
      break;
  }
  if (s == 1) return std::make_unique<MidpointSystem>(flow, threads, truncates);
  return std::make_unique<AlgebraSystem>(flow, tableau, threads, truncates);
}

// Returns the formulation of the listed integrator with this name, if it has one.
std::optional<Formulation> formulation_of(std::string_view wanted) {
  const IntegratorEntry& entry = integrator_entry(wanted);
  for (const Formulation formulation : formulations()) {
    if (fmt::format("{}{}", name(formulation), entry.stages) == entry.name) return formulation;
  }
  return {};
}

}  // namespace

std::unique_ptr<Integrator> make_fast_gauss(Formulation formulation, int s, const Flow& flow,
                                            const FastOptions& options) {
  FastOptions chosen = options;
  ThreadScope::checked(options.threads);
  const Index n = flow.size();
  if (n < tuning.smallest_parallel(s)) chosen.threads = std::min(chosen.threads, 1);
  return std::make_unique<FastIntegrator>(
      flow,
      gauss_system(formulation, s, flow, chosen.threads,
                   options.bands.value_or(n >= tuning.smallest_banded)),
      chosen);
}

IntegratorEntry fast_gauss_entry(Formulation formulation, int s, const FastOptions& options) {
  IntegratorEntry entry = gauss_entry(formulation, s);
  entry.name = fmt::format("fast_{}", entry.name);
  entry.make = [formulation, s, options](const Flow& flow, const SolverOptions& solver,
                                         ProductBackend) {
    FastOptions chosen = options;
    chosen.solver = solver;
    return make_fast_gauss(formulation, s, flow, chosen);
  };
  entry.bytes = [formulation, s, options](Index n) {
    return fast_workspace_bytes(formulation, s, n,
                                options.past_steps.value_or(tuning.past_steps(n)), options.threads);
  };
  return entry;
}

bool has_fast_form(std::string_view wanted) { return formulation_of(wanted).has_value(); }

IntegratorEntry fast_entry(std::string_view wanted, const FastOptions& options) {
  const std::optional<Formulation> formulation = formulation_of(wanted);
  if (!formulation) {
    throw std::invalid_argument(fmt::format(
        "integrator '{}': has no fast form; must be cotangent, group or algebra with its stages",
        wanted));
  }
  return fast_gauss_entry(*formulation, integrator_entry(wanted).stages, options);
}

}  // namespace isosyrk

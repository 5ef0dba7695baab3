#include "isosyrk/catalogue/fast_forms.h"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "isosyrk/catalogue/workspace_bytes.h"
#include "isosyrk/fast/algebra_system.h"
#include "isosyrk/fast/cotangent_system.h"
#include "isosyrk/fast/direct_system.h"
#include "isosyrk/fast/fast_explicit.h"
#include "isosyrk/fast/fast_integrator.h"
#include "isosyrk/fast/group_system.h"
#include "isosyrk/fast/midpoint_system.h"
#include "isosyrk/tableaux/composition_schemes.h"
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

// Returns the options with one thread below what pays, and whether bands are truncated.
std::pair<FastOptions, bool> chosen_for(const Flow& flow, int s, const FastOptions& options) {
  ThreadScope::checked(options.threads);
  const Index n = flow.size();
  FastOptions chosen = options;
  if (n < tuning.smallest_parallel(s)) chosen.threads = 1;
  return {chosen, options.bands.value_or(n >= tuning.smallest_banded)};
}

// A fast form: how it is made, and what it holds.  A composition holds it once for each substep.
struct FastForm {
  std::function<std::unique_ptr<Integrator>(const Flow&, const FastOptions&)> make;
  FastMatrices matrices;
  std::size_t substeps = 1;
};

FastForm gauss_form(Formulation formulation, int s) {
  return {[=](const Flow& flow, const FastOptions& options) {
            return make_fast_gauss(formulation, s, flow, options);
          },
          fast_gauss_matrices(formulation, s)};
}

// A composition of midpoint steps, with a predictor for each substep.
FastForm composition_form(const CompositionScheme& scheme) {
  return {[=](const Flow& flow, const FastOptions& options) -> std::unique_ptr<Integrator> {
            const auto [chosen, truncates] = chosen_for(flow, 1, options);
            std::vector<std::unique_ptr<StageSystem>> systems;
            for (std::size_t k = 0; k < scheme.fractions.size(); ++k) {
              systems.push_back(std::make_unique<MidpointSystem>(flow, chosen.threads, truncates));
            }
            return std::make_unique<FastIntegrator>(flow, std::move(systems), scheme.fractions,
                                                    chosen);
          },
          fast_gauss_matrices(Formulation::algebra, 1), scheme.fractions.size()};
}

FastForm direct_form(int s) {
  return {[=](const Flow& flow, const FastOptions& options) -> std::unique_ptr<Integrator> {
            const auto [chosen, truncates] = chosen_for(flow, s, options);
            return std::make_unique<FastIntegrator>(
                flow,
                std::make_unique<DirectSystem>(flow, gauss_tableau(s), chosen.threads, truncates),
                chosen);
          },
          {1.0 * s, 3.0 * s, 5.0 * s}};
}

template <class Method>
FastForm explicit_form() {
  return {[](const Flow& flow, const FastOptions& options) -> std::unique_ptr<Integrator> {
            const auto [chosen, truncates] = chosen_for(flow, 1, options);
            return std::make_unique<Method>(flow, chosen, truncates);
          },
          Method::matrices()};
}

// Returns the fast form of a listed integrator.
std::optional<FastForm> form_of(const IntegratorEntry& entry) {
  for (const Formulation formulation : formulations()) {
    if (fmt::format("{}{}", name(formulation), entry.stages) == entry.name)
      return gauss_form(formulation, entry.stages);
  }
  for (const CompositionScheme& scheme : {yoshida4(), suzuki4(), kahan_li6()}) {
    if (scheme.name == entry.name) return composition_form(scheme);
  }
  if (fmt::format("direct{}", entry.stages) == entry.name) return direct_form(entry.stages);
  if (entry.name == "rk4") return explicit_form<FastRungeKutta4>();
  if (entry.name == "rkmk4") return explicit_form<FastMuntheKaas4>();
  return {};  // a control
}

IntegratorEntry entry_of(IntegratorEntry entry, const FastForm& form, const FastOptions& options) {
  entry.name = fmt::format("fast_{}", entry.name);
  entry.make = [form, options](const Flow& flow, const SolverOptions& solver, ProductBackend) {
    FastOptions chosen = options;
    chosen.solver = solver;
    return form.make(flow, chosen);
  };
  entry.bytes = [form, options](Index n) {
    const int past_steps = options.past_steps.value_or(tuning.past_steps(n));
    return static_cast<double>(form.substeps) *
           fast_workspace_bytes(form.matrices, n, past_steps, options.threads);
  };
  return entry;
}

}  // namespace

std::unique_ptr<Integrator> make_fast_gauss(Formulation formulation, int s, const Flow& flow,
                                            const FastOptions& options) {
  const auto [chosen, truncates] = chosen_for(flow, s, options);
  return std::make_unique<FastIntegrator>(
      flow, gauss_system(formulation, s, flow, chosen.threads, truncates), chosen);
}

IntegratorEntry fast_gauss_entry(Formulation formulation, int s, const FastOptions& options) {
  return entry_of(gauss_entry(formulation, s), gauss_form(formulation, s), options);
}

IntegratorEntry fast_entry(std::string_view wanted, const FastOptions& options) {
  const IntegratorEntry& entry = integrator_entry(wanted);
  if (entry.co_rotating) {
    wanted.remove_suffix(frame_suffix.size());
    return frame_entry(fast_entry(wanted, options));
  }
  const std::optional<FastForm> form = form_of(entry);
  if (!form) throw std::invalid_argument(fmt::format("integrator '{}': has no fast form", wanted));
  return entry_of(entry, *form, options);
}

}  // namespace isosyrk

#include "isosyrk/catalogue/fast_forms.h"

#include <fmt/format.h>

#include <stdexcept>

#include "isosyrk/fast/algebra_system.h"
#include "isosyrk/fast/cotangent_system.h"
#include "isosyrk/fast/direct_system.h"
#include "isosyrk/fast/exponential_system.h"
#include "isosyrk/fast/fast_explicit.h"
#include "isosyrk/fast/fast_integrator.h"
#include "isosyrk/fast/group_system.h"
#include "isosyrk/fast/midpoint_system.h"
#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/linear_combination.h"
#include "isosyrk/tableaux/gauss_tableau.h"

namespace isosyrk {

// The longest sum of a stage equation has X_j and M_jk, j <= k.
static_assert(LinearCombination<double>::most == max_stages * (max_stages + 3) / 2);

FastOptions with_defaults(FastOptions options, Index n) {
  options.past_steps = options.past_steps.value_or(tuning.past_steps(n));
  options.bands = options.bands.value_or(n >= tuning.smallest_banded);
  return options;
}

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

namespace {

// Fills in the defaults, and as many threads as help at this size.
FastOptions chosen_for(const SharedFlow& flow, const FastOptions& options) {
  checked_threads(options.threads);
  const Index n = flow->size();
  FastOptions chosen = with_defaults(options, n);
  chosen.threads = tuning.threads(n, options.threads);
  return chosen;
}

template <class Method>
MakeFast fast_explicit() {
  return [](const auto& flow, const FastOptions& options) {
    return std::make_unique<Method>(flow, chosen_for(flow, options));
  };
}

}  // namespace

std::unique_ptr<Integrator> make_fast_gauss(Formulation formulation, int s, const SharedFlow& flow,
                                            const FastOptions& options) {
  const FastOptions chosen = chosen_for(flow, options);
  const auto system = [&] {
    return gauss_system(formulation, s, *flow, chosen.threads, *chosen.bands);
  };
  return std::make_unique<FastIntegrator>(flow, system, chosen);
}

MakeFast fast_gauss(Formulation formulation, int s) {
  return [=](const auto& flow, const FastOptions& options) {
    return make_fast_gauss(formulation, s, flow, options);
  };
}

MakeFast fast_composition(const CompositionScheme& scheme) {
  return [fractions = scheme.fractions](const auto& flow, const FastOptions& options) {
    const FastOptions chosen = chosen_for(flow, options);
    const auto system = [&] {
      return std::make_unique<MidpointSystem>(*flow, chosen.threads, *chosen.bands);
    };
    return std::make_unique<FastIntegrator>(flow, system, chosen, fractions);
  };
}

MakeFast fast_direct(int s) {
  return [tableau = gauss_tableau(s)](const auto& flow, const FastOptions& options) {
    const FastOptions chosen = chosen_for(flow, options);
    const auto system = [&] {
      return std::make_unique<DirectSystem>(*flow, tableau, chosen.threads, *chosen.bands);
    };
    return std::make_unique<FastIntegrator>(flow, system, chosen);
  };
}

MakeFast fast_exponential(int order) {
  return [order](const auto& flow, const FastOptions& options) {
    const FastOptions chosen = chosen_for(flow, options);
    const auto system = [&] { return std::make_unique<ExponentialSystem>(*flow, order, chosen); };
    return std::make_unique<FastIntegrator>(flow, system, chosen);
  };
}

MakeFast fast_magnus(const MagnusScheme& scheme) {
  return [scheme](const auto& flow, const FastOptions& options) {
    return std::make_unique<FastMagnus>(flow, scheme, chosen_for(flow, options));
  };
}

MakeFast fast_munthe_kaas4() { return fast_explicit<FastMuntheKaas4>(); }

MakeFast fast_multistep(const MultistepScheme& scheme) {
  return [scheme](const auto& flow, const FastOptions& options) {
    return std::make_unique<FastMultistep>(flow, scheme, chosen_for(flow, options));
  };
}

MakeFast fast_runge_kutta(const Tableau& tableau) {
  return [tableau](const auto& flow, const FastOptions& options) {
    return std::make_unique<FastRungeKutta>(flow, tableau, chosen_for(flow, options));
  };
}

IntegratorEntry fast_entry(IntegratorEntry entry, const FastOptions& options) {
  if (!entry.has_fast_form()) {
    throw std::invalid_argument(fmt::format("integrator '{}': has no fast form", entry.name));
  }
  entry.name = fmt::format("fast_{}", entry.name);
  entry.is_fast = true;
  entry.make = [make = entry.make_fast, options](
                   const auto& flow, const IterationOptions& iteration, ProductBackend) {
    FastOptions chosen = options;
    chosen.iteration = iteration;
    return make(flow, chosen);
  };
  return entry;
}

IntegratorEntry fast_entry(std::string_view wanted, const FastOptions& options) {
  return fast_entry(integrator_entry(wanted), options);
}

IntegratorEntry fast_gauss_entry(Formulation formulation, int s, const FastOptions& options) {
  return fast_entry(gauss_entry(formulation, s), options);
}

IntegratorEntry integrator_entry(std::string_view wanted, Solver solver,
                                 const FastOptions& options) {
  return solver == Solver::fast ? fast_entry(wanted, options) : integrator_entry(wanted);
}

IntegratorEntry gauss_entry(Formulation formulation, int s, Solver solver,
                            const FastOptions& options) {
  return solver == Solver::fast ? fast_gauss_entry(formulation, s, options)
                                : gauss_entry(formulation, s);
}

}  // namespace isosyrk

#include "isosyrk/catalogue/fast_forms.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

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

// Returns the options with one thread below what pays, and bands as they are then truncated.
FastOptions chosen_for(const SharedFlow& flow, int s, const FastOptions& options) {
  ThreadScope::checked(options.threads);
  const Index n = flow->size();
  FastOptions chosen = options;
  if (n < tuning.smallest_parallel(s)) chosen.threads = 1;
  chosen.bands = options.bands.value_or(n >= tuning.smallest_banded);
  return chosen;
}

// A fast form: how it is made, and the numbers of n x n matrices that it holds: unknowns, workspace
// in double and in single precision.  A composition holds them once for each substep.
struct FastForm {
  std::function<std::unique_ptr<Integrator>(const SharedFlow&, const FastOptions&)> make;
  double unknowns;
  double doubles;
  double singles;
  std::size_t substeps = 1;
};

// Returns an upper bound of the memory of a form, in bytes.  For n >= 33 and default options it is
// at most 1.5 times the memory (tests/allocation_test.cpp).
double bytes_of(const FastForm& form, Index n, const FastOptions& options) {
  const int past_steps = options.past_steps.value_or(tuning.past_steps(n));
  const auto size = static_cast<double>(n);
  const double in_double = 16.0 * size * static_cast<double>(split_row<double>(n));
  const double in_single = 8.0 * size * static_cast<double>(split_row<float>(n));
  // In double: the unknowns, the predictor's and Anderson's copies.  In single: residual,
  // corrections and Anderson's differences.
  // The predictor keeps some rows of the differences of past steps besides.
  const double sampled = static_cast<double>(tuning.sampled_rows) / size *
                         std::max(0, past_steps - Tuning::differences + 1);
  const double solver =
      form.unknowns * ((2.0 + past_steps + sampled) * in_double + 10.0 * in_single);
  // W₀ and W₁, interleaved and split, and the factors of the Laplacian.  Each thread adds a packing
  // space.
  const double common = 32.0 * size * size + 3.0 * in_double + in_single;
  const double diagonals = 16.0 * size * (form.unknowns + 3.0);  // sums over them, for truncation
  return static_cast<double>(form.substeps) *
         (solver + form.doubles * in_double + form.singles * in_single + common +
          options.threads * (in_double + in_single) + diagonals);
}

FastForm gauss_form(Formulation formulation, int stages) {
  const auto make = [=](const SharedFlow& flow, const FastOptions& options) {
    return make_fast_gauss(formulation, stages, flow, options);
  };
  const double s = stages;
  const double pairs = 0.5 * s * (s - 1.0);
  switch (formulation) {
    case Formulation::cotangent:
      return {make, 2.0 * s, 4.0 * s + 3.0, 8.0 * s};
    case Formulation::group:
      return {make, s, 4.0 * s + 3.0, 7.0 * s};
    case Formulation::algebra:
      break;
  }
  if (stages == 1) return {make, 1.0, 5.0, 9.0};  // the midpoint
  return {make, 2.0 * s + pairs, 9.0 * s + 3.0 * pairs + 2.0, 10.0 * s + 4.0 * pairs};
}

// A composition of midpoint steps, with a predictor for each substep.
FastForm composition_form(const CompositionScheme& scheme) {
  FastForm form = gauss_form(Formulation::algebra, 1);
  form.substeps = scheme.fractions.size();
  form.make = [=](const SharedFlow& flow, const FastOptions& options) {
    const FastOptions chosen = chosen_for(flow, 1, options);
    const auto system = [&] {
      return std::make_unique<MidpointSystem>(*flow, chosen.threads, *chosen.bands);
    };
    return std::make_unique<FastIntegrator>(flow, system, chosen, scheme.fractions);
  };
  return form;
}

FastForm direct_form(int s) {
  const auto make = [=](const SharedFlow& flow, const FastOptions& options) {
    const FastOptions chosen = chosen_for(flow, s, options);
    const auto system = [&] {
      return std::make_unique<DirectSystem>(*flow, gauss_tableau(s), chosen.threads, *chosen.bands);
    };
    return std::make_unique<FastIntegrator>(flow, system, chosen);
  };
  return {make, 1.0 * s, 3.0 * s, 5.0 * s};
}

template <class Method>
FastForm explicit_form(double doubles, double singles) {
  const auto make = [](const SharedFlow& flow, const FastOptions& options) {
    return std::make_unique<Method>(flow, chosen_for(flow, 1, options));
  };
  return {make, 0.0, doubles, singles};
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
  if (entry.name == "rk4") return explicit_form<FastRungeKutta4>(7.0, 0.0);
  if (entry.name == "rkmk4") return explicit_form<FastMuntheKaas4>(10.0, 4.0);
  return {};  // a control
}

IntegratorEntry entry_of(IntegratorEntry entry, const FastForm& form, const FastOptions& options) {
  entry.name = fmt::format("fast_{}", entry.name);
  entry.make = [form, options](const SharedFlow& flow, const SolverOptions& solver,
                               ProductBackend) {
    FastOptions chosen = options;
    chosen.solver = solver;
    return form.make(flow, chosen);
  };
  entry.bytes = [form, options](Index n) { return bytes_of(form, n, options); };
  return entry;
}

}  // namespace

std::unique_ptr<Integrator> make_fast_gauss(Formulation formulation, int s, const SharedFlow& flow,
                                            const FastOptions& options) {
  const FastOptions chosen = chosen_for(flow, s, options);
  const auto system = [&] {
    return gauss_system(formulation, s, *flow, chosen.threads, *chosen.bands);
  };
  return std::make_unique<FastIntegrator>(flow, system, chosen);
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

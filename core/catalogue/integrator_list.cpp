#include "isosyrk/catalogue/integrator_list.h"

#include <fmt/ranges.h>

#include <stdexcept>

#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/integrators/algebra_form.h"
#include "isosyrk/integrators/bogfjellmo_marthinsen.h"
#include "isosyrk/integrators/composition.h"
#include "isosyrk/integrators/direct_form.h"
#include "isosyrk/integrators/explicit_magnus.h"
#include "isosyrk/integrators/explicit_methods.h"
#include "isosyrk/integrators/exponential_lie_poisson.h"
#include "isosyrk/integrators/frame_integrator.h"
#include "isosyrk/integrators/projected.h"
#include "isosyrk/integrators/step_limits.h"
#include "isosyrk/tableaux/explicit_tableaux.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "isosyrk/tableaux/multistep_schemes.h"

namespace isosyrk {

namespace {

MakePublished make_gauss(Formulation formulation, int s) {
  return [formulation, tableau = gauss_tableau(s)](
             const auto& flow, const IterationOptions& options, ProductBackend backend) {
    return make_formulation(formulation, flow, tableau, options, backend);
  };
}

// Makes an implicit method from a flow and the method's data, if it has any: a tableau, or a
// composition scheme and a formulation.
template <template <class> class Method, class... Data>
MakePublished make_implicit(const Data&... data) {
  return [=](const auto& flow, const IterationOptions& options, ProductBackend backend) {
    return make_in_arithmetic_of<Method>(flow, data..., options, backend);
  };
}

template <template <class> class Method, class... Data>
MakePublished make_explicit(const Data&... data) {
  return [=](const auto& flow, const IterationOptions&, ProductBackend backend) {
    return make_in_arithmetic_of<Method>(flow, data..., backend);
  };
}

// Limit of the midpoint rule over the largest |fraction|: each substep is a midpoint step.
std::function<double(const RealVector&)> composition_limit(const CompositionScheme& scheme) {
  double largest = 0.0;
  for (const double fraction : scheme.fractions) largest = larger(largest, std::abs(fraction));
  return [largest](const RealVector& frequencies) {
    return midpoint_iteration_limit(frequencies) / largest;
  };
}

constexpr Properties isosyrk_properties = {
    .isospectral = true, .lie_poisson = true, .symmetric = true};

IntegratorEntry composition_entry(const CompositionScheme& scheme, Formulation formulation) {
  const bool on_g = formulation == Formulation::algebra;
  return {.name = on_g ? scheme.name : fmt::format("{}_{}", scheme.name, name(formulation)),
          .family = Family::composition,
          .formulation = formulation,
          .variant_of = on_g ? "" : scheme.name,
          .stages = static_cast<int>(scheme.fractions.size()),
          .order = scheme.order,
          .keeps = isosyrk_properties,
          .make = make_implicit<Composition>(scheme, formulation),
          .make_fast = on_g ? fast_composition(scheme) : MakeFast(),
          .linear_limit = composition_limit(scheme),
          .in_frame = on_g};
}

IntegratorEntry direct_entry(int s) {
  return {.name = fmt::format("direct{}", s),
          .family = Family::direct_gauss,
          .stages = s,
          .order = 2 * s,
          .keeps = {.isospectral = false, .lie_poisson = false, .symmetric = true},
          .make = make_implicit<DirectForm>(gauss_tableau(s)),
          .make_fast = fast_direct(s),
          .linear_limit = [tableau = gauss_tableau(s)](const RealVector& frequencies) {
            return direct_iteration_limit(tableau, frequencies);
          }};
}

// Of methods that conjugate W by exponentials.
constexpr Properties exponential_properties = {
    .isospectral = true, .lie_poisson = true, .symmetric = true, .spectrum_at_any_tolerance = true};
constexpr Properties explicit_isospectral_properties = {.isospectral = true,
                                                        .lie_poisson = false,
                                                        .symmetric = false,
                                                        .spectrum_at_any_tolerance = true};

IntegratorEntry exponential_entry(int order) {
  return {.name = fmt::format("elp{}", order),
          .family = Family::exponential_lie_poisson,
          .stages = 1,
          .order = order,
          .keeps = exponential_properties,
          .make = make_implicit<ExponentialLiePoisson>(order),
          .make_fast = fast_exponential(order),
          .in_frame = true};
}

IntegratorEntry bogfjellmo_marthinsen_entry(int s) {
  Properties keeps = exponential_properties;
  keeps.symmetric = s == 1;
  return {.name = fmt::format("bm{}", s),
          .family = Family::bogfjellmo_marthinsen,
          .stages = s,
          .order = 2 * s,
          .keeps = keeps,
          .make = make_implicit<BogfjellmoMarthinsen>(gauss_tableau(s)),
          .in_frame = true};
}

IntegratorEntry crouch_grossman_entry(const CompositionScheme& weights) {
  return {.name = fmt::format("cg{}", weights.order),
          .family = Family::crouch_grossman,
          .stages = static_cast<int>(weights.fractions.size()),
          .order = weights.order,
          .keeps = exponential_properties,
          .make = make_implicit<CrouchGrossman>(weights),
          .in_frame = true};
}

// An explicit method applied to W, with what makes it still to be given.
IntegratorEntry explicit_entry(const std::string& name, Family family, int stages, int order,
                               double imaginary_limit) {
  return {.name = name,
          .family = family,
          .stages = stages,
          .order = order,
          .keeps = {.isospectral = false, .lie_poisson = false, .symmetric = false},
          .is_explicit = true,
          .make = {},
          .stability_limit = imaginary_limit,
          .linear_limit =
              [imaginary_limit](const RealVector& frequencies) {
                return adjoint_limit(imaginary_limit, frequencies);
              },
          .in_frame = true};
}

IntegratorEntry runge_kutta_entry(const ExplicitScheme& scheme) {
  const Tableau& tableau = scheme.tableau;
  IntegratorEntry entry = explicit_entry(tableau.name, Family::runge_kutta, tableau.stages(),
                                         tableau.order, scheme.imaginary_limit);
  entry.make = make_explicit<ExplicitRungeKutta>(tableau);
  entry.make_fast = fast_runge_kutta(tableau);
  return entry;
}

// Two stages: what is predicted, and the state before it.
IntegratorEntry multistep_entry(const MultistepScheme& scheme) {
  IntegratorEntry entry = explicit_entry(scheme.name, Family::adams_bashforth_moulton, 2,
                                         scheme.order, scheme.imaginary_limit);
  entry.make = make_explicit<AdamsBashforthMoulton>(scheme);
  entry.make_fast = fast_multistep(scheme);
  return entry;
}

// The entry of a method with a projection onto the spectrum.
IntegratorEntry projected_entry(const IntegratorEntry& method) {
  IntegratorEntry entry = method;
  entry.name += "_projected";
  entry.projected = true;
  entry.keeps = explicit_isospectral_properties;
  entry.linear_limit = {};
  entry.make = [make = method.make, name = entry.name](
                   const auto& flow, const IterationOptions& options, ProductBackend backend) {
    return std::make_unique<Projected>(flow, make(flow, options, backend), name, backend);
  };
  entry.make_fast = [make = method.make_fast, name = entry.name](const auto& flow,
                                                                 const FastOptions& options) {
    return std::make_unique<Projected>(flow, make(flow, options), name, ProductBackend::openblas);
  };
  return entry;
}

// The explicit methods applied to W.
std::vector<IntegratorEntry> explicit_entries() {
  return {runge_kutta_entry(classical_runge_kutta4()), runge_kutta_entry(dormand_prince5()),
          runge_kutta_entry(dormand_prince8()), runge_kutta_entry(feagin10()),
          multistep_entry(adams_bashforth_moulton8())};
}

std::vector<IntegratorEntry> make_list() {
  std::vector<IntegratorEntry> list;
  for (const Formulation formulation : formulations()) {
    for (int s = 1; s <= 3; ++s) list.push_back(gauss_entry(formulation, s));
  }
  for (int s = 4; s <= 8; ++s) list.push_back(gauss_entry(Formulation::group, s));
  for (const CompositionScheme& scheme : {yoshida4(), suzuki4(), kahan_li6()}) {
    list.push_back(composition_entry(scheme, Formulation::algebra));
  }
  list.push_back({.name = "rkmk4",
                  .family = Family::munthe_kaas,
                  .stages = 4,
                  .order = 4,
                  .keeps = explicit_isospectral_properties,
                  .is_explicit = true,
                  .make = make_explicit<MuntheKaas4>(),
                  .make_fast = fast_munthe_kaas4(),
                  .in_frame = true});
  for (const int order : {2, 4, 6}) list.push_back(exponential_entry(order));
  for (int s = 1; s <= 3; ++s) list.push_back(bogfjellmo_marthinsen_entry(s));
  list.push_back(crouch_grossman_entry(yoshida4()));
  list.push_back({.name = "magnus4",
                  .family = Family::explicit_magnus,
                  .stages = 4,
                  .order = 4,
                  .keeps = explicit_isospectral_properties,
                  .is_explicit = true,
                  .make = make_explicit<ExplicitMagnus>(magnus4()),
                  .make_fast = fast_magnus(magnus4()),
                  .in_frame = true});
  list.push_back({.name = "magnus5",
                  .family = Family::explicit_magnus,
                  .stages = 8,
                  .order = 5,
                  .keeps = explicit_isospectral_properties,
                  .is_explicit = true,
                  .make = make_explicit<ExplicitMagnus>(magnus5()),
                  .make_fast = fast_magnus(magnus5()),
                  .in_frame = true});
  const std::vector<IntegratorEntry> explicit_methods = explicit_entries();
  for (const IntegratorEntry& entry : explicit_methods) list.push_back(projected_entry(entry));
  // Controls: methods that do not keep the structure.
  for (int s = 1; s <= 3; ++s) list.push_back(direct_entry(s));
  list.insert(list.end(), explicit_methods.begin(), explicit_methods.end());
  // A new method is one entry here.
  const std::vector<IntegratorEntry> methods = list;
  for (const IntegratorEntry& method : methods) {
    if (method.in_frame) list.push_back(frame_entry(method));
  }
  return list;
}

std::vector<IntegratorEntry> make_controls() {
  std::vector<IntegratorEntry> controls = {two_products_entry(2), two_products_entry(3)};
  for (const CompositionScheme& scheme : {yoshida4(), suzuki4(), kahan_li6()}) {
    for (const Formulation formulation : {Formulation::group, Formulation::cotangent}) {
      controls.push_back(composition_entry(scheme, formulation));
    }
  }
  return controls;
}

}  // namespace

IntegratorEntry gauss_entry(Formulation formulation, int s) {
  return {.name = fmt::format("{}{}", name(formulation), s),
          .family = Family::gauss,
          .formulation = formulation,
          .stages = s,
          .order = 2 * s,
          .keeps = isosyrk_properties,
          .make = make_gauss(formulation, s),
          .make_fast = fast_gauss(formulation, s),
          .linear_limit =
              [formulation, tableau = gauss_tableau(s)](const RealVector& frequencies) {
                return formulation == Formulation::algebra && tableau.stages() == 1
                           ? midpoint_iteration_limit(frequencies)
                           : stage_iteration_limit(tableau, frequencies);
              },
          .in_frame = true};
}

IntegratorEntry frame_entry(const IntegratorEntry& method) {
  IntegratorEntry entry = method;
  entry.variant_of = method.name;
  entry.name += "_frame";
  entry.co_rotating = true;
  entry.make = [make = method.make](const auto& flow, const IterationOptions& options,
                                    ProductBackend backend) {
    return std::make_unique<FrameIntegrator>(
        flow, [&](const auto& inner) { return make(inner, options, backend); });
  };
  if (method.has_fast_form()) {
    entry.make_fast = [make = method.make_fast](const auto& flow, const FastOptions& options) {
      return std::make_unique<FrameIntegrator>(
          flow, [&](const auto& inner) { return make(inner, options); },
          tuning.threads(flow->size(), options.threads));
    };
  }
  return entry;
}

IntegratorEntry two_products_entry(int s) {
  if (s < 2)
    throw std::invalid_argument(fmt::format("two_products_entry: s = {}, must be at least 2", s));
  IntegratorEntry entry = gauss_entry(Formulation::algebra, s);
  entry.variant_of = entry.name;
  entry.name += "_two_products";
  entry.keeps = {.isospectral = false, .lie_poisson = false, .symmetric = true};
  entry.make = [tableau = gauss_tableau(s)](const auto& flow, const IterationOptions& options,
                                            ProductBackend backend) {
    return make_in_arithmetic_of<AlgebraForm>(flow, tableau, options, backend,
                                              AlgebraUpdate::two_products);
  };
  entry.make_fast = {};
  return entry;
}

const std::vector<IntegratorEntry>& integrators() {
  static const std::vector<IntegratorEntry> all = make_list();
  return all;
}

const IntegratorEntry& integrator_entry(std::string_view wanted) {
  std::vector<std::string_view> names;
  for (const IntegratorEntry& entry : integrators()) {
    if (entry.name == wanted) return entry;
    names.push_back(entry.name);
  }
  static const std::vector<IntegratorEntry> controls = make_controls();
  for (const IntegratorEntry& entry : controls) {
    if (entry.name == wanted) return entry;
  }
  throw std::invalid_argument(
      fmt::format("integrator '{}': must be one of {}", wanted, fmt::join(names, ", ")));
}

}  // namespace isosyrk

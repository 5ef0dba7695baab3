// The fast form of each formulation.
#pragma once

#include <memory>
#include <string_view>

#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/catalogue/solver.h"
#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/stage_system.h"
#include "isosyrk/tableaux/composition_schemes.h"
#include "isosyrk/tableaux/explicit_tableaux.h"
#include "isosyrk/tableaux/magnus_schemes.h"
#include "isosyrk/tableaux/multistep_schemes.h"

namespace isosyrk {

/// Fills in defaults for n x n matrices: the past steps of Tuning::past_steps, and bands on from
/// Tuning::smallest_banded.
FastOptions with_defaults(FastOptions options, Index n);

/// Returns the Gauss method with s stages in the fast form of a formulation.  `algebra` with one
/// stage is the isospectral midpoint.  Throws
/// std::invalid_argument unless 1 <= s <= max_stages and the options are in range, and for a flow
/// without a generator in split-complex storage.
std::unique_ptr<Integrator> make_fast_gauss(Formulation formulation, int s, const SharedFlow& flow,
                                            const FastOptions& options = {});

/// Returns the stage equations of that method, for up to `threads` threads and with band truncation
/// or without, whether they pay or not.
std::unique_ptr<StageSystem> gauss_system(Formulation formulation, int s, const Flow& flow,
                                          int threads, bool truncates);

// The makers of the fast forms, for the list of integrators.  Each throws std::invalid_argument
// unless 1 <= s <= max_stages; what it returns throws as make_fast_gauss.
MakeFast fast_gauss(Formulation formulation, int s);
/// Of midpoint steps on the algebra, with a predictor for each substep.
MakeFast fast_composition(const CompositionScheme& scheme);
MakeFast fast_direct(int s);
MakeFast fast_munthe_kaas4();
/// ExponentialLiePoisson of order 2, 4 or 6.
MakeFast fast_exponential(int order);
/// An explicit Magnus method.
MakeFast fast_magnus(const MagnusScheme& scheme);
/// An explicit Runge-Kutta method applied to W.
MakeFast fast_runge_kutta(const Tableau& tableau);
/// An explicit multistep method applied to W.
MakeFast fast_multistep(const MultistepScheme& scheme);

/// Returns the entry with the fast form in place of the published one, and "fast_" before its name.
/// Its integrators have these options, except options.iteration, which `make` replaces.  Throws
/// std::invalid_argument for an entry without a fast form.
IntegratorEntry fast_entry(IntegratorEntry entry, const FastOptions& options = {});
/// The same of integrator_entry(name).
IntegratorEntry fast_entry(std::string_view name, const FastOptions& options = {});
/// The same of gauss_entry(formulation, s).
IntegratorEntry fast_gauss_entry(Formulation formulation, int s, const FastOptions& options = {});

/// Returns integrator_entry(name) if published, fast_entry(name, options) if fast.
IntegratorEntry integrator_entry(std::string_view name, Solver solver,
                                 const FastOptions& options = {});
/// Returns gauss_entry(formulation, s) if published, fast_gauss_entry(formulation, s, options) if
/// fast.
IntegratorEntry gauss_entry(Formulation formulation, int s, Solver solver,
                            const FastOptions& options = {});

}  // namespace isosyrk

// The fast form of each formulation.
#pragma once

#include <memory>
#include <string_view>

#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/stage_system.h"

namespace isosyrk {

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

/// Returns the list entry of that fast form, named fast_group2 and so on.  Its integrators have
/// these options, except options.solver, which `make` replaces.  Throws std::invalid_argument
/// unless 1 <= s <= max_stages; making an integrator throws as make_fast_gauss.
IntegratorEntry fast_gauss_entry(Formulation formulation, int s, const FastOptions& options = {});

/// Returns the fast form of the integrator of integrators() with this name.  Throws
/// std::invalid_argument for another name.
IntegratorEntry fast_entry(std::string_view name, const FastOptions& options = {});

}  // namespace isosyrk

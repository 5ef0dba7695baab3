// The fast form of each formulation.
#pragma once

#include <memory>
#include <string_view>

#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/fast/fast_options.h"

namespace isosyrk {

/// The Gauss method with s stages in the fast form of a formulation; `algebra` with one stage is the
/// isospectral midpoint.  The flow must outlive the integrator.  Throws std::invalid_argument unless
/// 1 <= s <= max_stages and the options are in range, and for a flow that has no generator in split
/// storage: it has published forms only.
std::unique_ptr<Integrator> make_fast_gauss(Formulation formulation, int s, const Flow& flow,
                                            const FastOptions& options = {});

/// The same as an entry of the list, named fast_group2 and so on, for so many threads.
IntegratorEntry fast_gauss_entry(Formulation formulation, int s, int threads = 1);

/// The fast form of the listed integrator with this name.  Throws std::invalid_argument for a name that
/// is not in the list, and where there is no fast form.
IntegratorEntry fast_entry(std::string_view name, int threads = 1);

}  // namespace isosyrk

// The fast form of each formulation.
#pragma once

#include <memory>

#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/fast/fast_options.h"

namespace isosyrk {

/// The Gauss method with s stages in the fast form of a formulation; `algebra` with one stage is the
/// isospectral midpoint.  The flow must outlive the integrator.  Throws std::invalid_argument unless
/// 1 <= s <= max_stages and the options are in range, and for a flow that has no generator in split
/// storage: it has published forms only.
std::unique_ptr<Integrator> make_fast_gauss(Formulation formulation, int s, const Flow& flow,
                                            const FastOptions& options = {});

/// The same as a line of the list, named fast_group2 and so on, with start values by default.
IntegratorEntry fast_gauss_entry(Formulation formulation, int s);

}  // namespace isosyrk

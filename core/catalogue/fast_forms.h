// The fast form of each formulation.
#pragma once

#include <memory>

#include "isosyrk/fast/fast_form.h"
#include "isosyrk/catalogue/integrator_list.h"

namespace isosyrk {

/// The Gauss method with s stages in the fast form of a formulation: FastCotangent, FastGroup,
/// FastAlgebra, and FastMidpoint for `algebra` with one stage.  What fast forms do not exist for,
/// flows other than Euler-Zeitlin, is integrated in the published form.  The flow must outlive the
/// integrator.  Throws std::invalid_argument unless 1 <= s <= max_stages.
std::unique_ptr<Integrator> make_fast_gauss(Formulation formulation, int s, const Flow& flow,
                                            const FastOptions& options, ProductBackend backend);

/// The same as a line of the list, named fast_group2 and so on, with start values by default.
IntegratorEntry fast_gauss_entry(Formulation formulation, int s);

}  // namespace isosyrk

// The three equivalent formulations of an isospectral symplectic Runge-Kutta method.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "isosyrk/integrators/integrator.h"
#include "isosyrk/iteration/iteration_options.h"
#include "isosyrk/linalg/product_backend.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// The three equivalent formulations of the paper.
enum class Formulation { cotangent, group, algebra };

/// Returns all formulations, in the order of the paper's Table 1.
const std::vector<Formulation>& formulations();
/// Returns "cotangent", "group" or "algebra".
std::string_view name(Formulation formulation);
/// Returns the formulation with this name.  Throws std::invalid_argument, naming all names, for
/// another one.
Formulation formulation_from_name(std::string_view name);

/// Returns a Runge-Kutta method in one of the formulations, in the arithmetic of the flow.
/// `algebra` with the one-stage Gauss tableau gives IsospectralMidpoint.
/// Throws std::invalid_argument for an inconsistent tableau.
std::unique_ptr<Integrator> make_formulation(Formulation formulation, const SharedFlow& flow,
                                             const Tableau& tableau,
                                             const IterationOptions& options,
                                             ProductBackend backend);
/// As make_formulation, in this arithmetic.
template <class Scalar>
std::unique_ptr<IntegratorIn<Scalar>> make_formulation_in(Formulation formulation,
                                                          SharedFlowIn<Scalar> flow,
                                                          const Tableau& tableau,
                                                          const IterationOptions& options,
                                                          ProductBackend backend);

}  // namespace isosyrk

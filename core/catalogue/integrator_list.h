// The list of integrators: what tests, benchmarks, tables and charts run over.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "isosyrk/integrators/formulation.h"

namespace isosyrk {

/// What an integrator keeps, each checked by a test in both directions.
struct Properties {
  bool isospectral;  ///< keeps the spectrum of W
  bool lie_poisson;  ///< the step is a Poisson map
  bool symmetric;    ///< step(-h) inverts step(h)
  bool is_explicit;  ///< no iteration
};

/// One line of the list.
struct IntegratorEntry {
  std::string name;
  int stages;
  int order;
  Properties keeps;
  std::function<std::unique_ptr<Integrator>(const Flow&, const SolverOptions&, ProductBackend)>
      make;
  /// Largest h‖ad_B‖₂ at which the step is stable for a constant generator; a longer step lets
  /// perturbations grow whatever the accuracy asked for.
  double stability_limit = std::numeric_limits<double>::infinity();
  /// The h at which linear theory ends (integrators/step_limits.h), from the eigenvalues of -iB(W₀);
  /// empty where it sets no limit.
  std::function<double(const RealVector&)> linear_limit = {};
  /// The memory of the integrator in bytes for n x n matrices and J = I, known before it is made.
  std::function<double(Index)> bytes = {};
};

/// The Gauss method with s stages in one of the formulations.  Throws std::invalid_argument unless
/// 1 <= s <= max_stages.
IntegratorEntry gauss_entry(Formulation formulation, int s);

/// Control, not in the list: `algebra` with s >= 2 stages and its update formed as B W̃ - W̃ B,
/// which loses skew-Hermiticity.  Throws std::invalid_argument unless 2 <= s <= max_stages.
IntegratorEntry two_products_entry(int s);

/// Every integrator of the project.
const std::vector<IntegratorEntry>& integrators();
/// The one of this name.  Throws std::invalid_argument, naming what is allowed.
const IntegratorEntry& integrator_entry(std::string_view name);

}  // namespace isosyrk

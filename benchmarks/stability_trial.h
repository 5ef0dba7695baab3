// Whether a step size works, tried on some steps, and the largest that does.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "isosyrk/simulation/conservation.h"
#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/simulation/run.h"

namespace isosyrk {

/// A scene with what step sizes are told by: h‖B(W₀)‖₂ governs plain fixed-point iteration.
struct TrialSetting {
  TrialSetting(Scene scene_to_try, ProductBackend products);

  Index n() const { return scene.initial.rows(); }

  /// An integrator of its flow, at most trial_max_sweeps sweeps a step.
  std::unique_ptr<Integrator> make(const IntegratorEntry& entry) const;

  Scene scene;
  ProductBackend backend;
  RealVector frequencies;  ///< eigenvalues of -iB(W₀), ascending
  GeneratorNorms norms;
};

/// Some steps of one size, and how they ended.
struct Trial {
  double h_norm_B = 0.0;
  double step = 0.0;
  RunReport run{};
  Conservation kept{};  ///< of the last good state
  /// That of the run, or "unstable" where every step converged and the invariants were lost.
  std::string status{};

  bool works() const { return status == name(Status::converged); }
};

/// Whether `kept` shows that a run lost what it must not lose.  What is promised to be isospectral
/// is held to 1e-8, far more than a tolerance of 1e-13 leaves in a few hundred steps; other
/// methods, to a tenth of the largest eigenvalue, which is 1.  Every method keeps W skew-Hermitian
/// to 1e-8 and its energy within a factor of two.
bool invariants_lost(const Conservation& kept, const Properties& promised);

/// `steps` steps from the initial data with h‖B(W₀)‖₂ = h_norm_B.
Trial attempt(const TrialSetting& setting, const Properties& promised, Integrator& integrator,
              double h_norm_B, long steps);

/// The largest step tried that works and the smallest above that fails.
struct CriticalStep {
  Trial works;
  Trial fails;
};

/// Trials on a grid of rising h‖B‖₂, and the bracket of the first failure that follows a success,
/// if there is one.
struct Edge {
  std::vector<Trial> trials;
  std::optional<CriticalStep> critical;
};

/// Tries the grid and halves the bracket, in the ratio, to 2 %.
Edge find_edge(const TrialSetting& setting, const Properties& promised, Integrator& integrator,
               long steps);
/// The same for a listed integrator, with the steps of a trial.
Edge find_edge(const TrialSetting& setting, const IntegratorEntry& entry);

/// Sweeps allowed in a trial: a slow iteration is told from one that fails without the cost of
/// Table 1's thousand.
inline constexpr int trial_max_sweeps = 400;

/// Steps of a trial: enough for a growth to show, fewer where they are dear.
long trial_steps(Index n, bool is_explicit);

nlohmann::ordered_json trial_json(const Trial& trial);

}  // namespace isosyrk

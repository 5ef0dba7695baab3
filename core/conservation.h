// What a run was seen to conserve.
#pragma once

#include <array>

#include "core/scene.h"

namespace isosyrk {

/// Errors of a vorticity matrix W against the initial data of its scene.
struct Conservation {
  double spectrum_error = 0.0;           ///< largest |λ_k(W) - λ_k(W₀)|
  double skew_defect = 0.0;              ///< largest entry of |W + W†|
  double energy_error = 0.0;             ///< relative, largest over the steps observed
  std::array<double, 4> casimir_errors;  ///< |tr W^k - tr W₀^k| / Σ|λ|^k, k = 2..5
  double angular_momentum_error = 0.0;   ///< largest component of the change, relative to |L(W₀)|
};

/// Observes the steps of a run and reports on its last state.  The scene must outlive it.
class ConservationWatch {
 public:
  explicit ConservationWatch(const Scene& scene);

  /// To be called with W after every step.
  void observe(const Matrix& W);

  /// Errors of W, which must be finite, and the largest energy error observed.
  Conservation report(const Matrix& W) const;

 private:
  const Scene& scene_;
  double initial_energy_;
  double energy_error_ = 0.0;
};

/// Norms that decide whether a step is small: of the generator B = B(W) and of ad_B = [B, ·].
struct GeneratorNorms {
  double B = 0.0;     ///< ‖B‖₂
  double ad_B = 0.0;  ///< ‖ad_B‖₂ = λ_max - λ_min of -iB
};
/// At the scene's initial data.
GeneratorNorms generator_norms(const Scene& scene);

}  // namespace isosyrk

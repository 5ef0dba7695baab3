// What a run was seen to conserve.
#pragma once

#include <array>

#include "isosyrk/flows/scene.h"

namespace isosyrk {

/// Errors of a vorticity matrix W against the initial data of its scene.
struct Conservation {
  double spectrum_error = 0.0;  ///< largest |λ_k(W) - λ_k(W₀)|
  double skew_defect = 0.0;     ///< largest entry of |W + W†|
  double energy_error = 0.0;    ///< relative, largest over the steps observed
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

/// |tr W^k - tr W₀^k| / Σ|λ|^k for k = 2..5, λ the eigenvalues of W₀.  Takes 20 matrix products.
std::array<double, 4> casimir_errors(const Matrix& W, const Matrix& W0);

/// Largest component of the change of the angular momentum, relative to its size at W₀.
double angular_momentum_error(const Matrix& W, const Matrix& W0);

/// Eigenvalues of -iB(W₀), ascending, at the scene's initial data.
RealVector generator_frequencies(const Scene& scene);

/// Norms that decide whether a step is small: of the generator B = B(W) and of ad_B = [B, ·].
struct GeneratorNorms {
  double B = 0.0;     ///< ‖B‖₂
  double ad_B = 0.0;  ///< ‖ad_B‖₂ = λ_max - λ_min of -iB
};
/// From the eigenvalues of -iB, ascending.
GeneratorNorms generator_norms(const RealVector& frequencies);
/// At the scene's initial data.
GeneratorNorms generator_norms(const Scene& scene);

}  // namespace isosyrk

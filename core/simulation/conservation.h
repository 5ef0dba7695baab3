// Conservation errors of a run.
#pragma once

#include <array>

#include "isosyrk/flows/energy.h"
#include "isosyrk/linalg/state_archive.h"
#include "isosyrk/scenes/scene.h"

namespace isosyrk {

/// Errors of a matrix W against the initial data of its scene.
struct Conservation {
  double spectrum_error = 0.0;  ///< largest |λ_k(W) - λ_k(W₀)|: absolute, in units of W
  double skew_defect = 0.0;     ///< largest entry of |W + W†|, or of |W†J + JW|: in units of W
  double energy_error = 0.0;    ///< largest |H(W)/H(W₀) - 1| over the steps observed
};

/// Observes the steps of a run and reports on its last state.  The scene must outlive the watch.
class ConservationWatch {
 public:
  explicit ConservationWatch(const Scene& scene);

  /// Records the energy error of W, n x n, or of a state whose energy is known; to be called after
  /// every step.  Right at any norm of W, if H is quadratic.
  void observe(const Matrix& W) { observe(scene_.flow->energy(W)); }
  void observe(const Energy& energy);

  /// Returns the errors of W and the largest energy error observed.  Throws std::invalid_argument
  /// unless W is finite.
  Conservation report(const Matrix& W) const;

  /// Passes what was observed to an archive, or takes it from there.
  void archive(StateArchive& state) { state.pass(energy_error_); }

 private:
  const Scene& scene_;
  Energy initial_energy_;
  double energy_error_ = 0.0;
};

/// Returns |tr W^k - tr W₀^k| / Σ|λ|^k for k = 2..5, with λ the eigenvalues of W₀; both matrices
/// are n x n, skew-Hermitian and of any norm.  Takes 20 matrix products and a spectrum.  Throws as
/// spectrum().
std::array<double, 4> casimir_errors(const Matrix& W, const Matrix& W0);

/// Returns the largest component of the change of the angular momentum, relative to its Euclidean
/// norm at W₀; both matrices are n x n, of any norm.  Where W₀ has no part with l = 1 to rounding,
/// the result says nothing: rounding over rounding, infinite or NaN.
double angular_momentum_error(const Matrix& W, const Matrix& W0);

/// Returns the eigenvalues of -iB(W₀), ascending, for the scene's initial data W₀; with
/// `co_rotating` those of the generator B' of the co-rotating frame, for Euler-Zeitlin only. Throws
/// std::invalid_argument unless J = I, where B is skew-Hermitian.
RealVector generator_frequencies(const Scene& scene, bool co_rotating = false);

/// Norms of the generator B = B(W) and of ad_B = [B, ·].  They decide whether a step is small.
struct GeneratorNorms {
  double B = 0.0;     ///< ‖B‖₂
  double ad_B = 0.0;  ///< ‖ad_B‖₂ = λ_max - λ_min of -iB
};
/// Returns the norms from the eigenvalues of -iB.
GeneratorNorms generator_norms(const RealVector& frequencies);
/// Returns the norms at the scene's initial data.  Throws as generator_frequencies.
GeneratorNorms generator_norms(const Scene& scene);
/// Returns ‖B(W₀)‖₂ at the initial data of any scene.
double generator_norm(const Scene& scene);

}  // namespace isosyrk

// The algebra formulation, ISOSYRK: unknowns on g (third row of each block of the paper's Table 1).
#pragma once

#include <vector>

#include "isosyrk/integrators/published_form.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// Formula for the update of `algebra`.
enum class AlgebraUpdate {
  one_product,   ///< C - J⁻¹ C† J with C = B W̃: in g exactly for J = I
  two_products,  ///< B W̃ - W̃ B, equal up to rounding; a control, see AlgebraForm
};

/// Unknowns X_i, K_ij, W̃_i, i, j = 1..s, each n x n.  Stage equations and update, B_j = B(W̃_j):
///
///     X_i  = -h (W₀ + Σ_j a_ij X_j) B_i
///     K_ij =  h B_j ( Σ_j' a_ij' X_j' + Σ_j' a_jj' K_ij' )
///     W̃_i  = W₀ + Σ_j a_ij ( X_j - J⁻¹ X_j† J + K_ij )
///     W₁   = W₀ + h Σ_i b_i [B_i, W̃_i],   [B, W̃] = C - J⁻¹ C† J with C = B W̃
///
/// Products: s² + s a sweep, s for the update (2s with two_products).
/// Poisson solves: s a sweep, s for the update.
/// Source: the paper's ISOSYRK equations, with B_j for the printed B_i in K_ij.
///
/// The update formed from C alone keeps W in g, for J = I exactly.  Formed as B W̃ - W̃ B, W drifts
/// out of g exponentially: the stage equations assume W₀† = -J W₀ J⁻¹ and pass the part of W₀
/// outside g on to W̃.  For the midpoint tableau, IsospectralMidpoint takes
/// the same step in one unknown.
template <class Scalar>
class AlgebraForm final : public ImplicitForm<Scalar> {
  using Form = ImplicitForm<Scalar>;
  using Form::algebra, Form::generator, Form::products_, Form::zeros, Form::scratch_of_J;
  using typename Form::Stages;
  using typename Form::Stored;

 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  AlgebraForm(SharedFlowIn<Scalar> flow, const Tableau& tableau, const IterationOptions& options,
              ProductBackend backend, AlgebraUpdate update = AlgebraUpdate::one_product);

 private:
  void start(const Stored& W0) override;
  double sweep(const Stored& W0, double h) override;
  void update(const Stored& W0, double h, Stored& W1) override;
  void update_stage_vorticities(const Stored& W0);
  void update_by_two_products(const Stored& W0, double h, Stored& W1);

  Tableau tableau_;
  AlgebraUpdate update_;
  std::size_t s_;
  Stages X_;               // X_i
  Stages X_old_;           // X_i of the sweep before
  Stages X_sum_;           // Σ_j a_ij X_j
  std::vector<Stages> K_;  // K_[i][j] = K_ij
  Stages K_row_;           // the new K_i1 .. K_is, while the old ones are needed
  Stages W_stage_;         // W̃_i
  Stages B_;               // B(W̃_i)
  Stored input_;           // the factor of the next product, or a sum
  Stored adjoint_;         // J⁻¹ Y† J; empty if J = I
  RealVector change_;      // largest squared change of an X_i, of a K_ij and of a W̃_i
};

}  // namespace isosyrk

// Limits of the step size by linear theory, with the generator frozen at B = B(W₀).
//
// A rough perturbation δW hardly changes B(W) = Δ⁻¹W/ħ, since Δ⁻¹ divides it by l(l+1).  For rough
// perturbations one Picard sweep is therefore the linear map of the stage equations with B fixed.
// In the eigenbasis of B, with eigenvalues i β_p, this map is diagonal in the matrix entries:
//
// - `cotangent`, `group`:  δQ_i -> h Σ_j a_ij δQ_j B†, with eigenvalues ∓i h β_p α, α an eigenvalue
//   of A = (a_ij).  The spectral radius is ρ(A) h ‖B‖₂.
// - `algebra` with s >= 2 has the same spectral radius:  δX_i -> -h Σ_j a_ij δX_j B, and each row
//   K_i1 .. K_is satisfies the same map with B from the left.
// - Isospectral midpoint:  δW̃ -> (h/2)[B, δW̃] + (h²/4) B δW̃ B multiplies entry (p, q) by
//   i(x_p - x_q) - x_p x_q, x = hβ/2, with modulus² (x_p - x_q)² + (x_p x_q)².
// - `direct`:  δW̃_i -> h Σ_j a_ij [B, δW̃_j], with spectral radius ρ(A) h ‖ad_B‖₂.
// - RK4 has no iteration.  Its step multiplies entry (p, q) by R(ih(β_p - β_q)), and |R(iy)| <= 1
//   for y <= 2√2.
//
// `algebra` with its update formed as B W̃ - W̃ B does not rotate a Hermitian part E of W₀.  The
// stage equations contain -X† where E would need +X†.  In entry (p, q) the first orders of both
// cancel, and the update is an explicit Euler step:  E_pq -> (1 + ih(β_p - β_q)(1 + O(h²))) E_pq.
// It grows by about ½ h² (β_p - β_q)² a step, fastest between the eigenvectors of the extreme
// frequencies.
//
// The iteration can fail below the limit if the cold start W̃ = W₀ is too far from the solution.  It
// can converge beyond the limit if rough perturbations start from rounding only.
#pragma once

#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// Returns the largest modulus of the eigenvalues of A = (a_ij).
double spectral_radius(const Tableau& tableau);

/// Returns the h at which the iteration of `cotangent`, `group` or, for s >= 2, `algebra` ceases to
/// contract.  Here and below `frequencies` are the eigenvalues β of -iB.
double stage_iteration_limit(const Tableau& tableau, const RealVector& frequencies);

/// Returns the h at which the iteration of the isospectral midpoint ceases to contract.
double midpoint_iteration_limit(const RealVector& frequencies);

/// Returns the h at which the iteration of a Runge-Kutta method applied to W itself ceases to
/// contract.
double direct_iteration_limit(const Tableau& tableau, const RealVector& frequencies);

/// Returns the h at which h‖ad_B‖₂ equals `limit`.
double adjoint_limit(double limit, const RealVector& frequencies);

}  // namespace isosyrk

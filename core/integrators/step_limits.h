// How long a step may be by linear theory: with the generator frozen at B = B(W₀).
//
// A rough perturbation δW changes B(W) = Δ⁻¹W/ħ hardly at all, since Δ⁻¹ divides it by l(l+1); so
// for rough perturbations one sweep of the fixed-point iteration is the linear map that the stage
// equations make with B held fixed.  In the eigenbasis of B, with eigenvalues i β_p, that map is
// diagonal in the matrix entries:
//
// - `cotangent`, `group`:  δQ_i -> h Σ_j a_ij δQ_j B†, eigenvalues ∓i h β_p α with α an eigenvalue
//   of A = (a_ij); spectral radius ρ(A) h ‖B‖₂.  `algebra` with s >= 2 the same: X_i -> -h Σ_j a_ij
//   X_j B, and each row K_i1 .. K_is alike with B from the left.
// - Isospectral midpoint:  δW̃ -> (h/2)[B, δW̃] + (h²/4) B δW̃ B multiplies entry (p, q) by
//   i(x_p - x_q) - x_p x_q, x = hβ/2, of modulus² (x_p - x_q)² + (x_p x_q)².
// - The control on W:  δW̃_i -> h Σ_j a_ij [B, δW̃_j], spectral radius ρ(A) h ‖ad_B‖₂.
// - RK4 has no iteration; its step multiplies entry (p, q) by R(ih(β_p - β_q)), and |R(iy)| <= 1
// for
//   y <= 2√2.
//
// - `algebra` with its update formed as B W̃ - W̃ B:  what W₀ has of a Hermitian part E is not
//   rotated.  The stage equations put -X† for the conjugate that E would need +X† for; in entry
//   (p, q) the first order of both cancels, and the update is that of the explicit Euler method,
//   E_pq -> (1 + ih(β_p - β_q)(1 + O(h²))) E_pq, which grows by about ½ h² (β_p - β_q)² a step.
//   Fastest is the entry between the eigenvectors of B of the extreme frequencies.
//
// Where the cold start W̃ = W₀ is too far from the solution the iteration fails earlier, and where
// rough perturbations start from rounding only, it reaches its tolerance beyond.
#pragma once

#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// Largest modulus of the eigenvalues of A = (a_ij).
double spectral_radius(const Tableau& tableau);

/// The h at which the iteration of `cotangent`, `group` or, for s >= 2, `algebra` ceases to
/// contract.  `frequencies` here and below: the eigenvalues β of -iB.
double stage_iteration_limit(const Tableau& tableau, const RealVector& frequencies);

/// The same of the isospectral midpoint.
double midpoint_iteration_limit(const RealVector& frequencies);

/// The same of a Runge-Kutta method applied to W itself.
double direct_iteration_limit(const Tableau& tableau, const RealVector& frequencies);

/// Largest growth factor, in a step of size h, of a Hermitian part of W under `algebra` with its
/// update formed as B W̃ - W̃ B: |1 + ih(β_p - β_q) Σ b_i (1 + k_i)|, where k_i = Σ_j a_ij K_ij is
/// what K adds to the entry of W̃_i.
double hermitian_growth(const Tableau& tableau, const RealVector& frequencies, double h);

/// The h at which h‖ad_B‖₂ is `limit`.
double adjoint_limit(double limit, const RealVector& frequencies);

}  // namespace isosyrk

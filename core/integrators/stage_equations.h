// The stage equations of the published forms: each sets an unknown and returns its change.  With
// these, the operations of linalg/operations.h, the products of linalg/products.h and the flow's B,
// a form needs no access to single entries.
//
// Sums over stages cost O(s² n²), products O(s n³).  Each equation makes one pass: every matrix is
// read once, and a few numbers of all matrices are combined in registers.
#pragma once

#include <vector>

#include "isosyrk/linalg/operations.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// X_i = base + h Σ_j a_ij Y_j for i = 1..s, and squares[i] = Σ |change of X_i|².  a is s x s with
/// s = Y.size() = X.size() <= max_stages.  No X_i is base or a Y_j.
template <class Scalar>
void update_unknowns(const MatrixOf<Scalar>& base, double h, const RealMatrix& a,
                     const std::vector<MatrixOf<Scalar>>& Y, std::vector<MatrixOf<Scalar>>& X,
                     double* squares);

/// out += Σ_j weights(j) k_j, without terms of weight 0: an explicit method calls it while later
/// k_j are still those of an earlier step.  out is none of the k_j.
template <class Weights, class Scalar>
void add_slopes(const Weights& weights, const std::vector<MatrixOf<Scalar>>& k,
                MatrixOf<Scalar>& out) {
  for (std::size_t j = 0; j < k.size(); ++j) {
    const double weight = weights(static_cast<Index>(j));
    if (weight != 0.0) out += weight * k[j];
  }
}

/// Sets W = W₀ + (S - J⁻¹ Y† J) and returns Σ |change of W|².  With S = Y + Σ_j a_ij K_ij this is
/// the stage vorticity of the algebra formulation.  `scratch` is a matrix if J is not I, and unused
/// otherwise.  W is none of the other arguments.
template <class Scalar>
double update_stage_vorticity(const QuadraticAlgebra& algebra, const MatrixOf<Scalar>& W0,
                              const MatrixOf<Scalar>& S, const MatrixOf<Scalar>& Y,
                              MatrixOf<Scalar>& scratch, MatrixOf<Scalar>& W);

/// Sets W = W₀ + a (M - J⁻¹ M† J) + b MB and returns Σ |change of W|².  With M = B W̃, a = h/2 and
/// b = h²/4 this is the stage vorticity of the isospectral midpoint rule.  `scratch` as above.  W
/// is none of the other arguments.
template <class Scalar>
double update_midpoint_vorticity(const QuadraticAlgebra& algebra, const MatrixOf<Scalar>& W0,
                                 double a, const MatrixOf<Scalar>& M, double b,
                                 const MatrixOf<Scalar>& MB, MatrixOf<Scalar>& scratch,
                                 MatrixOf<Scalar>& W);

}  // namespace isosyrk

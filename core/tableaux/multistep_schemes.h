// Explicit multistep methods as pure data.
#pragma once

#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// A predictor and a corrector of Adams type with the slopes f₀, f₁ ... at the starts of this step
/// and of those before it, and f̃ at what is predicted: W̃ = W₀ + h Σ_j β*_j f_j,
/// W₁ = W₀ + h (β f̃ + Σ_j β_j f_j).
struct MultistepScheme {
  std::string name;
  int order;
  RealVector predictor;  ///< β*_j
  double of_predicted;   ///< β
  RealVector corrector;  ///< β_j, as many as β*_j
  Tableau start;         ///< of the steps before there are slopes enough
  /// Largest y up to which no solution of w' = iy w grows, at step size 1.
  double imaginary_limit;
};

/// Returns the pair of order 8 that predicts by the Adams-Bashforth formula of seven slopes, order
/// 7, and corrects once by the Adams-Moulton formula of the same seven and the new one, order 8.
/// Imaginary limit 0.374: with the predictor of order 8 it would be 0.29.
/// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, section III.1,
/// (1.5) and (1.9).
const MultistepScheme& adams_bashforth_moulton8();

/// Returns the largest modulus of a solution of w' = iy w after a step over that before it: the
/// spectral radius of the companion matrix.
double growth_of_a_step(const MultistepScheme& scheme, double y);

}  // namespace isosyrk

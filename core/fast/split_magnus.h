// The exponents of the explicit Magnus methods in split-complex storage.
#pragma once

#include "isosyrk/fast/split_lie.h"
#include "isosyrk/tableaux/explicit_tableaux.h"

namespace isosyrk {

/// The exponent Ω of magnus4 or magnus5 (integrators/explicit_magnus.h), in one precision.
/// Products: 6 or 12.  Poisson solves: 7 or 12.
template <class Real>
class SplitMagnus {
 public:
  using M = SplitMatrixOf<Real>;

  /// order is 4 or 5.
  SplitMagnus(SplitLie<Real>& lie, int order);

  /// Sets Ω for a step of h from W₀.  Allocates nothing.
  void form_exponent(M& Omega, const M& W0, double h);

 private:
  // W, B = B(W), k = [B, W] and D = B(k), the derivative of B along the flow.
  struct Point {
    M W, B, k, D;
  };

  void evaluate(Point& point);
  void predict(M& W, const Point& from, double h);
  void form_fourth(M& Omega, double h);
  void form_fifth(M& Omega, double h);

  SplitLie<Real>& lie_;
  int order_;
  Point start_, middle_, end_;
  Tableau tableau_;        // of the Runge-Kutta steps that predict
  SplitStagesOf<Real> k_;  // their slopes
  M B_stage_, W_stage_;
  M a0_, a1_;       // of order 4
  M m0_, m1_, m2_;  // of order 5, as all below
  M alpha1_, alpha2_, alpha3_, C1_, C2_;
  M left_, right_;  // of a bracket
  M commutator_;
};

}  // namespace isosyrk

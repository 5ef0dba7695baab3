#include "isosyrk/catalogue/workspace_bytes.h"

#include <cmath>

namespace isosyrk {
namespace {

// The unknowns of one step, each n x n.
double unknowns_of(Formulation formulation, double s) {
  switch (formulation) {
    case Formulation::cotangent:
      return 2.0 * s;  // Q_i, P_i
    case Formulation::group:
      return s;  // Q_i
    case Formulation::algebra:
      break;
  }
  if (s == 1.0) return 1.0;        // W̃
  return s + 0.5 * s * (s + 1.0);  // X_i, and M_ij for j <= i
}

// Bytes an entry, fitted to what the forms allocate at n = 17 ... 300 and s = 1, 2, 3, 6, so that
// the bound is between 1 and 1.5 times as much: tests/allocation_test.cpp.
constexpr double of_a_past_step = 17.0;  // an unknown in double precision, and its share of the fit
constexpr double of_an_unknown = 250.0;  // itself, B, corrections, Anderson's history
constexpr double of_the_rest = 200.0;    // W, packed factors

}  // namespace

double fast_workspace_bytes(Formulation formulation, int s, Index n, int past_steps) {
  // Rows of split-complex storage are padded to whole vectors.
  const double entries = static_cast<double>(n) * 8.0 * std::ceil(static_cast<double>(n) / 8.0);
  const double each = of_a_past_step * past_steps + of_an_unknown;
  return entries * (unknowns_of(formulation, s) * each + of_the_rest);
}

}  // namespace isosyrk

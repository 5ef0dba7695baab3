// Faults to order, for the trial of the regression gate (scripts/gate_experiment).  They exist in a
// build with ISOSYRK_FAULTS only, where the environment variable ISOSYRK_FAULT names one, as
// `extra_sweep` or `slowdown:0.05`.  In every other build nothing of this is left.
#pragma once

namespace isosyrk {

enum class Fault {
  allocation,        ///< one in every sweep
  extra_sweep,       ///< one after convergence
  printed_index,     ///< B_i for B_j in K_ij, as the paper prints it
  single_precision,  ///< the Poisson solve rounds what it takes and what it gives to float
  skewness,          ///< `algebra` forms its update as B W̃ - W̃ B
  slowdown,          ///< sweeps take longer by the share that stands behind the colon
  tableau,           ///< a_11 of Gauss tableaux off by 1e-10
  tolerance,         ///< 1e-11 for the one asked for
};

#ifdef ISOSYRK_FAULTS
/// Whether this is the fault that was ordered.  Throws std::invalid_argument if ISOSYRK_FAULT names
/// none.
bool has_fault(Fault fault);
/// To be called once in every sweep: Fault::allocation and Fault::slowdown.
void disturb_sweep();
#else
constexpr bool has_fault(Fault) { return false; }
constexpr void disturb_sweep() {}
#endif

}  // namespace isosyrk

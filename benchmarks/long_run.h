// One long run and what it was seen to keep, over time.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "benchmarks/stability_trial.h"

namespace isosyrk {

/// The invariants at one time of a run.
struct Sample {
  long step = 0;
  double time = 0.0;
  double spectrum_error = 0.0;
  std::array<double, 4> casimir_errors{};
  double energy_error = 0.0;  ///< relative, largest of the steps since the sample before
  double skew_defect = 0.0;
};

struct LongRun {
  double h_norm_B = 0.0;
  double step = 0.0;
  RunReport report{};
  long steps = 0;  ///< completed, or until all was lost
  /// That of the run, or "unstable" where an invariant was lost altogether; samples end there.
  std::string status{};
  long failed_step = 0;           ///< the step that failed, or at which it was lost; 0 if none
  std::vector<Sample> samples{};  ///< about ten a decade of steps, and every 250th
};

/// Up to `steps` steps from the initial data with h‖B(W₀)‖₂ = h_norm_B.
LongRun long_run(const TrialSetting& setting, Integrator& integrator, double h_norm_B, long steps);

}  // namespace isosyrk

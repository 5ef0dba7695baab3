#include "benchmarks/long_run.h"

#include <algorithm>
#include <cmath>

namespace isosyrk {
namespace {

// 1, 2, 3, ... while a decade has no ten, then ten a decade; every 250th besides, and the last.
std::vector<long> sample_steps(long steps) {
  std::vector<long> wanted;
  for (double exponent = 0.0; std::pow(10.0, exponent) < static_cast<double>(steps);
       exponent += 0.1) {
    wanted.push_back(std::lround(std::pow(10.0, exponent)));
  }
  for (long k = 250; k < steps; k += 250) wanted.push_back(k);
  wanted.push_back(steps);
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  return wanted;
}

// Lost altogether: off by the size of the data, whose norm is 1.
bool all_lost(const Sample& sample) {
  constexpr double everything = 1.0;
  return !(sample.spectrum_error < everything) || !(sample.skew_defect < everything) ||
         !(sample.energy_error < everything);
}

}  // namespace

LongRun long_run(const TrialSetting& setting, Integrator& integrator, double h_norm_B, long steps) {
  const Scene& scene = setting.scene;
  LongRun result;
  result.h_norm_B = h_norm_B;
  result.step = h_norm_B / setting.norms.B;
  const ConservationWatch watch(scene);
  const double initial_energy = scene.flow->hamiltonian(scene.initial);
  double energy_error = 0.0;
  const std::vector<long> wanted = sample_steps(steps);
  auto next = wanted.begin();
  long lost_at = 0;
  Matrix W = scene.initial;
  result.report =
      run(integrator, W, result.step, steps, [&](long step, const Matrix& W1, const StepReport&) {
        if (lost_at > 0) return;
        const double change = std::abs(scene.flow->hamiltonian(W1) - initial_energy);
        energy_error = larger(energy_error, change / std::abs(initial_energy));
        if (step != *next) return;
        ++next;
        const Conservation kept = watch.report(W1);
        result.samples.push_back({.step = step,
                                  .time = static_cast<double>(step) * result.step,
                                  .spectrum_error = kept.spectrum_error,
                                  .casimir_errors = casimir_errors(W1, scene.initial),
                                  .energy_error = energy_error,
                                  .skew_defect = kept.skew_defect});
        energy_error = 0.0;
        if (all_lost(result.samples.back())) lost_at = step;
      });
  result.status = lost_at > 0 ? "unstable" : name(result.report.status);
  result.steps = lost_at > 0 ? lost_at : result.report.steps;
  result.failed_step = lost_at > 0 ? lost_at : result.report.failed_step;
  return result;
}

}  // namespace isosyrk

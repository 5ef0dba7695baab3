#include "benchmarks/stability_trial.h"

#include <cmath>
#include <utility>

namespace isosyrk {

TrialSetting::TrialSetting(Scene scene_to_try, ProductBackend products)
    : scene(std::move(scene_to_try)),
      backend(products),
      frequencies(generator_frequencies(scene)),
      norms(generator_norms(frequencies)) {}

std::unique_ptr<Integrator> TrialSetting::make(const IntegratorEntry& entry) const {
  SolverOptions options;
  options.max_sweeps = trial_max_sweeps;
  return entry.make(*scene.flow, options, backend);
}

bool invariants_lost(const Conservation& kept, const Properties& promised) {
  constexpr double promised_loss = 1e-8;
  constexpr double spectrum_loss = 0.1;
  constexpr double energy_loss = 1.0;
  // Written so that NaN is a loss.
  return !(kept.spectrum_error <= (promised.isospectral ? promised_loss : spectrum_loss)) ||
         !(kept.skew_defect <= promised_loss) || !(kept.energy_error <= energy_loss);
}

Trial attempt(const TrialSetting& setting, const Properties& promised, Integrator& integrator,
              double h_norm_B, long steps) {
  Trial trial;
  trial.h_norm_B = h_norm_B;
  trial.step = h_norm_B / setting.norms.B;
  ConservationWatch watch(setting.scene);
  Matrix W = setting.scene.initial;
  trial.run = run(integrator, W, trial.step, steps,
                  [&](long, const Matrix& W1, const StepReport&) { watch.observe(W1); });
  trial.kept = watch.report(W);
  const bool lost = trial.run.converged() && invariants_lost(trial.kept, promised);
  trial.status = lost ? "unstable" : name(trial.run.status);
  return trial;
}

Edge find_edge(const TrialSetting& setting, const Properties& promised, Integrator& integrator,
               long steps) {
  constexpr double close = 1.02;
  Edge edge;
  auto& [tried, critical] = edge;
  for (int k = -6; k <= 7; ++k) {  // from 1/8 to 11.3, a factor √2 apart
    tried.push_back(attempt(setting, promised, integrator, std::pow(2.0, 0.5 * k), steps));
    if (!critical && tried.size() > 1 && !tried.back().works() && tried[tried.size() - 2].works()) {
      critical = {tried[tried.size() - 2], tried.back()};
    }
  }
  while (critical && critical->fails.h_norm_B > close * critical->works.h_norm_B) {
    const double middle = std::sqrt(critical->works.h_norm_B * critical->fails.h_norm_B);
    const Trial trial = attempt(setting, promised, integrator, middle, steps);
    (trial.works() ? critical->works : critical->fails) = trial;
  }
  return edge;
}

Edge find_edge(const TrialSetting& setting, const IntegratorEntry& entry) {
  return find_edge(setting, entry.keeps, *setting.make(entry),
                   trial_steps(setting.n(), entry.keeps.is_explicit));
}

long trial_steps(Index n, bool is_explicit) {
  if (is_explicit) return n <= 129 ? 400 : 100;
  if (n <= 33) return 50;
  if (n <= 65) return 10;
  if (n <= 129) return 3;
  return 1;
}

nlohmann::ordered_json trial_json(const Trial& trial) {
  nlohmann::ordered_json json = {{"h_norm_B", trial.h_norm_B},
                                 {"step", trial.step},
                                 {"status", trial.status},
                                 {"steps", trial.run.steps},
                                 {"sweeps_per_step", trial.run.sweeps_per_step()},
                                 {"contraction", trial.run.contraction},
                                 {"spectrum_error", trial.kept.spectrum_error},
                                 {"skew_defect", trial.kept.skew_defect},
                                 {"energy_error", trial.kept.energy_error}};
  if (!trial.run.converged()) json["failed_step"] = trial.run.failed_step;
  return json;
}

}  // namespace isosyrk

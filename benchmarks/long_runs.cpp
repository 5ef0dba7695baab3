// Long runs near the edge and well inside: what each method loses, and how fast.
//
// The edge of an integrator is its critical h‖B(W₀)‖₂, found here by the same bisection as in the
// map of the program `stability`, or the longest step tried where all work.  Runs are independent
// and use all cores; nothing here is timed.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "benchmarks/arguments.h"
#include "benchmarks/command_line.h"
#include "benchmarks/jobs.h"
#include "benchmarks/long_run.h"
#include "benchmarks/raw_file.h"
#include "benchmarks/stability_request.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "isosyrk/integrators/step_limits.h"

namespace isosyrk::long_runs {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<Index> default_sizes = {33, 17};  // the longest first: see run_jobs
const std::vector<Index> quick_sizes = {17};

const std::vector<double> shares = {0.9, 0.3};  // of the critical step: near the edge, well inside

// One integrator, and the one whose edge it is tried at: a control is tried where the method it
// stands against works.
struct Candidate {
  const IntegratorEntry* entry;
  const IntegratorEntry* edge_of;
};

struct Job {
  const TrialSetting* setting;
  Candidate candidate;

  std::string title() const {
    return fmt::format("{} at n = {}", candidate.entry->name, setting->n());
  }
};

Json as_json(const Sample& sample) {
  return {{"step", sample.step},
          {"time", sample.time},
          {"spectrum_error", sample.spectrum_error},
          {"casimir_errors", sample.casimir_errors},
          {"energy_error", sample.energy_error},
          {"skew_defect", sample.skew_defect}};
}

Json as_json(const Job& job, double share, double critical, const LongRun& run) {
  const TrialSetting& setting = *job.setting;
  Json json = {{"scene", setting.scene.name},
               {"n", setting.n()},
               {"integrator", job.candidate.entry->name},
               {"share", share},
               {"critical", critical},
               {"h_norm_B", run.h_norm_B},
               {"step", run.step},
               {"status", run.status},
               {"steps", run.steps},
               {"sweeps_per_step", run.report.sweeps_per_step()}};
  if (run.failed_step > 0) json["failed_step"] = run.failed_step;
  if (job.candidate.entry != job.candidate.edge_of) {
    const Tableau tableau = gauss_tableau(job.candidate.entry->stages);
    json["predicted_skew_growth"] =
        std::log(hermitian_growth(tableau, setting.frequencies, run.step)) / run.step;
  }
  json["samples"] = Json::array();
  for (const Sample& sample : run.samples) json["samples"].push_back(as_json(sample));
  return json;
}

// Its runs at each share; none where no step works.
Json carry_out(const Job& job, long steps) {
  const TrialSetting& setting = *job.setting;
  const Edge edge = find_edge(setting, *job.candidate.edge_of);
  const Trial& longest = edge.critical ? edge.critical->works : edge.trials.back();
  Json runs = Json::array();
  if (!longest.works()) return runs;
  const double critical = longest.h_norm_B;
  const auto integrator = setting.make(*job.candidate.entry);
  for (const double share : shares) {
    const LongRun run = long_run(setting, *integrator, share * critical, steps);
    runs.push_back(as_json(job, share, critical, run));
  }
  return runs;
}

}  // namespace

int main_program(int argc, char** argv) {
  CommandLine line{
      "Runs every integrator for many steps, near its critical step size and well inside, watches "
      "the invariants and writes them as JSON."};
  StabilityOptions options(line, "n = 17 only, a tenth of the steps");
  std::string steps_text;
  line.option("--steps", steps_text, "steps of a run, 10 to 1000000 (default 10000)");
  if (const auto exit_code = line.read(argc, argv)) return *exit_code;
  use_one_blas_thread();
  const StabilityRequest request = options.read(default_sizes, quick_sizes);
  long steps = options.quick() ? 1000 : 10000;
  if (!steps_text.empty()) steps = whole_number("--steps", steps_text, 10, 1000000);

  std::vector<IntegratorEntry> controls;
  for (const int s : {2, 3}) controls.push_back(two_products_entry(s));
  std::vector<Candidate> candidates;
  for (const IntegratorEntry* entry : request.integrators) candidates.push_back({entry, entry});
  for (const IntegratorEntry& control : controls) {
    const IntegratorEntry& algebra = integrator_entry(fmt::format("algebra{}", control.stages));
    candidates.push_back({&control, &algebra});
  }

  std::vector<BackendRates> rates;
  std::vector<TrialSetting> settings;
  for (const Index n : request.sizes) {
    rates.push_back(choose_backend(request.products, n));
    settings.emplace_back(smooth_scene(n), rates.back().chosen);
  }
  std::vector<Job> jobs;
  for (const TrialSetting& setting : settings) {
    for (const Candidate& candidate : candidates) jobs.push_back({&setting, candidate});
  }
  JobProgress progress(jobs.size());
  const std::vector<Json> done = run_jobs(
      jobs.size(), request.processes, [&](std::size_t k) { return carry_out(jobs[k], steps); },
      [&](std::size_t k) { progress.finished(jobs[k].title()); });

  Json json = {{"format", "isosyrk long_runs 1"}};
  json["context"] =
      context_json("long_runs", request.products, rates, {.max_sweeps = trial_max_sweeps});
  json["steps"] = steps;
  for (const Candidate& candidate : candidates) {
    json["integrators"].push_back(integrator_json(*candidate.entry));
  }
  json["runs"] = Json::array();
  for (const Json& runs : done) json["runs"].insert(json["runs"].end(), runs.begin(), runs.end());
  request.output->write(json.dump(1) + "\n");
  return exit_done;
}

}  // namespace isosyrk::long_runs

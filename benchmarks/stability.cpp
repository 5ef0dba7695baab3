// Where each method fails, and how: outcomes over step sizes, and the critical one.
//
// A map is one integrator at one n in one scene: trials of some steps each on a grid of h‖B(W₀)‖₂,
// which grows like n at fixed h, and the critical value by bisection.  Maps are independent and use
// all cores; nothing here is timed.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "benchmarks/arguments.h"
#include "benchmarks/command_line.h"
#include "benchmarks/jobs.h"
#include "benchmarks/raw_file.h"
#include "benchmarks/stability_request.h"
#include "benchmarks/stability_trial.h"

namespace isosyrk::stability {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<Index> default_sizes = {9, 17, 33, 65, 129, 257};
const std::vector<Index> quick_sizes = {9, 17, 33};

// One integrator in one setting.
struct Map {
  const TrialSetting* setting;
  const IntegratorEntry* entry;

  std::string title() const {
    return fmt::format("{} at n = {}, {}", entry->name, setting->n(), setting->scene.name);
  }
};

Json draw(const Map& map) {
  const TrialSetting& setting = *map.setting;
  const Edge edge = find_edge(setting, *map.entry);
  Json json = {{"scene", setting.scene.name},   {"n", setting.n()},
               {"integrator", map.entry->name}, {"linear_limit", nullptr},
               {"trials", Json::array()},       {"critical", nullptr}};
  if (map.entry->linear_limit) {
    json["linear_limit"] = map.entry->linear_limit(setting.frequencies) * setting.norms.B;
  }
  for (const Trial& trial : edge.trials) json["trials"].push_back(trial_json(trial));
  if (edge.critical) {
    json["critical"] = {{"works", trial_json(edge.critical->works)},
                        {"fails", trial_json(edge.critical->fails)}};
  }
  return json;
}

Json setting_json(const TrialSetting& setting) {
  return {{"scene", setting.scene.name},
          {"n", setting.n()},
          {"norm_B", setting.norms.B},
          {"norm_ad_B", setting.norms.ad_B},
          {"trial_steps",
           {{"explicit", trial_steps(setting.n(), true)},
            {"implicit", trial_steps(setting.n(), false)}}}};
}

}  // namespace

int main_program(int argc, char** argv) {
  CommandLine line{
      "Maps, for every integrator, n and scene, which step sizes work and how the others fail, and "
      "writes the outcomes as JSON."};
  StabilityOptions options(line, "n = 9, 17 and 33 only");
  std::vector<std::string> scenes;
  options.allow_fast_forms(line);
  line.option("--scene", scenes, "smooth, rough (default both)");
  if (const auto exit_code = line.read(argc, argv)) return *exit_code;
  use_one_blas_thread();
  const StabilityRequest request = options.read(default_sizes, quick_sizes);
  if (scenes.empty()) scenes = scene_names();
  for (const std::string& scene : scenes) require_scene("--scene", scene);

  std::vector<BackendRates> rates;
  std::vector<TrialSetting> settings;
  for (const Index n : request.sizes) {
    rates.push_back(choose_backend(request.products, n));
    for (const std::string& scene : scenes) {
      settings.emplace_back(scene_by_name(scene, n), rates.back().chosen);
    }
  }
  // The largest n first: the last to end would leave cores idle.
  std::vector<Map> jobs;
  for (auto setting = settings.rbegin(); setting != settings.rend(); ++setting) {
    for (const IntegratorEntry* entry : request.integrators) jobs.push_back({&*setting, entry});
  }
  JobProgress progress(jobs.size());
  const std::vector<Json> maps = run_jobs(
      jobs.size(), request.processes, [&](std::size_t k) { return draw(jobs[k]); },
      [&](std::size_t k) { progress.finished(jobs[k].title()); });

  Json json = {{"format", "isosyrk stability 1"}};
  json["context"] =
      context_json("stability", request.products, rates, {.max_sweeps = trial_max_sweeps});
  json["context"]["solver"] = options.solver();
  json["max_sweeps"] = trial_max_sweeps;
  for (const IntegratorEntry* entry : request.integrators) {
    json["integrators"].push_back(integrator_json(*entry));
  }
  for (const TrialSetting& setting : settings) json["settings"].push_back(setting_json(setting));
  json["maps"] = maps;
  request.output->write(json.dump(1) + "\n");
  return exit_done;
}

}  // namespace isosyrk::stability

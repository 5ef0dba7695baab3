// Where each method fails, and how: outcomes over step sizes, and the critical one.
//
// A map is one integrator at one n in one scene: trials of some steps each on a grid of h‖B(W₀)‖₂,
// which grows like n at fixed h, and the critical value by bisection.  Maps are independent and use
// all cores; nothing here is timed.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "benchmarks/arguments.h"
#include "benchmarks/conditions.h"
#include "benchmarks/integrator_json.h"
#include "benchmarks/jobs.h"
#include "benchmarks/stability_request.h"
#include "benchmarks/stability_trial.h"

namespace isosyrk {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<Index> default_sizes = {9, 17, 33, 65, 129, 257};
const std::vector<Index> quick_sizes = {9, 17, 33};

struct Place {
  TrialSetting setting;
  ProductBackend backend;
};

// One integrator in one place.
struct Map {
  const Place* place;
  const IntegratorEntry* entry;
  std::vector<Trial> trials{};
  std::optional<CriticalStep> critical{};
};

Map draw(const Place& place, const IntegratorEntry& entry) {
  Map map{&place, &entry};
  SolverOptions options;
  options.max_sweeps = trial_max_sweeps;
  const TrialSetting& setting = place.setting;
  const auto integrator = entry.make(*setting.scene.flow, options, place.backend);
  map.critical = critical_step(setting, entry.keeps, *integrator,
                               trial_steps(setting.n(), entry.keeps.is_explicit), map.trials);
  return map;
}

Json as_json(const Map& map) {
  const TrialSetting& setting = map.place->setting;
  Json json = {{"scene", setting.scene.name},   {"n", setting.n()},
               {"integrator", map.entry->name}, {"linear_limit", nullptr},
               {"trials", Json::array()},       {"critical", nullptr}};
  if (map.entry->linear_limit) {
    json["linear_limit"] = map.entry->linear_limit(setting.frequencies) * setting.norms.B;
  }
  for (const Trial& trial : map.trials) json["trials"].push_back(trial_json(trial));
  if (map.critical) {
    json["critical"] = {{"works", trial_json(map.critical->works)},
                        {"fails", trial_json(map.critical->fails)}};
  }
  return json;
}

Json as_json(const Place& place) {
  const TrialSetting& setting = place.setting;
  return {{"scene", setting.scene.name},
          {"n", setting.n()},
          {"norm_B", setting.norms.B},
          {"norm_ad_B", setting.norms.ad_B},
          {"trial_steps",
           {{"explicit", trial_steps(setting.n(), true)},
            {"implicit", trial_steps(setting.n(), false)}}}};
}

int main_program(int argc, char** argv) {
  CLI::App app{
      "Maps, for every integrator, n and scene, which step sizes work and how the others fail, and "
      "writes the outcomes as JSON."};
  StabilityOptions options(app, "n = 9, 17 and 33 only");
  std::vector<std::string> scenes;
  app.add_option("--scene", scenes, "smooth, rough (default both)");
  if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
  use_one_blas_thread();
  const StabilityRequest request = options.read(default_sizes, quick_sizes);
  if (scenes.empty()) scenes = scene_names();
  for (const std::string& scene : scenes) require_scene("--scene", scene);

  std::vector<BackendRates> rates;
  std::vector<std::unique_ptr<Place>> places;
  for (const Index n : request.sizes) {
    rates.push_back(choose_backend(request.products, n));
    for (const std::string& scene : scenes) {
      places.push_back(std::make_unique<Place>(
          Place{TrialSetting(scene_by_name(scene, n)), rates.back().chosen}));
    }
  }
  // The largest n first: the last to end would leave cores idle.
  struct Job {
    const Place* place;
    const IntegratorEntry* entry;
  };
  std::vector<Job> jobs;
  for (auto place = places.rbegin(); place != places.rend(); ++place) {
    for (const IntegratorEntry* entry : request.integrators) jobs.push_back({place->get(), entry});
  }
  JobProgress progress(jobs.size());
  const std::vector<Json> maps = run_jobs(
      jobs.size(), request.processes,
      [&](std::size_t k) { return as_json(draw(*jobs[k].place, *jobs[k].entry)); },
      [&](std::size_t k) {
        const Scene& scene = jobs[k].place->setting.scene;
        progress.finished(fmt::format("{} at n = {}, {}", jobs[k].entry->name,
                                      jobs[k].place->setting.n(), scene.name));
      });

  Json json = {{"format", "isosyrk stability 1"}};
  json["context"] = stability_context("stability", request, rates, trial_max_sweeps);
  json["max_sweeps"] = trial_max_sweeps;
  for (const IntegratorEntry* entry : request.integrators) {
    json["integrators"].push_back(integrator_json(*entry));
  }
  for (const auto& place : places) json["settings"].push_back(as_json(*place));
  json["maps"] = maps;
  request.output->write(json.dump(1) + "\n");
  return exit_done;
}

}  // namespace
}  // namespace isosyrk

int main(int argc, char** argv) {
  return isosyrk::guarded("stability", [&] { return isosyrk::main_program(argc, argv); });
}

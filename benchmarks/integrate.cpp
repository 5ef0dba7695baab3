// Runs one scene with one integrator, and prints what it cost and what it kept.
#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "benchmarks/arguments.h"
#include "benchmarks/modes_file.h"
#include "benchmarks/output_file.h"
#include "benchmarks/timed_run.h"
#include "core/conservation.h"
#include "core/integrator_list.h"
#include "core/scene.h"

namespace isosyrk {
namespace {

// The command line as text; every value is read strictly by `parse`.
struct Text {
  std::string n, stages, formulation, integrator, step, time;
  std::string tolerance = "1e-13";
  std::string max_sweeps = "1000";
  std::string hbar = "paper";
  std::string products = "fastest";
  std::string scene = "smooth";
  std::string modes;
  std::string output;
};

struct Request {
  Index n;
  IntegratorEntry integrator;
  std::optional<Formulation> formulation;  // where it was chosen by this
  double step;
  double time;
  long steps;
  SolverOptions solver;
  HbarConvention hbar;
  BackendChoice products;
  Scene scene;
  std::vector<Mode> modes;  // of the scene
  std::optional<OutputFile> output;
};

// Which of the options that have no default were given.
struct Given {
  bool formulation, stages, integrator, scene, modes, output;
};

// --integrator, or --formulation and --stages.
void choose_integrator(const Text& text, const Given& given, Request& request) {
  if (given.integrator && (given.formulation || given.stages)) {
    throw BadArgument(
        fmt::format("--integrator {}: must stand alone, in place of --formulation and --stages",
                    text.integrator));
  }
  try {
    if (given.integrator) {
      request.integrator = integrator_entry(text.integrator);
      return;
    }
    if (!given.stages) throw BadArgument("--stages is required, or --integrator");
    if (!given.formulation) throw BadArgument("--formulation is required, or --integrator");
    const int stages = static_cast<int>(whole_number("--stages", text.stages, 1, max_stages));
    request.formulation = formulation_from_name(text.formulation);
    request.integrator = gauss_entry(*request.formulation, stages);
  } catch (const std::invalid_argument& error) {
    throw BadArgument(fmt::format("--{}", error.what()));
  }
}

// --scene, or the smooth one from modes of the user's.
void choose_scene(const Text& text, const Given& given, Request& request) {
  if (given.modes) {
    if (given.scene) {
      throw BadArgument(
          fmt::format("--modes {}: must stand without --scene, which has its own", text.modes));
    }
    request.modes = read_modes_file(text.modes, request.n);
    request.scene = smooth_scene(request.n, request.hbar, request.modes);
    request.scene.name = "modes";
    return;
  }
  if (text.scene == "smooth" && request.n < 5) {
    throw BadArgument(fmt::format(
        "--n {}: the default modes (l <= 4) need n >= 5; smaller n needs --modes", request.n));
  }
  try {
    request.modes = initial_modes(text.scene, request.n);
  } catch (const std::invalid_argument& error) {
    throw BadArgument(fmt::format("--{}", error.what()));
  }
  request.scene = scene_by_name(text.scene, request.n, request.hbar);
}

Request parse(const Text& text, const Given& given) {
  Request request{};
  request.n = whole_number("--n", text.n, 2, 4096);
  choose_integrator(text, given, request);
  const std::string positive = "positive and finite";
  request.step = real_number("--step", text.step, positive);
  if (request.step <= 0.0) {
    throw BadArgument(fmt::format("--step {}: must be {}", text.step, positive));
  }
  const std::string not_negative = "0 or positive, and finite";
  request.time = real_number("--time", text.time, not_negative);
  if (request.time < 0.0) {
    throw BadArgument(fmt::format("--time {}: must be {}", text.time, not_negative));
  }
  request.steps = step_count(request.time, request.step);
  const std::string at_least = "at least 1e-15, and finite";
  request.solver.tolerance = real_number("--tolerance", text.tolerance, at_least);
  if (request.solver.tolerance < 1e-15) {
    throw BadArgument(fmt::format("--tolerance {}: must be {}", text.tolerance, at_least));
  }
  request.solver.max_sweeps =
      static_cast<int>(whole_number("--max-sweeps", text.max_sweeps, 1, 1000000));
  request.hbar = hbar_convention(text.hbar);
  request.products = backend_choice(text.products);
  choose_scene(text, given, request);
  if (given.output) request.output.emplace("--output", text.output);
  return request;
}

struct Outcome {
  RunReport run;
  double seconds = 0.0;
  Conservation kept;
  double h_norm_B = 0.0;
  Matrix W;
};

Outcome integrate(const Request& request, ProductBackend backend) {
  const Scene& scene = request.scene;
  const auto integrator = request.integrator.make(*scene.flow, request.solver, backend);
  Outcome outcome;
  outcome.W = scene.initial;
  outcome.h_norm_B = request.step * generator_norms(scene).B;
  ConservationWatch watch(scene);
  const TimedRun timed = timed_run(*integrator, outcome.W, request.step, request.steps,
                                   [&](const Matrix& W) { watch.observe(W); });
  outcome.run = timed.run;
  outcome.seconds = timed.seconds;
  outcome.kept = watch.report(outcome.W);
  return outcome;
}

nlohmann::ordered_json as_json(const Request& request, const Outcome& outcome,
                               ProductBackend backend) {
  const RunReport& run = outcome.run;
  nlohmann::ordered_json json = {
      {"scene", request.scene.name},
      {"n", request.n},
      {"integrator", request.integrator.name},
      {"stages", request.integrator.stages},
      {"formulation", request.formulation ? nlohmann::ordered_json(name(*request.formulation))
                                          : nlohmann::ordered_json(nullptr)},
      {"step", request.step},
      {"steps", request.steps},
      {"time", request.time},
      {"tolerance", request.solver.tolerance},
      {"max_sweeps", request.solver.max_sweeps},
      {"hbar", name(request.hbar)},
      {"modes_hash", hash_of(request.modes)},
      {"product_backend", name(backend)},
      {"converged", run.converged()},
      {"status", name(run.status)},
      {"sweeps_total", run.sweeps},
      {"products", run.products},
      {"poisson_solves", run.poisson_solves},
      {"seconds", outcome.seconds},
      {"h_norm_B", outcome.h_norm_B},
      {"spectrum_error", outcome.kept.spectrum_error},
      {"skew_defect", outcome.kept.skew_defect},
      {"energy_error", outcome.kept.energy_error},
      {"last_change", run.last_change},
  };
  if (!run.converged()) json["failed_step"] = run.failed_step;
  return json;
}

void print_text(const nlohmann::ordered_json& result) {
  for (const auto& [key, value] : result.items()) {
    if (value.is_null()) continue;  // the formulation of an integrator that is none
    fmt::print("{:<16} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
  }
}

int main_program(int argc, char** argv) {
  CLI::App app{
      "Integrates the Euler-Zeitlin equations with one formulation of an isospectral "
      "symplectic Runge-Kutta (Gauss) method, or with any listed integrator."};
  Text text;
  bool json = false;
  app.add_option("--n", text.n, "matrix size, 2 to 4096")->required();
  const auto* stages =
      app.add_option("--stages", text.stages, "stages of the Gauss tableau, 1 to 20");
  const auto* formulation =
      app.add_option("--formulation", text.formulation, "cotangent, group or algebra");
  const auto* integrator =
      app.add_option("--integrator", text.integrator,
                     "name of a listed integrator, in place of --formulation and --stages");
  app.add_option("--step", text.step, "step size h > 0")->required();
  app.add_option("--time", text.time, "end time T >= 0, a whole number of steps")->required();
  app.add_option("--tolerance", text.tolerance, "of the fixed point, >= 1e-15 (default 1e-13)");
  app.add_option("--max-sweeps", text.max_sweeps, "sweeps allowed in a step (default 1000)");
  app.add_option("--hbar", text.hbar, "paper: 2/sqrt(n(n-1)) (default); standard: 2/sqrt(n^2-1)");
  app.add_option("--products", text.products, "fastest (default), openblas or eigen");
  const auto* scene = app.add_option("--scene", text.scene, "smooth (default) or rough");
  const auto* modes =
      app.add_option("--modes", text.modes, "initial modes, CSV with the header l,m,re,im");
  const auto* output =
      app.add_option("--output", text.output, "write W(T) as NumPy .npy, complex128");
  app.add_flag("--json", json, "print one JSON object")->disable_flag_override();
  if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
  use_one_blas_thread();
  const Request request = parse(text, {.formulation = formulation->count() > 0,
                                       .stages = stages->count() > 0,
                                       .integrator = integrator->count() > 0,
                                       .scene = scene->count() > 0,
                                       .modes = modes->count() > 0,
                                       .output = output->count() > 0});
  const ProductBackend backend = choose_backend(request.products, request.n).chosen;
  const Outcome outcome = integrate(request, backend);

  const nlohmann::ordered_json result = as_json(request, outcome, backend);
  if (outcome.run.converged() && request.output) request.output->write(npy(outcome.W));
  if (json) {
    fmt::print("{}\n", result.dump());
  } else {
    print_text(result);
  }
  require_printed();
  if (outcome.run.converged()) return exit_done;
  print_error("integrate",
              fmt::format("{} at step {} of {} after {} sweeps in all, last change {:.3g}; no "
                          "output written",
                          name(outcome.run.status), outcome.run.failed_step, request.steps,
                          outcome.run.sweeps, outcome.run.last_change));
  return exit_solver_failed;
}

}  // namespace
}  // namespace isosyrk

int main(int argc, char** argv) {
  return isosyrk::guarded("integrate", [&] { return isosyrk::main_program(argc, argv); });
}

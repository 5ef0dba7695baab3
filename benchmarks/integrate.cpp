// Runs one scene with one integrator, and prints what it cost and what it kept.
#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "benchmarks/arguments.h"
#include "benchmarks/modes_file.h"
#include "benchmarks/output_file.h"
#include "core/gauss_tableau.h"
#include "core/integrator_list.h"
#include "core/invariants.h"
#include "core/run.h"
#include "core/scene.h"

namespace isosyrk {
namespace {

// The command line as text; every value is read strictly by `parse`.
struct Text {
  std::string n, stages, formulation, step, time;
  std::string tolerance = "1e-13";
  std::string max_sweeps = "1000";
  std::string hbar = "paper";
  std::string products = "fastest";
  std::string modes;
  std::string output;
};

struct Request {
  Index n;
  int stages;
  Formulation formulation;
  double step;
  double time;
  long steps;
  SolverOptions solver;
  HbarConvention hbar;
  BackendChoice products;
  std::vector<Mode> modes;
  std::optional<OutputFile> output;
};

Request parse(const Text& text, bool modes_given, bool output_given) {
  Request request{};
  request.n = whole_number("--n", text.n, 2, 4096);
  request.stages = static_cast<int>(whole_number("--stages", text.stages, 1, max_stages));
  try {
    request.formulation = formulation_from_name(text.formulation);
  } catch (const std::invalid_argument& error) {
    throw BadArgument(fmt::format("--{}", error.what()));
  }
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
  if (modes_given) {
    request.modes = read_modes_file(text.modes, request.n);
  } else if (request.n < 5) {
    throw BadArgument(fmt::format(
        "--n {}: the default modes (l <= 4) need n >= 5; smaller n needs --modes", request.n));
  } else {
    request.modes = default_modes();
  }
  if (output_given) request.output.emplace("--output", text.output);
  return request;
}

struct Outcome {
  RunReport run;
  double seconds = 0.0;
  double energy_error = 0.0;
  double h_norm_B = 0.0;
  Matrix W;
};

Outcome integrate(const Request& request, const Scene& scene, ProductBackend backend) {
  const auto integrator = make_formulation(request.formulation, *scene.flow,
                                           gauss_tableau(request.stages), request.solver, backend);
  Outcome outcome;
  outcome.W = scene.initial;
  Matrix B(request.n, request.n);
  scene.flow->generator(scene.initial, B);
  outcome.h_norm_B = request.step * spectral_norm(B);

  const double initial_energy = scene.flow->hamiltonian(scene.initial);
  double observing = 0.0;  // what looking at the energy costs is no part of the run
  const double start = cpu_seconds();
  outcome.run = run(*integrator, outcome.W, request.step, request.steps,
                    [&](long, const Matrix& W, const StepReport&) {
                      const double before = cpu_seconds();
                      const double error =
                          std::abs(scene.flow->hamiltonian(W) / initial_energy - 1.0);
                      outcome.energy_error = larger(outcome.energy_error, error);
                      observing += cpu_seconds() - before;
                    });
  outcome.seconds = cpu_seconds() - start - observing;
  return outcome;
}

nlohmann::ordered_json as_json(const Request& request, const Scene& scene, const Outcome& outcome,
                               ProductBackend backend) {
  const RunReport& run = outcome.run;
  nlohmann::ordered_json json = {
      {"n", request.n},
      {"stages", request.stages},
      {"formulation", name(request.formulation)},
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
      {"spectrum_error", spectrum_error(outcome.W, scene.initial)},
      {"skew_defect", skew_defect(outcome.W)},
      {"energy_error", outcome.energy_error},
      {"last_change", run.last_change},
  };
  if (!run.converged()) json["failed_step"] = run.failed_step;
  return json;
}

void print_text(const nlohmann::ordered_json& result) {
  for (const auto& [key, value] : result.items()) {
    fmt::print("{:<16} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
  }
}

int main_program(int argc, char** argv) {
  CLI::App app{
      "Integrates the Euler-Zeitlin equations with one formulation of an isospectral "
      "symplectic Runge-Kutta (Gauss) method."};
  Text text;
  bool json = false;
  app.add_option("--n", text.n, "matrix size, 2 to 4096")->required();
  app.add_option("--stages", text.stages, "stages of the Gauss tableau, 1 to 20")->required();
  app.add_option("--formulation", text.formulation, "cotangent, group or algebra")->required();
  app.add_option("--step", text.step, "step size h > 0")->required();
  app.add_option("--time", text.time, "end time T >= 0, a whole number of steps")->required();
  app.add_option("--tolerance", text.tolerance, "of the fixed point, >= 1e-15 (default 1e-13)");
  app.add_option("--max-sweeps", text.max_sweeps, "sweeps allowed in a step (default 1000)");
  app.add_option("--hbar", text.hbar, "paper: 2/sqrt(n(n-1)) (default); standard: 2/sqrt(n^2-1)");
  app.add_option("--products", text.products, "fastest (default), openblas or eigen");
  const auto* modes =
      app.add_option("--modes", text.modes, "initial modes, CSV with the header l,m,re,im");
  const auto* output =
      app.add_option("--output", text.output, "write W(T) as NumPy .npy, complex128");
  app.add_flag("--json", json, "print one JSON object")->disable_flag_override();
  if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
  use_one_blas_thread();
  const Request request = parse(text, modes->count() > 0, output->count() > 0);
  const Scene scene = smooth_scene(request.n, request.hbar, request.modes);
  const ProductBackend backend = choose_backend(request.products, request.n).chosen;
  const Outcome outcome = integrate(request, scene, backend);

  const nlohmann::ordered_json result = as_json(request, scene, outcome, backend);
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

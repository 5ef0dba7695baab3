// Runs one scene with one integrator, and prints what it cost and what it kept.
#include <fmt/format.h>

#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "benchmarks/conditions.h"
#include "benchmarks/integrate/integrate_arguments.h"
#include "benchmarks/integrate/interruption.h"
#include "benchmarks/integrate/progress_line.h"
#include "benchmarks/integrate/record.h"
#include "benchmarks/modes_file.h"
#include "benchmarks/npy_file.h"
#include "benchmarks/output_file.h"
#include "isosyrk/catalogue/measured_limits.h"
#include "isosyrk/linalg/byte_hash.h"
#include "isosyrk/machine/clocks.h"
#include "isosyrk/machine/memory.h"
#include "isosyrk/scenes/euler_zeitlin_scenes.h"
#include "isosyrk/scenes/scene_list.h"
#include "isosyrk/simulation/conservation.h"
#include "isosyrk/simulation/run.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk::integrate {
namespace {

struct Outcome {
  RunReport run;
  double seconds = 0.0;      // CPU time of the steps, without what the watch takes
  bool interrupted = false;  // by a signal, after run.steps
  Conservation kept;
  double h_norm_B = 0.0;
  Matrix W;  // the last good state

  bool finished() const { return run.converged() && !interrupted; }
};

// Where results go: the file that --output names, and one beside it for an interrupted run.
struct Outputs {
  OutputFile finished, interrupted;
};

struct Start {
  Scene scene;
  nlohmann::ordered_json modes_hash;  // null where there are no modes
};

// Files are read first, so that what is wrong with them is said before anything is computed.
Start start_of(const IntegrateRequest& request) {
  const HbarConvention hbar = request.hbar.value_or(HbarConvention::paper);
  if (request.modes_file) {
    const std::vector<Mode> modes = read_modes_file(*request.modes_file, request.n);
    return {euler_zeitlin_scene(request.scene, request.n, hbar, modes), hash_of(modes)};
  }
  const bool has_modes = is_euler_zeitlin(request.scene);
  const auto named = [&] {
    return scene_by_name(request.scene, {request.n, request.hbar, request.signature});
  };
  if (!request.initial_file) {
    Scene scene = named();
    if (!has_modes) return {std::move(scene), nullptr};
    return {std::move(scene), hash_of(initial_modes(request.scene, request.n))};
  }
  const std::string& path = *request.initial_file;
  try {
    Matrix W0 = read_npy(path, request.n);
    if (request.scene == "initial") return {euler_zeitlin_scene("initial", hbar, W0), nullptr};
    Scene scene = named();
    require_initial_data(*scene.flow, W0);
    scene.initial = std::move(W0);
    return {std::move(scene), nullptr};
  } catch (const std::invalid_argument& error) {
    throw BadArgument(fmt::format("--initial {}: {}", path, error.what()));
  }
}

// Before a long run, not after it.
void warn_beyond_limit(const IntegrateRequest& request, double h_norm_B) {
  const std::optional<double> limit = measured_limit(request.name, request.solver, request.n);
  if (!limit || h_norm_B <= *limit) return;
  print_error("integrate",
              fmt::format("note: h_norm_B = {:.3g} is beyond {:.3g}, the largest at which the {} "
                          "form of {} survived every recorded run; see results/README.md",
                          h_norm_B, *limit, name(request.solver), request.name));
}

// W.interrupted.npy beside W.npy.
std::string interrupted_path(const std::string& path) {
  constexpr std::string_view suffix = ".npy";
  const std::size_t kept = path.ends_with(suffix) ? path.size() - suffix.size() : path.size();
  return fmt::format("{}.interrupted{}", path.substr(0, kept), suffix);
}

std::optional<Outputs> outputs_of(const IntegrateRequest& request) {
  if (!request.output_file) return std::nullopt;
  const std::string& path = *request.output_file;
  return Outputs{{"--output", path}, {"--output", interrupted_path(path)}};
}

// What forms the products.
std::string products_of(Solver solver, const Flow& flow, ProductBackend backend) {
  if (solver == Solver::fast) return fmt::format("split {}", gemm_kernels().front().name);
  return flow.algebra().is_dense() ? std::string(name(backend)) : "blocks";
}

// What the steps of a run depend on.  A checkpoint goes on with the same.
nlohmann::ordered_json command_of(const IntegrateRequest& request, const Start& start,
                                  ProductBackend backend) {
  nlohmann::ordered_json command = {
      {"version", ISOSYRK_VERSION},
      {"scene", request.scene},
      {"n", request.n},
      {"integrator", request.name},
      {"solver", name(request.solver)},
      {"step", request.step},
      {"tolerance", request.iteration.tolerance},
      {"max_sweeps", request.iteration.max_sweeps},
      {"hbar", name(request.hbar.value_or(HbarConvention::paper))},
      {"signature", nullptr},
      {"modes_hash", start.modes_hash},
      {"initial_hash", nullptr},
      {"products", name(backend)},
      {"every", *request.every},
      {"series", request.series_file.has_value()},
      {"kernels", kernel_sets()},  // last: others are only noted
  };
  if (request.signature) {
    command["signature"] =
        fmt::format("{},{}", request.signature->first, request.signature->second);
  }
  if (request.initial_file) {
    const Matrix& W0 = start.scene.initial;
    const auto* bytes = reinterpret_cast<const char*>(W0.data());
    const std::size_t count = static_cast<std::size_t>(W0.size()) * sizeof(Complex);
    command["initial_hash"] = fmt::format("{:016x}", hash_after(hash_of_nothing, bytes, count));
  }
  return command;
}

// A run that goes on takes the products that it had: which are the fastest, two runs may find
// differently.
ProductBackend backend_of(const IntegrateRequest& request, const std::optional<Record>& record) {
  BackendChoice choice = request.products;
  if (!choice && record && record->checkpoint()) {
    choice = backend_choice_from_name(
        record->checkpoint()->header().command.at("products").get<std::string>());
  }
  return choose_backend(choice, request.n).chosen;
}

// A run that a signal ends keeps its last good state, which is written at once.
Outcome integrate(const IntegrateRequest& request, const Start& start, ProductBackend backend,
                  const std::optional<Outputs>& outputs, std::optional<Record>& record) {
  const Scene& scene = start.scene;
  IterationOptions iteration = request.iteration;
  // A step that ends within a sweep leaves no past steps, and so nothing for a checkpoint.
  if (!request.snapshots_folder) iteration.after_sweep = end_if_interrupted;
  RunSoFar so_far{.report = {},
                  .watch = ConservationWatch(scene),
                  .integrator = request.integrator.make(scene.flow, iteration, backend)};
  Integrator& integrator = *so_far.integrator;
  Outcome outcome;
  outcome.h_norm_B = request.step * generator_norm(scene);
  if (request.is_euler_zeitlin()) warn_beyond_limit(request, outcome.h_norm_B);  // as it was tried
  integrator.set_state(scene.initial);
  watch_signals();
  if (record) record->begin(command_of(request, start, backend), so_far);
  outcome.W = integrator.state();
  const RunReport earlier = so_far.report;  // of a run that goes on
  const double earlier_seconds = so_far.seconds;
  double watching = 0.0;
  const auto add = [&](const RunReport& report) {
    so_far.report = earlier;
    so_far.report.append(report);
  };
  const auto progress_of = [&](const Energy& energy) {
    return Progress{so_far.report.steps, number_of(energy), so_far.report.sweeps};
  };
  // Not beside a --json that another program reads.
  const bool is_read = request.json && isatty(STDOUT_FILENO) == 0 && !request.every;
  ProgressLine progress(request.steps, request.step, !is_read, progress_of(integrator.energy()));
  const double begun = cpu_seconds();
  const auto look = [&](const RunReport& report) {
    const double before = cpu_seconds();
    add(report);
    so_far.seconds = earlier_seconds + before - begun - watching;
    const Energy energy = integrator.energy();
    so_far.watch.observe(energy);
    progress.show(progress_of(energy));
    const bool goes_on = caught_signal() == 0;
    if (record) record->observe(so_far, !goes_on);
    watching += cpu_seconds() - before;
    return goes_on;
  };
  try {
    add(run_while(integrator, outcome.W, request.step, request.steps - earlier.steps, look));
  } catch (const Interrupted&) {
    outcome.interrupted = true;
  }
  outcome.seconds = earlier_seconds + cpu_seconds() - begun - watching;
  outcome.run = so_far.report;
  outcome.interrupted |= outcome.run.converged() && outcome.run.steps < request.steps;
  progress.clear();
  if (outcome.interrupted && outputs) outputs->interrupted.write(npy(outcome.W));
  outcome.kept = so_far.watch.report(outcome.W);
  return outcome;
}

nlohmann::ordered_json as_json(const IntegrateRequest& request, const Start& start,
                               const Outcome& outcome, ProductBackend backend) {
  const RunReport& run = outcome.run;
  nlohmann::ordered_json json = {
      {"scene", request.scene},
      {"n", request.n},
      {"integrator", request.name},
      {"stages", request.integrator.stages},
      {"formulation", request.formulation ? nlohmann::ordered_json(name(*request.formulation))
                                          : nlohmann::ordered_json(nullptr)},
      {"solver", name(request.solver)},
      {"threads", request.threads},
      {"step", request.step},
      {"steps", request.steps},
      {"time", request.time},
      {"tolerance", request.iteration.tolerance},
      {"max_sweeps", request.iteration.max_sweeps},
      {"hbar", request.is_euler_zeitlin()
                   ? nlohmann::ordered_json(name(request.hbar.value_or(HbarConvention::paper)))
                   : nlohmann::ordered_json(nullptr)},
      {"modes_hash", start.modes_hash},
      {"product_backend", products_of(request.solver, *start.scene.flow, backend)},
      {"converged", outcome.finished()},
      {"status", outcome.interrupted ? "interrupted" : name(run.status)},
      {"sweeps_total", run.sweeps},
      {"products", run.work.products},
      {"equivalent_products", run.work.equivalent_products},
      {"poisson_solves", run.work.poisson_solves},
      {"projections", run.work.projections},
      {"seconds", outcome.seconds},
      {"h_norm_B", outcome.h_norm_B},
      {"spectrum_error", outcome.kept.spectrum_error},
      {"skew_defect", outcome.kept.skew_defect},
      {"energy_error", outcome.kept.energy_error},
      {"last_change", run.last_change},  // null if it is not finite
  };
  if (!run.converged()) json["failed_step"] = run.failed_step;
  if (outcome.interrupted) {
    json["steps_done"] = run.steps;
    json["time_done"] = static_cast<double>(run.steps) * request.step;
  }
  return json;
}

// JSON has no number that is not finite, and the sign of a NaN says nothing.
constexpr const char* not_finite = "not finite";

std::string change_text(double change) {
  return std::isfinite(change) ? fmt::format("{:.3g}", change) : not_finite;
}

std::string text_of(const nlohmann::ordered_json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float() && !std::isfinite(value.get<double>())) return not_finite;
  return value.dump();
}

// How far an interrupted run came, and how to go on.
std::string interruption(const IntegrateRequest& request, const Outcome& outcome,
                         const std::optional<Outputs>& outputs) {
  const long done = outcome.run.steps;
  const std::string came = fmt::format("interrupted after step {} of {}, t = {:.10g}", done,
                                       request.steps, static_cast<double>(done) * request.step);
  if (request.snapshots_folder) return came + "; the same command with --resume goes on from there";
  if (!outputs) return came + "; nothing written, for want of --output";
  return fmt::format("{}; W(t) is in {}: --initial takes it, --time {:.10g} is left", came,
                     outputs->interrupted.path(),
                     static_cast<double>(request.steps - done) * request.step);
}

void print_text(const nlohmann::ordered_json& result) {
  for (const auto& [key, value] : result.items()) {
    if (value.is_null()) continue;  // no formulation, or no modes
    fmt::print("{:<16} {}\n", key, text_of(value));
  }
}

}  // namespace

int main_program(int argc, char** argv) {
  const auto asked = read_integrate_arguments(argc, argv);
  if (const int* exit_code = std::get_if<int>(&asked)) return *exit_code;
  const auto& request = std::get<IntegrateRequest>(asked);
  require_memory(fmt::format("--n {} with {}", request.n, request.integrator.name),
                 request.integrator, request.n);
  use_one_blas_thread();
  const std::optional<Outputs> outputs = outputs_of(request);
  std::optional<Record> record;
  if (request.every) record.emplace(request);
  const Start start = start_of(request);
  const ProductBackend backend = backend_of(request, record);
  const Outcome outcome = integrate(request, start, backend, outputs, record);

  const nlohmann::ordered_json result = as_json(request, start, outcome, backend);
  if (outcome.finished() && outputs) outputs->finished.write(npy(outcome.W));
  if (request.json) {
    fmt::print("{}\n", result.dump());
  } else {
    print_text(result);
  }
  require_printed();
  if (outcome.finished()) return exit_done;
  if (outcome.interrupted) {
    print_error("integrate", interruption(request, outcome, outputs));
    return exit_by_signal + caught_signal();
  }
  print_error("integrate",
              fmt::format("{} at step {} of {} after {} sweeps in all, last change {}; no output "
                          "written",
                          name(outcome.run.status), outcome.run.failed_step, request.steps,
                          outcome.run.sweeps, change_text(outcome.run.last_change)));
  return exit_solver_failed;
}

}  // namespace isosyrk::integrate

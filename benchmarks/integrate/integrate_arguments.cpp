#include "benchmarks/integrate/integrate_arguments.h"

#include <fmt/ranges.h>

#include <filesystem>

#include "benchmarks/command_line.h"
#include "isosyrk/catalogue/fast_forms.h"

namespace isosyrk {
namespace {

// P,Q of --signature.
std::pair<Index, Index> read_signature(const std::string& option, const std::string& text) {
  const auto comma = text.find(',');
  if (comma == std::string::npos) {
    throw BadArgument(fmt::format("{} '{}': must be P,Q", option, text));
  }
  return {whole_number(option, text.substr(0, comma), 1, 4095),
          whole_number(option, text.substr(comma + 1), 1, 4095)};
}

std::string read_scene(const std::string& option, const std::string& text) {
  require_scene(option, text);
  return text;
}

// The integrator as it was asked for: by its name, or by a formulation and its stages.
struct IntegratorChoice {
  std::string name;
  int stages = 0;
};

// --integrator, or --formulation and --stages, and --solver with its threads.
void choose_integrator(const IntegratorChoice& choice, const CommandLine& line,
                       IntegrateRequest& request) {
  const bool by_name = line.has("--integrator");
  if (by_name && (line.has("--formulation") || line.has("--stages"))) {
    throw BadArgument(fmt::format(
        "--integrator {}: must stand alone, in place of --formulation and --stages", choice.name));
  }
  if (request.solver == Solver::fast && line.has("--products")) {
    throw BadArgument(
        fmt::format("--solver fast: has products of its own; must stand without --products {}",
                    line.text("--products")));
  }
  if (request.solver == Solver::published && line.has("--threads")) {
    throw BadArgument(
        fmt::format("--threads {}: must go with --solver fast; others have one", request.threads));
  }
  note_more_threads_than_cores("integrate", request.threads);
  const FastOptions options = with_defaults({.threads = request.threads}, request.n);
  if (by_name) {
    request.name = choice.name;
    request.integrator = integrator_entry(choice.name, request.solver, options);
    return;
  }
  for (const char* option : {"--stages", "--formulation"}) {
    if (!line.has(option)) {
      throw BadArgument(fmt::format("{} is required, or --integrator", option));
    }
  }
  request.name = gauss_entry(*request.formulation, choice.stages).name;
  request.integrator = gauss_entry(*request.formulation, choice.stages, request.solver, options);
}

// --scene, --modes or --initial.
void choose_scene(const CommandLine& line, IntegrateRequest& request) {
  // Other scenes have no modes, and take --initial for their own flow.
  const bool own_flow = !is_euler_zeitlin(request.scene);
  if (own_flow && request.modes_file) {
    throw BadArgument(fmt::format("--modes {}: goes with Euler-Zeitlin, not with --scene {}",
                                  *request.modes_file, request.scene));
  }
  const bool scene_has_data = line.has("--scene") && !own_flow;
  if (scene_has_data + request.modes_file.has_value() + request.initial_file.has_value() > 1) {
    throw BadArgument("--scene, --modes, --initial: each has initial data; must be one of them");
  }
  if (own_flow && request.hbar) {
    throw BadArgument(fmt::format("--hbar {}: goes with Euler-Zeitlin, not with --scene {}",
                                  name(*request.hbar), request.scene));
  }
  if (request.modes_file) {
    request.scene = "modes";
  } else if (request.initial_file) {
    if (!own_flow) request.scene = "initial";
  } else if (request.scene == "smooth" && request.n < 5) {
    throw BadArgument(fmt::format(
        "--n {}: the default modes (l <= 4) need n >= 5; smaller n needs --modes or --initial",
        request.n));
  }
}

// --every, --snapshots, --series and --resume.
void require_whole_record(const IntegrateRequest& request) {
  if (request.every && !request.snapshots_folder && !request.series_file) {
    throw BadArgument(
        fmt::format("--every {}: must go with --snapshots, --series or both", *request.every));
  }
  if (!request.every && request.snapshots_folder) {
    throw BadArgument(
        fmt::format("--snapshots {}: must go with --every", *request.snapshots_folder));
  }
  if (!request.every && request.series_file) {
    throw BadArgument(fmt::format("--series {}: must go with --every", *request.series_file));
  }
  if (request.resume && !request.snapshots_folder) {
    throw BadArgument("--resume: must go with --snapshots, whose folder has the checkpoint");
  }
  if (!request.series_file) return;
  const auto whole = [](const std::string& path) {
    return std::filesystem::path(path).lexically_normal();
  };
  for (const auto& [option, path] : {std::pair("--output", request.output_file),
                                     std::pair("--snapshots", request.snapshots_folder)}) {
    if (path && whole(*path) == whole(*request.series_file)) {
      throw BadArgument(fmt::format("--series {}: must not be that of {}", *path, option));
    }
  }
}

}  // namespace

std::variant<IntegrateRequest, int> read_integrate_arguments(int argc, char** argv) {
  CommandLine line{
      "Integrates a scene, Euler-Zeitlin by default, with one formulation of an isospectral "
      "symplectic Runge-Kutta (Gauss) method, or with any listed integrator."};
  IntegrateRequest request;
  IntegratorChoice choice;
  line.add_value("--n", request.n, Whole<Index>{2, 4096}, "matrix size, 2 to 4096").required();
  line.add_value("--stages", choice.stages, Whole<int>{1, max_stages},
                 "stages of the Gauss tableau, 1 to 20");
  line.add_value("--formulation", request.formulation, Named{&formulation_from_name},
                 "cotangent, group or algebra");
  line.add_value("--integrator", choice.name, Text{},
                 "name of a listed integrator, in place of --formulation and --stages");
  line.add_value("--step", request.step, Real{"positive and finite", positive}, "step size h > 0")
      .required();
  line.add_value("--time", request.time, Real{"0 or positive, and finite", 0.0},
                 "end time T >= 0, a whole number of steps")
      .required();
  line.add_value("--tolerance", request.iteration.tolerance,
                 Real{"at least 1e-15, and finite", 1e-15},
                 "of the fixed point, relative to W, >= 1e-15 (default 1e-13)");
  line.add_value("--max-sweeps", request.iteration.max_sweeps, Whole<int>{1, 1000000},
                 "sweeps allowed in a step (default 1000)");
  line.add_value("--hbar", request.hbar, Named{&hbar_convention_from_name},
                 "paper: 2/sqrt(n(n-1)) (default); standard: 2/sqrt(n^2-1)");
  line.add_value("--products", request.products, Named{&backend_choice_from_name},
                 "fastest (default), openblas or eigen");
  line.add_value("--solver", request.solver, Named{&solver_from_name},
                 "published (default), or fast: the same answer to the tolerance, sooner");
  line.add_value("--threads", request.threads, thread_count, "of --solver fast, 1 (default) to 64");
  line.add_value("--scene", request.scene, read_scene,
                 fmt::format("one of {} (default smooth)", fmt::join(scene_names(), ", ")));
  line.add_value("--signature", request.signature, read_signature,
                 "P,Q with P + Q = n, of pseudo_unitary");
  line.add_value("--modes", request.modes_file, Text{},
                 "initial modes, CSV with the header l,m,re,im");
  line.add_value("--initial", request.initial_file, Text{},
                 "W at time 0, NumPy .npy as --output writes it");
  line.add_value("--output", request.output_file, Text{}, "write W(T) as NumPy .npy, complex128");
  line.add_value("--every", request.every, Whole<long>{1, 1000000000000000},
                 "steps K from one row of --series and one file of --snapshots to the next")
      .type_name("K");
  line.add_value(
      "--snapshots", request.snapshots_folder, Text{},
      "folder for W as NumPy .npy, every K steps and at the end, and for the checkpoint");
  line.add_value("--series", request.series_file, Text{},
                 "CSV file: t, energy, spectrum error, enstrophy, sweeps, seconds, every K steps");
  line.add_flag("--resume", request.resume,
                "go on, bit for bit, from the checkpoint in the folder of --snapshots, by the same "
                "command or one with a longer --time");
  line.add_flag("--json", request.json, "print one JSON object");
  if (const auto exit_code = line.parse(argc, argv)) return *exit_code;

  of_option([&] { choose_integrator(choice, line, request); });
  request.steps = step_count(request.time, request.step);
  require_whole_record(request);
  choose_scene(line, request);
  return request;
}

}  // namespace isosyrk
